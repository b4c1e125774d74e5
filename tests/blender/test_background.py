"""A bake in a second Blender gives what a bake here gives."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.status import statuses
from pcc_addon.blender.store.pictures import write_file
from pcc_addon.core.frames import FrameRange
from tests.blender.background_bakes import begin, finish
from tests.blender.helpers import bake, contents, paint_wall, picture, save, small_probe, small_room


def states() -> dict[str, str]:
    return {status.probe: status.state for status in statuses(bpy.context.scene, bpy.context.view_layer)}


def test_all_kinds_of_probes_get_what_a_bake_here_gives(scene, tmp_path: Path) -> None:
    probes = [small_room(), *(small_probe(name) for name in ("Cubemap", "Sky", "Deep"))]
    write_file(tmp_path / "sky.exr", np.random.default_rng(1).random((16, 32, 3), np.float32))
    scene.world = bpy.data.worlds.new("World")
    probes[1].pcc_probe.source, probes[1].pcc_probe.picture = "IMAGE", "//sky.exr"
    probes[2].pcc_probe.source = "WORLD"
    probes[3].pcc_probe.correction, probes[3].pcc_probe.half_float = "RELIEF", True
    save(tmp_path / "room.blend")
    for result in bake(*probes):
        assert result.error is None
    shown = {p.name: [picture(p, level.roughness).copy() for level in p.pcc_probe.levels] for p in probes}
    files = {name for name in contents(tmp_path) if name.endswith(".exr")}
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    for path in (tmp_path / "room.pcc").iterdir():
        path.unlink()
    assert set(states().values()) == {"unbaked"}
    probes = [bpy.data.objects[name] for name in shown]
    assert [result.error for result in finish(begin(*probes))] == [None] * 4
    for probe in probes:
        levels = probe.pcc_probe.levels
        assert len(levels) == len(shown[probe.name])
        for level, before in zip(levels, shown[probe.name], strict=True):
            # As NumPy sums where arrays happen to lie in memory, the last digit may be another.
            np.testing.assert_allclose(picture(probe, level.roughness), before, rtol=1e-6, atol=1e-7)
    assert set(states().values()) == {"baked"}
    assert {name.rpartition(".")[2] for name in contents(tmp_path)} == {"blend", "exr", "json"}
    assert len({name for name in contents(tmp_path) if name.endswith(".exr")}) == len(files)


@pytest.mark.heavy
def test_only_what_has_changed_is_rendered_and_frames_are_kept(scene, tmp_path: Path) -> None:
    room, film = small_room(), small_probe("Film")
    film.keyframe_insert("location", frame=1)
    film.location.x += 0.2
    film.keyframe_insert("location", frame=3)
    scene.frame_set(1)
    save(tmp_path / "room.blend")
    [result] = finish(begin(film, frames=FrameRange(1, 3)))
    assert (result.error, result.rendered, result.frames) == (None, 3, "1-3")
    bake(room)
    film.keyframe_insert("location", frame=2)
    film.location.z += 0.1
    film.keyframe_insert("location", frame=2)
    scene.frame_set(1)
    assert states() == {"Probe": "baked", "Film": "stale"}
    [result] = finish(begin(room, film, stale=True))
    assert (result.probe, result.error, result.rendered, result.pictures) == ("Film", None, 1, 3)
    assert states() == {"Probe": "baked", "Film": "baked"}
    paint_wall()
    assert states()["Probe"] == "stale"
