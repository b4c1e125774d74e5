"""Engines load an export and show the marked room as Cycles does: no wall is mirrored, turned or another's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")

import bpy

from pcc_addon.blender import rendering
from pcc_addon.blender.export import ExportJob
from pcc_addon.core.export.targets import target_of
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera
from tests.blender.helpers import bake, small_probe
from tests.blender.test_orientation import ROOM, WALLS, build_room
from tests.engines import views
from tests.engines.shown import ENGINES
from tests.engines.views import Quad

pytestmark = pytest.mark.heavy


@pytest.fixture
def marked(scene) -> bpy.types.Object:
    """The marked room and its probe, captured off the middle; a camera at the capture point."""
    build_room()
    probe = small_probe("Probe", ROOM.centre, ROOM.half_extents, ROOM.matrix.to_euler(), (0.8, -0.6, 0.4))
    probe.pcc_probe.resolution = 128
    assert bake(probe)[0].error is None
    return probe


def relative_error(picture: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(np.square(picture - truth).mean() / np.square(truth).mean()))


def compared(engine: str, scene: bpy.types.Scene, to: Path, towards: str, background: bool) -> tuple[float, float]:
    """The errors of an engine's picture of a corner against Cycles, and of its mirror image."""
    target = target_of(engine)
    place = ROOM.world(0.8, -0.6, 0.4)
    corner = ROOM.world(*(h * float(sign + "1") for h, sign in zip(ROOM.half_extents, towards, strict=True)))
    add_camera(place, corner, 18.0, 96, 64)
    truth = rendering.render(scene, rendering.RenderSettings(Engine.CYCLES, 16)).pixels
    job = ExportJob(scene, bpy.context.view_layer, [bpy.data.objects["Probe"]], target, to)
    job.finish()
    walls = [] if background else [Quad(f"Wall {side}", "wall", "Probe") for side in WALLS]
    view = views.scene(target, walls, 2, "Probe" if background else "")
    picture = views.averaged(ENGINES[engine](to, view), 2)
    return relative_error(picture, truth), relative_error(picture[:, ::-1], truth)


@pytest.mark.parametrize("towards", ["+++", "---"])
@pytest.mark.parametrize("engine", ENGINES)
def test_the_marked_room_is_the_right_way_round(marked, scene, tmp_path: Path, engine: str, towards: str) -> None:
    right, mirrored = compared(engine, scene, tmp_path, towards, background=False)
    assert right < 0.2 < 0.3 < mirrored


@pytest.mark.parametrize("engine", ["three", "babylon"])
def test_an_engine_s_own_sky_shows_the_cubemap_the_right_way_round(marked, scene, tmp_path: Path, engine: str) -> None:
    right, mirrored = compared(engine, scene, tmp_path, "+-+", background=True)
    assert right < 0.2 < 0.3 < mirrored
