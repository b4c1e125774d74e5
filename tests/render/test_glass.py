"""Glass that shows a probe, against the path tracer: in a uniform white world, and in a room of marked walls."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import relative_rmse, render
from pcc_addon.blender.shade.twin import has_twins
from pcc_addon.core.probe import Engine
from sample_blends.scenes import Room, add_camera, add_wall, principled
from tests.blender.helpers import bake, glow, put_in, small_probe
from tests.render.white import white_scene

KINDS = {
    "principled": ("ShaderNodeBsdfPrincipled", {"Transmission Weight": 1.0, "IOR": 1.45}),
    "half": ("ShaderNodeBsdfPrincipled", {"Transmission Weight": 0.5, "IOR": 1.45}),
    "glass": ("ShaderNodeBsdfGlass", {"IOR": 1.33}),
    "refraction": ("ShaderNodeBsdfRefraction", {"IOR": 1.45}),
}


@pytest.fixture
def white_world(addon: None) -> bpy.types.Scene:
    return white_scene()


def glass(kind: str, roughness: float, color: tuple, distribution: str = "GGX") -> bpy.types.Material:
    bl_idname, inputs = KINDS[kind]
    material = principled("Glass")
    tree = material.node_tree
    node = next((n for n in tree.nodes if n.bl_idname == bl_idname), None) or tree.nodes.new(bl_idname)
    for name, value in {**inputs, "Roughness": roughness}.items():
        node.inputs[name].default_value = value
    node.inputs[0].default_value = (*color, 1.0)
    node.distribution = distribution
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


BECKMANN = [("glass", 0.3, "BECKMANN"), ("refraction", 0.3, "BECKMANN")]


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("kind", "roughness", "distribution"), [(k, r, "GGX") for k in KINDS for r in (0.0, 0.3)] + BECKMANN
)
def test_a_clear_surface_under_a_white_world_is_as_bright_as_in_cycles(
    white_world: bpy.types.Scene, kind: str, roughness: float, distribution: str
) -> None:
    """A plane bends light once: what passes is seen without another surface behind."""
    bpy.ops.mesh.primitive_plane_add(size=100.0)
    plane = bpy.context.object
    plane.data.materials.append(glass(kind, roughness, (0.6, 0.3, 0.1), distribution))
    probe = small_probe("Sky", (0.0, 0.0, 0.0), (60.0, 60.0, 60.0), capture_offset=(0.0, 0.0, 1.0))
    probe.pcc_probe.hidden_objects.add().object = plane
    found = {}
    for state in ("truth", "ours"):
        if state == "ours":
            bake(probe)
            put_in()
            assert has_twins(plane.data.materials[0])
        found[state] = []
        for angle in (90, 30, 12):
            radians = math.radians(angle)
            camera = add_camera(Vector((math.cos(radians), 0.0, math.sin(radians))) * 3.0, Vector(), 200.0, 8, 8)
            found[state].append(render(white_world, samples=256 if state == "truth" else 4).pixels.mean((0, 1)))
            bpy.data.objects.remove(camera)
    # Monte Carlo noise of the truth, and the fit of the lobe; a Refraction BSDF is fitted as part of glass.
    np.testing.assert_allclose(found["ours"], found["truth"], atol=0.03 if kind == "refraction" else 0.015)


def marked_room(thing: str) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A turned room of glowing walls, each of a colour of its own: its probe, and something of glass in it."""
    room = Room((2.5, 2.0, 1.5), (40.0, -20.0, 1.5), 0.4)
    for k, side in enumerate(("+X", "-X", "+Y", "-Y", "+Z", "-Z")):
        add_wall(room, side, glow(side, (0.1 + 0.15 * k, 0.9 - 0.15 * k, 0.2 + 0.3 * (k % 3))))
    place = Vector(room.centre) + Vector((-0.4, 0.3, -0.2))
    if thing == "pane":
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=(0.0, 0.0, 0.5))
        bpy.context.object.scale = (1.4, 0.02, 1.4)
    else:
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, segments=96, ring_count=48, location=place)
        bpy.ops.object.shade_smooth()
    item = bpy.context.object
    item.data.materials.append(glass("principled", 0.0, (0.95, 0.95, 1.0)))
    add_camera(place + Vector((1.6, -1.0, 0.4)), place, 45.0, 96, 96)
    probe = small_probe("Room", room.centre, room.half_extents, (0.0, 0.0, 0.4))
    probe.pcc_probe.resolution = 64
    probe.pcc_probe.hidden_objects.add().object = item
    return probe, item


@pytest.mark.heavy
@pytest.mark.parametrize("engine", list(Engine))
@pytest.mark.parametrize("thing", ["ball", "pane"])
def test_glass_shows_the_walls_behind_it_where_they_are(scene, thing: str, engine: Engine) -> None:
    """The corrected picture is at most half as wrong as the uncorrected one; EEVEE shows what Cycles shows."""
    probe, item = marked_room(thing)
    scene.cycles.transmission_bounces = scene.cycles.max_bounces = 16
    truth = render(scene, samples=64).pixels
    item.hide_render = True
    empty = render(scene, samples=1).pixels
    item.hide_render = False
    bake(probe)
    put_in()
    boxed = render(scene, engine, samples=4).pixels
    probe.pcc_probe.correction = "NONE"
    put_in()
    classic = render(scene, engine, samples=4).pixels
    mask = (np.abs(truth - empty).max(-1) > 0.02) & (np.abs(boxed - empty).max(-1) > 0.02)
    assert mask.mean() > 0.05
    assert relative_rmse(boxed, truth, mask) < 0.5 * relative_rmse(classic, truth, mask)
