"""Under a uniform white world the twin of a Principled surface reflects what Cycles' own surface reflects."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import render
from pcc_addon.blender.shade.twin import has_twins
from sample_blends.scenes import add_camera, principled
from tests.render.white import plane_under_a_white_sky

ANGLES = [math.radians(a) for a in (90, 45, 20, 8)]

SURFACES = [
    {"Roughness": 0.0},
    {"Roughness": 0.05},
    {"Roughness": 0.3},
    {"Roughness": 0.6},
    {"Roughness": 0.2, "IOR": 1.2},
    {"Roughness": 0.2, "Specular IOR Level": 1.0, "Specular Tint": (1.0, 0.5, 0.2, 1.0)},
    {"Roughness": 0.0, "Metallic": 1.0},
    {"Roughness": 0.3, "Metallic": 1.0},
    {"Roughness": 0.3, "Metallic": 1.0, "Specular Tint": (0.2, 0.5, 1.0, 1.0)},
    {"Roughness": 0.2, "Metallic": 0.5},
    {"Roughness": 0.3, "Alpha": 0.4},
    {"Roughness": 0.3, "Emission Strength": 0.5, "Emission Color": (0.2, 0.4, 0.6, 1.0)},
]


LITTLE_ANISOTROPY = [
    {"Roughness": 0.3, "Metallic": 1.0, "Anisotropic": 0.2},
    {"Roughness": 0.4, "Metallic": 1.0, "Anisotropic": 0.2, "Anisotropic Rotation": 0.25},
    {"Roughness": 0.4, "Anisotropic": 0.2, "Anisotropic Rotation": 0.25},
]
LAYERED = [
    {"Roughness": 0.0, "Coat Weight": 1.0, "Coat Roughness": 0.0},
    {"Roughness": 0.3, "Coat Weight": 0.7, "Coat Roughness": 0.1, "Coat Tint": (0.9, 0.5, 0.2, 1.0)},
    {"Roughness": 0.2, "Metallic": 1.0, "Coat Weight": 1.0, "Coat Roughness": 0.2},
    {"Roughness": 0.2, "Sheen Weight": 1.0, "Sheen Roughness": 0.4},
    {"Roughness": 0.1, "Coat Weight": 1.0, "Alpha": 0.5, "Emission Strength": 0.5},
]
OTHERS = [
    ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.0}),
    ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.4}),
    ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.4, "Anisotropy": 0.2}),
    ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.4, "Anisotropy": -0.2}),
    ("ShaderNodeBsdfMetallic", {"Roughness": 0.0}),
    ("ShaderNodeBsdfMetallic", {"Roughness": 0.3, "Anisotropy": 0.2}),
    ("ShaderNodeBsdfMetallic", {"Roughness": 0.4, "Edge Tint": (0.2, 0.5, 1.0, 1.0)}),
]


@pytest.fixture(scope="module")
def white_world(addon: None) -> bpy.types.Scene:
    return plane_under_a_white_sky()


def _seen(scene: bpy.types.Scene, samples: int) -> np.ndarray:
    """(angles, 3) mean radiance towards cameras at `ANGLES` above the plane."""
    found = []
    for angle in ANGLES:
        old = scene.camera
        add_camera(Vector((math.cos(angle), 0.0, math.sin(angle))) * 3.0, Vector(), 200.0, 8, 8)
        if old:
            bpy.data.objects.remove(old)
        found.append(render(scene, samples=samples).pixels.mean((0, 1)))
    return np.array(found)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "inputs", SURFACES + LAYERED, ids=lambda inputs: ", ".join(f"{k} {v}" for k, v in inputs.items())
)
def test_reflected_and_diffuse_light_add_up_as_in_cycles(white_world: bpy.types.Scene, inputs: dict) -> None:
    keys = {key.replace(" ", "_"): value for key, value in inputs.items()}
    _compare(white_world, principled("Surface", Base_Color=(0.6, 0.3, 0.1, 1.0), **keys))


@pytest.mark.parametrize("inputs", LITTLE_ANISOTROPY, ids=lambda inputs: ", ".join(map(str, inputs.values())))
def test_a_little_anisotropy_reflects_nearly_as_none(white_world: bpy.types.Scene, inputs: dict) -> None:
    """Lobes that are wider along the view hide more of their facets at grazing angles."""
    keys = {key.replace(" ", "_"): value for key, value in inputs.items()}
    _compare(white_world, principled("Surface", Base_Color=(0.6, 0.3, 0.1, 1.0), **keys), 0.02)


@pytest.mark.sweep
@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX", "BECKMANN"])
@pytest.mark.parametrize(("kind", "inputs"), OTHERS)
def test_other_lobes_reflect_as_in_cycles(
    white_world: bpy.types.Scene, kind: str, inputs: dict, distribution: str
) -> None:
    material = principled("Surface")
    node = material.node_tree.nodes.new(kind)
    node.distribution = distribution
    node.inputs[0].default_value = (0.6, 0.3, 0.1, 1.0)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    output = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    material.node_tree.links.new(node.outputs[0], output.inputs["Surface"])
    _compare(white_world, material)


def _compare(white_world: bpy.types.Scene, material: bpy.types.Material, tolerance: float = 0.012) -> None:
    plane = bpy.data.objects["Plane"]
    plane.data.materials.clear()
    plane.data.materials.append(material)
    truth = _seen(white_world, 256)
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    assert has_twins(material)
    ours = _seen(white_world, 16)
    bpy.ops.pcc.remove()
    # Monte Carlo noise of the truth, and the fit of rough lobes (0.03 at worst, at grazing angles only).
    np.testing.assert_allclose(ours, truth, atol=tolerance)
