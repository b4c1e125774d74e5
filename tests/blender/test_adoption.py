"""What becomes of the file while a second Blender bakes: nothing is lost, and what was changed meanwhile is stale."""

from __future__ import annotations

import re
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake.background import BackgroundBake
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.shade.probe_group import known_receivers
from pcc_addon.core.frames import FrameRange
from pcc_addon.core.lookup_plan import Receivers
from sample_blends.scenes import empty_scene, principled_node
from tests.blender.background_bakes import Tape, begin, finish, play, record, until
from tests.blender.helpers import (
    bake,
    contents,
    paint_wall,
    picture,
    pictures_of,
    put_in,
    save,
    shown_group,
    small_probe,
    small_room,
)
from tests.blender.test_background import states


@pytest.fixture(scope="module")
def tape(tmp_path_factory: pytest.TempPathFactory, addon: None) -> Tape:
    """What a second Blender tells of the two probes of the `blend` of these tests."""
    place = tmp_path_factory.mktemp("tape")
    with pytest.MonkeyPatch.context() as patch:
        empty_scene()
        probes = two_probes()
        save(place / "room.blend")
        return record(patch, place / "files", *probes)


def two_probes() -> list[bpy.types.Object]:
    return [small_room(), small_probe("Second")]


@pytest.fixture
def blend(scene, tmp_path: Path) -> Path:
    """The saved file that the tape is of; its first probe has an older bake, of another wall."""
    two_probes()
    paint_wall()
    path = tmp_path / "here" / "room.blend"
    path.parent.mkdir()
    save(path)
    bake(the_probe())
    paint(1.0, 0.0, 0.0)
    put_in()
    save(path)
    return path


def the_probe(name: str = "Probe") -> bpy.types.Object:
    return bpy.data.objects[name]


def paint(*color: float) -> None:
    principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Color"].default_value = (*color, 1.0)
    bpy.context.view_layer.update()


def baked(monkeypatch: pytest.MonkeyPatch, tape: Tape, *names: str) -> BackgroundBake:
    """A background bake of some probes, whole and not adopted yet."""
    play(monkeypatch, tape)
    job = begin(*map(the_probe, names or ("Probe",)))
    until(job, lambda: len(job.waiting) == max(len(names), 1))
    return job


def test_the_new_bake_is_shown_and_fresh(blend, monkeypatch, tape) -> None:
    before, floor = picture(the_probe()).copy(), bpy.data.materials["Floor"]
    job = baked(monkeypatch, tape)
    assert np.array_equal(picture(the_probe()), before), "it waits"
    assert states() == {"Probe": "stale", "Second": "unbaked"}
    [result] = finish(job)
    assert result.error is None and result.seconds > 0.0 and result.files
    assert not np.array_equal(picture(the_probe()), before) and states()["Probe"] == "baked"
    shown = {n.image for n in shown_group(floor).nodes if n.bl_idname == "ShaderNodeTexEnvironment"}
    assert shown == {level.image for level in the_probe().pcc_probe.levels}
    assert {image.name for image in shown} == {
        f"PCC Probe {level.roughness:.4f}" for level in the_probe().pcc_probe.levels
    }


@pytest.mark.parametrize("change", ["scene", "moved", "resolution", "half_float"])
def test_what_was_changed_meanwhile_is_stale(blend, monkeypatch, tape, change: str) -> None:
    job = baked(monkeypatch, tape)
    if change == "scene":
        paint(0.2, 0.9, 0.2)
    elif change == "moved":
        the_probe().location.x += 0.1
        bpy.context.view_layer.update()
    else:
        setattr(the_probe().pcc_probe, change, 24 if change == "resolution" else True)
    [result] = finish(job)
    assert result.error is None and states()["Probe"] == "stale"
    assert bake_record(the_probe()).resolution == 16


def test_a_probe_that_was_moved_gets_the_lookup_that_holds_anywhere(blend, monkeypatch, tape) -> None:
    finish(baked(monkeypatch, tape))
    planned = known_receivers(the_probe().pcc_probe.group)
    assert planned.all_inside
    job = baked(monkeypatch, tape)
    the_probe().location.x += 0.1
    bpy.context.view_layer.update()
    finish(job)
    assert known_receivers(the_probe().pcc_probe.group) == Receivers()


def test_a_renamed_probe_has_its_bake_under_its_new_name(blend, monkeypatch, tape) -> None:
    job = baked(monkeypatch, tape)
    the_probe().name = "Hall"
    [result] = finish(job)
    assert (result.probe, result.error) == ("Hall", None) and states()["Hall"] == "baked"
    assert all(level.image.name.startswith("PCC Hall") for level in the_probe("Hall").pcc_probe.levels)


def test_names_that_were_swapped_swap_no_bakes(blend, monkeypatch, tape) -> None:
    job = baked(monkeypatch, tape, "Probe", "Second")
    one, two = the_probe(), the_probe("Second")
    one.name, two.name = "Third", "Probe"
    one.name = "Second"
    assert [result.probe for result in finish(job)] == ["Second", "Probe"]
    assert bake_record(one).uid == one.pcc_probe.uid != two.pcc_probe.uid == bake_record(two).uid
    assert bake_record(one).probe == "Probe" and bake_record(two).probe == "Second"


def test_a_copy_keeps_the_old_bake(blend, monkeypatch, tape) -> None:
    job, before = baked(monkeypatch, tape), picture(the_probe()).copy()
    copy = the_probe().copy()
    bpy.context.scene.collection.objects.link(copy)
    [result] = finish(job)
    assert result.probe == "Probe" and states()["Probe"] == "baked"
    assert np.array_equal(picture(copy), before) and not np.array_equal(picture(the_probe()), before)


def test_of_a_probe_that_was_deleted_the_bake_is_dropped_and_others_go_on(blend, monkeypatch, tape) -> None:
    job = baked(monkeypatch, tape, "Probe", "Second")
    bpy.data.objects.remove(the_probe())
    first, second = finish(job)
    assert first.error == "probe 'Probe' was deleted meanwhile, and its new bake with it"
    assert second.error is None and states() == {"Second": "baked"}


@pytest.mark.parametrize("undone", ["deleting", "what came before the bake"])
def test_undo_meanwhile_loses_no_probe(blend, monkeypatch, tape, undone: str) -> None:
    bpy.ops.ed.undo_push(message="opened")
    if undone == "deleting":
        job = baked(monkeypatch, tape)
        bpy.data.objects.remove(the_probe())
        bpy.ops.ed.undo_push(message="deleted")
    else:
        bpy.data.objects["Second"].location.x += 1.0
        bpy.ops.ed.undo_push(message="moved")
        job = baked(monkeypatch, tape)
    bpy.ops.ed.undo()
    [result] = finish(job)
    assert result.error is None and states()["Probe"] == "baked"


def test_undo_and_redo_of_an_adoption_bring_both_bakes_back_ten_times(blend, monkeypatch, tape) -> None:
    bpy.ops.ed.undo_push(message="opened")
    before = picture(the_probe()).copy()
    finish(baked(monkeypatch, tape))
    bpy.ops.ed.undo_push(message="baked")
    after = picture(the_probe()).copy()
    for _ in range(10):
        bpy.ops.ed.undo()
        assert np.array_equal(picture(the_probe()), before) and states()["Probe"] == "stale"
        bpy.ops.ed.redo()
        assert np.array_equal(picture(the_probe()), after) and states()["Probe"] == "baked"


def test_saved_elsewhere_meanwhile_the_pictures_go_there(blend, monkeypatch, tape, tmp_path) -> None:
    job = baked(monkeypatch, tape)
    (tmp_path / "there").mkdir()
    save(tmp_path / "there" / "other.blend")
    before = contents(blend.parent)
    finish(job)
    assert {path.parent for path in pictures_of(the_probe())} == {tmp_path / "there" / "other.pcc"}
    assert states()["Probe"] == "baked"
    assert {name for name in before if "unfinished" not in name} == set(contents(blend.parent)), "nothing else is gone"


def test_a_file_that_was_never_saved_packs_them_and_one_saved_meanwhile_does_not(
    scene, monkeypatch, tape, tmp_path
) -> None:
    two_probes()
    finish(baked(monkeypatch, tape))
    assert all(level.image.packed_file for level in the_probe().pcc_probe.levels) and states()["Probe"] == "baked"
    job = baked(monkeypatch, tape)
    save(tmp_path / "room.blend")
    finish(job)
    assert {path.parent for path in pictures_of(the_probe())} == {tmp_path / "room.pcc"} and states()[
        "Probe"
    ] == "baked"


def test_frames_of_a_file_that_was_never_saved_are_refused_at_once(scene, monkeypatch, tape) -> None:
    two_probes()
    given = play(monkeypatch, tape)
    job = begin(the_probe(), frames=FrameRange(1, 2))
    assert not job.step() and not given
    assert "save it first" in job.results[0].error


def test_cancelled_it_leaves_nothing_but_what_was_adopted(blend, monkeypatch, tape) -> None:
    before, places = contents(blend.parent), []
    job = baked(monkeypatch, tape, "Probe", "Second")
    places = [Path(waiting.sidecar).parent for waiting in job.waiting]
    assert all(place.is_dir() for place in places)
    job.adopt_next()
    job.cancel()
    assert not any(place.exists() for place in places)
    assert states() == {"Probe": "baked", "Second": "unbaked"}
    new = set(contents(blend.parent)) - set(before)
    assert new and all(name.startswith("room.pcc/Probe-") for name in new)


@pytest.mark.parametrize(
    ("code", "why"), [(-9, "memory ran out"), (-11, "crashed"), (1, r"failed \(MemoryError\)"), (0xC0000005, "crashed")]
)
def test_where_a_second_blender_ends_too_soon_its_probe_is_named_and_the_others_go_on(
    blend, monkeypatch, tape, code: int, why: str
) -> None:
    given = play(monkeypatch, tape, [("Probe", code)])
    first, second = finish(begin(the_probe(), the_probe("Second")))
    assert first.probe == "Probe" and re.search(why, first.error), first.error
    assert first.error.startswith("probe 'Probe': the second Blender ") and "keeps the bake that it had" in first.error
    assert second.error is None and states() == {"Probe": "stale", "Second": "baked"}
    assert [[a for a in each if a.startswith("--probe")] for each in given] == [
        ["--probe=Probe", "--probe=Second"],
        ["--probe=Second"],
    ]
