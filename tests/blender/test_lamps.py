"""Stand-ins for lamps: the radiance and the size that Cycles shows of a visible lamp."""

from __future__ import annotations

import math
from contextlib import ExitStack

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender.bake import lamps
from pcc_addon.core import equirect
from tests.blender.helpers import bake, picture, small_probe

AREA = {"energy": 50.0}
POINT = {"energy": 30.0, "shadow_soft_size": 0.6}
SPOT = POINT | {"spot_size": 1.2, "spot_blend": 0.0}
LAMPS = {  # kind, scale, settings; where the capture point is in the lamp's own direction −Z, turned by `aside`
    "square": ("AREA", (1, 1, 1), AREA | {"shape": "SQUARE", "size": 1.2}, 0.0),
    "rectangle": ("AREA", (1, 1, 1), AREA | {"shape": "RECTANGLE", "size": 1.5, "size_y": 0.8}, 0.3),
    "disk": ("AREA", (1, 1, 1), AREA | {"shape": "DISK", "size": 1.2}, 0.2),
    "ellipse": ("AREA", (1, 1, 1), AREA | {"shape": "ELLIPSE", "size": 1.5, "size_y": 0.8}, 0.0),
    "scaled": ("AREA", (2.0, 0.7, 1.0), AREA | {"shape": "SQUARE", "size": 0.8}, 0.0),
    "exposed": ("AREA", (1, 1, 1), AREA | {"size": 1.2, "exposure": 1.5}, 0.0),
    "not normalised": ("AREA", (1, 1, 1), AREA | {"size": 1.2, "normalize": False}, 0.0),
    "point": ("POINT", (1, 1, 1), POINT, 0.0),
    "point, not normalised": ("POINT", (1, 1, 1), POINT | {"normalize": False}, 0.0),
    "spot": ("SPOT", (1, 1, 1), SPOT, 0.0),
    "spot, beside its cone": ("SPOT", (1, 1, 1), SPOT, 0.8),
    "spot, in its blend": ("SPOT", (1, 1, 1), SPOT | {"spot_blend": 0.8}, 0.35),
    "sun": ("SUN", (1, 1, 1), {"energy": 2.0, "angle": 0.4}, 0.0),
    "sun, not normalised": ("SUN", (1, 1, 1), {"energy": 2.0, "angle": 0.4, "normalize": False}, 0.0),
}


@pytest.mark.sweep
@pytest.mark.parametrize("name", LAMPS)
def test_a_stand_in_is_as_bright_and_as_large_as_the_lamp(scene, name) -> None:
    kind, scale, settings, aside = LAMPS[name]
    probe = small_probe(location=(0, 0, 0))
    probe.pcc_probe.resolution, probe.pcc_probe.samples = 64, 16
    light = bpy.data.lights.new(name, kind)
    for key, value in settings.items():
        setattr(light, key, value)
    lamp = bpy.data.objects.new(name, light)
    lamp.location, lamp.rotation_euler, lamp.scale = (0, 0, 3), (aside, 0, 0), scale
    scene.collection.objects.link(lamp)
    bpy.context.view_layer.update()
    vertices, _, radiance = lamps._shape(lamp, Vector((0, 0, 0)), 100.0)
    bake(probe)
    shown = picture(probe).mean(-1).astype(np.float64)
    towards = lamp.matrix_world.col[2].to_3d() if kind == "SUN" else Vector((0, 0, 1))
    centre = np.array(towards.normalized())
    found = equirect.lookup(shown[..., None], centre)[0]
    assert float(found) == pytest.approx(radiance, rel=0.03, abs=1e-3)
    if settings.get("spot_blend"):  # Cycles shades the disc itself; the stand-in has its middle's radiance all over
        return
    flux = float((shown * equirect.solid_angles(shown.shape[1], shown.shape[0])[:, None]).sum())
    assert flux == pytest.approx(radiance * solid_angle(vertices), rel=0.06, abs=1e-3)


def solid_angle(vertices: list[Vector]) -> float:
    """Of a convex polygon seen from the origin (van Oosterom and Strackee)."""
    a, total = vertices[0].normalized(), 0.0
    for k in range(1, len(vertices) - 1):
        b, c = vertices[k].normalized(), vertices[k + 1].normalized()
        total += 2.0 * math.atan2(abs(a.dot(b.cross(c))), 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    return total


@pytest.mark.parametrize(
    ("kind", "settings"),
    [("AREA", {"size": 1.0}), ("POINT", {"shadow_soft_size": 0.0}), ("SUN", {"angle": 0.0})],
    ids=["area seen from behind", "point without a size", "sun without a size"],
)
def test_lamps_that_nobody_sees_have_no_stand_in(scene, kind, settings) -> None:
    light = bpy.data.lights.new("Lamp", kind)
    for key, value in settings.items():
        setattr(light, key, value)
    lamp = bpy.data.objects.new("Lamp", light)
    scene.collection.objects.link(lamp)
    bpy.context.view_layer.update()
    assert lamps._shape(lamp, Vector((0, 0, 2)), 100.0) is None


def test_stand_ins_glow_in_the_lamps_colour_where_it_is_and_go_again(scene) -> None:
    lights = []
    for name in ("Seen", "Not Rendered", "Not Reflected"):
        light = bpy.data.lights.new(name, "POINT")
        light.energy, light.shadow_soft_size, light.color = 5.0, 0.25, (1.0, 0.5, 0.25)
        lights.append(bpy.data.objects.new(name, light))
        scene.collection.objects.link(lights[-1])
    scene.collection.objects.link(bpy.data.objects.new("Thing", bpy.data.meshes.new("Thing")))
    lights[0].location, lights[1].hide_render, lights[2].visible_glossy = (1.0, 2.0, 3.0), True, False
    bpy.context.view_layer.update()
    before, blocks = set(scene.objects), (len(bpy.data.meshes), len(bpy.data.materials))
    with ExitStack() as stack:
        lamps.add_stand_ins(stack, scene, Vector((0.0, 0.0, 0.0)), 100.0)
        [stand_in] = set(scene.objects) - before
        vertices, faces, radiance = lamps._shape(lights[0], Vector((0.0, 0.0, 0.0)), 100.0)
        assert [len(face.vertices) for face in stand_in.data.polygons] == [len(face) for face in faces]
        np.testing.assert_allclose([v.co for v in stand_in.data.vertices], vertices, atol=1e-6)
        [emission] = [n for n in stand_in.data.materials[0].node_tree.nodes if n.bl_idname == "ShaderNodeEmission"]
        assert emission.inputs["Color"].default_value[:] == (1.0, 0.5, 0.25, 1.0)
        assert emission.inputs["Strength"].default_value == pytest.approx(radiance)
        assert not stand_in.visible_shadow and not stand_in.visible_diffuse
    assert set(scene.objects) == before and blocks == (len(bpy.data.meshes), len(bpy.data.materials))
