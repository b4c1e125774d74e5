"""One expression leads from a surface point to its radiance: with the .exr files, NumPy computes the rendered pixel."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import render
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.store.pictures import read_file
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup, relief
from pcc_addon.core.effects.metal import Metal
from pcc_addon.core.effects.records import Outside
from pcc_addon.core.effects.roughness import mixed, neighbours
from pcc_addon.core.effects.shading import ROUGHNESS
from pcc_addon.core.effects.surface import SurfaceEffects, surface_formula
from pcc_addon.core.expression import Formula
from pcc_addon.core.lookup_plan import Receivers, lookup_effects
from pcc_addon.core.pictures import NEARNESS
from sample_blends.scenes import add_camera, principled_node
from tests.blender.helpers import ROOM, bake, glow, pictures_of, put_in, save, small_room

WIDTH, HEIGHT = 32, 18


def whole(probe: bpy.types.Object, roughness: float, receivers: Receivers) -> Formula:
    """From position, view and normal to the radiance that a metal sends to the eye."""
    record, spec = bake_record(probe), probe_spec(probe)
    departure = record.departs_from(spec.box)
    effects = lookup_effects(spec, receivers, record.capture_point, departure=departure)
    assert bool(effects.steps) == spec.relief
    rungs = [level.roughness for level in record.levels if level.roughness >= 0.0]
    levels = neighbours(rungs, roughness, roughness)
    surface = SurfaceEffects((Metal(pure=True),), smooth=roughness == 0.0)
    [ray] = surface.rays
    known = {
        "Direction": ray.formula()["Direction"],
        "Offset": (0.0, 0.0, 0.0),
        "Capture Point": record.capture_point,
        "Padding": spec.influence_padding,
        "Falloff": spec.influence_falloff,
        "Boundary": spec.boundary,
        "Box Centre": tuple(spec.box.centre),
        "Half Widths": tuple(spec.box.half_widths),
    }
    read = lookup.probe(effects, {f"Level {i}": record.levels[k].height for i, k in enumerate(levels)}, known)
    mix = Formula("Mix", {"Radiance": mixed([rungs[k] for k in levels], ROUGHNESS)})
    shown = read()
    given = {f"Level_{i}": shown[f"Level {i}"] for i in range(len(levels)) if f"Level {i}" in mix.inputs}
    lit = surface_formula(surface)
    return Formula("Whole", {"Radiance": lit(Radiance=mix(**given)["Radiance"])["Reflection"]})


def seen_floor(camera: bpy.types.Object, floor_z: float) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) points of the floor behind the pixels' centres, and (n, 3) unit directions from them to the eye."""
    frame = [camera.matrix_world @ corner for corner in camera.data.view_frame(scene=bpy.context.scene)]
    right, _, left, top = (np.array(corner) for corner in frame)  # upper right, lower right, lower left, upper left
    eye = np.array(camera.matrix_world.translation)
    u, v = np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH, (np.arange(HEIGHT) + 0.5) / HEIGHT)
    target = left + u[..., None] * (right - top) + v[..., None] * (top - left)
    ray = (target - eye).reshape(-1, 3)
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    return eye + ray * ((floor_z - eye[2]) / ray[:, 2:]), -ray


def add_blocks() -> None:
    """What stands in the room, and what hangs from its ceiling."""
    for name, place in (("Block", (0.5, 0.4, -0.7)), ("Lamp", (-0.9, 0.5, 0.5))):
        bpy.ops.mesh.primitive_cube_add(size=0.5, location=ROOM.world(*place))
        bpy.context.object.data.materials.append(glow(name, (0.9, 0.2, 0.9)))
        bpy.context.object.visible_camera = False  # reflections show it


@pytest.mark.sweep
@pytest.mark.parametrize("correction", ["BOX", "RELIEF"])
@pytest.mark.parametrize("outside", [None, Outside.BLACK])
@pytest.mark.parametrize("roughness", [0.0, 0.13])
def test_numpy_computes_the_rendered_pixel_from_the_pictures(scene, tmp_path, roughness, outside, correction) -> None:
    probe = small_room()
    probe.pcc_probe.correction = correction
    if correction == "RELIEF":
        add_blocks()
    probe.pcc_probe.resolution = 64
    node = principled_node(bpy.data.materials["Floor"])
    node.inputs["Metallic"].default_value, node.inputs["Roughness"].default_value = 1.0, roughness
    node.inputs["Base Color"].default_value = (0.8, 0.6, 0.4, 1.0)
    node.distribution = "GGX"
    if outside is not None:  # the floor lies in the fade
        probe.pcc_probe.outside, probe.pcc_probe.falloff = outside.value, 0.5
        probe.location.z += 0.2
    save(tmp_path / "room.blend")
    bake(probe)
    put_in()
    floor_z = ROOM.centre[2] - ROOM.half_extents[2]
    camera = add_camera(ROOM.world(-0.5, -0.4, 0.6), Vector(ROOM.world(0.3, 0.2, -1.0)), 30.0, WIDTH, HEIGHT)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    bpy.context.view_layer.update()
    rendered = render(scene, samples=1).pixels.reshape(-1, 3)
    position, incoming = seen_floor(camera, floor_z)
    kept = dict(zip((level.roughness for level in probe.pcc_probe.levels), pictures_of(probe), strict=True))
    rungs = sorted(roughness for roughness in kept if roughness >= 0.0)
    levels = neighbours(rungs, roughness, roughness)
    files = {f"Level {i}": read_file(kept[rungs[k]]) for i, k in enumerate(levels)}
    if correction == "RELIEF":
        files[relief.PICTURE] = read_file(kept[NEARNESS])
    inputs = {
        "Position": position,
        "Incoming": incoming,
        "Normal": np.broadcast_to((0.0, 0.0, 1.0), position.shape),
        "Base Color": np.broadcast_to((0.8, 0.6, 0.4), position.shape),
        "Metallic": 1.0,
        "Roughness": roughness,
    }
    formula = whole(probe, roughness, Receivers(outside is None, outside is not None))
    expected = evaluate(formula.outputs, inputs, np.float32, files)["Radiance"]
    assert expected.std() > 0.1 or outside is not None
    # The filter is a hundredth of a pixel wide, over which a picture of so few texels changes by this much.
    on_floor = (np.abs(position - ROOM.centre)[:, :2] < np.array(ROOM.half_extents)[:2] - 0.05).all(-1)
    assert on_floor.mean() > 0.9
    off = np.abs(rendered - expected).max(-1)[on_floor]
    assert (off <= 1e-3).mean() == 1.0 if correction == "BOX" else (off <= 1e-3).mean() > 0.98  # edges of things step
