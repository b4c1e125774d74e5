"""The pictures of a bake in panels: made once, by a timer, and gone when the bake is."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from pcc_addon.blender import handlers
from pcc_addon.blender.thumbnails import SmallCapture, small_capture
from pcc_addon.core.errors import PccError
from pcc_addon.ui.kept import thumbnails as kept
from tests.blender.helpers import bake, paint_wall, pretend_bake, save, small_probe, small_room


@pytest.fixture
def made(monkeypatch) -> list[str]:
    """The probes whose pictures were made."""
    found, read = [], kept.small_capture

    def counted(probe: bpy.types.Object) -> SmallCapture:
        found.append(probe.name)
        return read(probe)

    monkeypatch.setattr(kept, "small_capture", counted)
    return found


def make_all() -> int:
    """Let the timer run until all is made; returns in how many steps."""
    steps = 1
    while kept.make() is not None:
        steps += 1
        assert steps < 20
    return steps


@pytest.fixture(autouse=True)
def _nothing_waits():
    yield
    kept.forget()
    if bpy.app.timers.is_registered(kept.make):
        bpy.app.timers.unregister(kept.make)


def colours(picture: np.ndarray) -> np.ndarray:
    """Which channel is brightest in the middle of each face of a cross: of its four sides, then above."""
    n = len(picture) // 3
    cells = [(1, 0), (1, 1), (1, 2), (1, 3), (2, 1)]
    return np.array([picture[r * n + n // 2, c * n + n // 2, :3].argmax() for r, c in cells])


def test_they_show_what_was_captured(scene, tmp_path) -> None:
    save(tmp_path / "room.blend")
    probe = small_room()  # +X red, −X green, +Y blue, −Y red, +Z green
    bake(probe)
    found = small_capture(probe)
    assert colours(found.cross).tolist() == [1, 2, 0, 0, 1]
    middle = len(found.ball) // 2
    assert found.ball[middle, middle, :3].argmax() == 0, "what is behind the one who looks: −Y"
    image = probe.pcc_probe.levels[0].image
    image.buffers_free()
    small_capture(probe)
    assert not image.has_data, "half a gigabyte is not kept for a small picture"


def test_panels_ask_and_a_timer_makes_them_once(probe, made) -> None:
    assert kept.of(probe) is None and not made, "nothing is read while something is drawn"
    assert bpy.app.timers.is_registered(kept.make)
    assert kept.of(probe) is None
    assert make_all() == 3 and made == ["Probe"]
    icons = kept.of(probe)
    assert icons.ball is not None and icons.cross is not None
    assert kept.make() is None and made == ["Probe"] and kept.of(probe) == icons


def test_those_of_several_probes_are_made_one_after_the_other(probe, made) -> None:
    other = small_probe("Other")
    pretend_bake(other)
    kept.of(probe), kept.of(other)
    assert kept.make() == 0.0 and len(made) == 1
    assert make_all() == 5 and sorted(made) == ["Other", "Probe"]


def test_a_probe_that_goes_meanwhile_harms_nothing(probe, made) -> None:
    kept.of(probe)
    kept.make()
    bpy.data.objects.remove(probe)
    make_all()
    kept.make()
    assert not kept._made and not kept._collection


def test_another_bake_has_other_pictures_and_none_has_none(scene, made) -> None:
    probe = small_room()
    bake(probe)
    kept.of(probe)
    make_all()
    paint_wall()
    bake(probe)
    assert kept.of(probe) is None and make_all() == 3 and made == ["Probe", "Probe"]
    assert len(kept._collection) == 2, "the old ones are gone"
    probe.pcc_probe.bake_record = ""
    assert kept.of(probe) is None and kept.make() is None and len(made) == 2
    assert not kept._collection and not kept._made


def test_those_of_deleted_probes_and_of_other_files_go(probe, made, tmp_path) -> None:
    kept.of(probe)
    make_all()
    bpy.data.objects.remove(probe)
    kept.make()
    assert not kept._collection
    other = small_probe("Other")
    pretend_bake(other)
    save(tmp_path / "a.blend")
    kept.of(other)
    make_all()
    assert kept._collection
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert not kept._collection and not kept._wanted


def test_a_bake_whose_picture_is_missing_is_asked_once(probe, made) -> None:
    probe.pcc_probe.levels[0].image = None
    with pytest.raises(PccError, match="has no picture to show; bake it"):
        small_capture(probe)
    kept.of(probe)
    kept.make()
    assert kept.of(probe) == kept.Icons(None, None) and len(made) == 1


def test_nothing_is_read_while_a_bake_goes_on(probe, made) -> None:
    kept.of(probe)
    with handlers.paused():
        assert kept.make() > 0.0 and not made
