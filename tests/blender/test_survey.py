"""How near things are: what a survey sees, and that it leaves no trace."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake import faces
from pcc_addon.blender.bake.capture import Stage
from pcc_addon.blender.read.probes import all_probes, probe_spec
from pcc_addon.core import equirect
from pcc_addon.core.probe import Engine
from sample_blends import scenes
from tests.blender.snapshots import settled


def surveyed(**changes: object) -> tuple[np.ndarray, object]:
    """The survey of the scene's probe at 32 pixels a face, and its record."""
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    spec = replace(probe_spec(all_probes(scene)[0]), resolution=32, **changes)
    with ExitStack() as stack:
        stage = Stage(stack, scene, view_layer, [spec])
        with stage.survey():
            work = faces.survey(stage, spec)
            while True:
                try:
                    next(work)
                except StopIteration as end:
                    return end.value, spec


def distances_to_box(spec, height: int) -> np.ndarray:
    """(h, 2h) metres from the capture point to the walls of the box."""
    ways = equirect.directions(2 * height, height).reshape(-1, 3) @ spec.box.face_normals.T
    start = spec.box.coordinates(spec.capture_point[None])[0]
    ahead = spec.box.half_widths - start * np.sign(ways)
    return (ahead / np.abs(ways)).min(-1).reshape(height, 2 * height)


@pytest.fixture
def room() -> None:
    scenes.emissive_room()
    for item in [o for o in bpy.data.objects if o.type == "MESH" and not o.name.startswith("Wall")]:
        bpy.data.objects.remove(item)
    scenes.add_room_probe(scenes.EMISSIVE_ROOM, (0.5, -0.3, -0.35))


@pytest.mark.parametrize("engine", list(Engine))
def test_walls_are_as_far_as_the_box(room: None, engine: Engine) -> None:
    nearness, spec = surveyed(engine=engine)
    assert np.allclose(1.0 / nearness, distances_to_box(spec, len(nearness)), rtol=0.03)  # an edge between two texels
    off = np.abs(1.0 / nearness - distances_to_box(spec, len(nearness)))
    assert (off < 1e-3).mean() > 0.85


def test_nothing_is_infinitely_far(room: None) -> None:
    for item in [o for o in bpy.data.objects if o.type == "MESH"]:
        bpy.data.objects.remove(item)
    assert (surveyed()[0] == 0.0).all()


def test_lamps_panes_and_the_world_are_not_there(room: None) -> None:
    empty, spec = surveyed()
    world = bpy.context.scene.world
    next(n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground").inputs["Strength"].default_value = 9
    bpy.ops.object.light_add(type="AREA", location=spec.box.centre + np.array([0.0, 0.0, 0.5]))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=spec.box.centre + np.array([1.0, 0.0, 0.0]))
    ball = bpy.context.object
    ball.data.materials.append(scenes.principled("Pane", Transmission_Weight=1.0))
    assert np.array_equal(surveyed()[0], empty)
    ball.data.materials[0] = scenes.principled("Stone")
    assert (surveyed()[0] > 1.0).any()


def test_a_survey_leaves_no_trace(room: None) -> None:
    surveyed()  # the first render makes an image
    before = settled()
    surveyed()
    assert settled() == before
