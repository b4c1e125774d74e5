"""How far a bake is: each piece of its work counts, and the whole is there when the last begins."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import compat
from pcc_addon.blender.bake.capture import Stage
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.blender.store.pictures import write_file
from tests.blender.helpers import bake, small_room


@pytest.mark.parametrize("source", ["BAKE", "IMAGE", "WORLD"])
def test_progress_grows_with_each_piece_of_work_and_ends_at_one(scene, tmp_path: Path, source: str) -> None:
    probe = small_room()
    write_file(tmp_path / "sky.exr", np.full((16, 32, 3), 0.5, np.float32))
    probe.pcc_probe.source, probe.pcc_probe.picture = source, str(tmp_path / "sky.exr")
    scene.world = bpy.data.worlds.new("World")
    job = BakeJob(scene, bpy.context.view_layer, [probe], bake_folder(scene))
    reached = [(job.progress, job.message)]
    while job.step():
        reached.append((job.progress, job.message))
    told = [progress for progress, message in reached if message.startswith("Probe: ")]
    assert all(before < after for before, after in pairwise(told)), reached
    assert told[-1] == 1.0 and told[-2] < 1.0 and [result.error for result in job.results] == [None]


def test_where_blender_has_no_denoiser_the_bake_says_so(scene, monkeypatch) -> None:
    probe = small_room()
    [quiet] = bake(probe)
    monkeypatch.setattr(compat, "CAN_DENOISE", False)
    [off] = bake(probe)
    probe.pcc_probe.denoise = True
    [warned] = bake(probe)
    assert quiet.warnings == off.warnings == ()
    assert warned.warnings == ("this Blender was built without a denoiser: the picture has the noise of 1 samples",)


@pytest.mark.parametrize(("engine", "denoise", "looks"), [("CYCLES", False, 0), ("CYCLES", True, 6)])
def test_only_denoised_faces_are_looked_at_once_more(
    scene, monkeypatch, engine: str, denoise: bool, looks: int
) -> None:
    probe, seen = small_room(), []
    probe.pcc_probe.engine, probe.pcc_probe.denoise = engine, denoise
    glimpse = Stage.glimpse

    def counted(self: Stage, *args: object) -> object:
        seen.append(args)
        return glimpse(self, *args)

    monkeypatch.setattr(Stage, "glimpse", counted)
    [result] = bake(probe)
    assert result.error is None and len(seen) == looks
