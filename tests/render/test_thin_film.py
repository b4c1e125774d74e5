"""Thin films in a uniform white world, against Cycles: 100 nm to 1 µm thick from one side of the picture on."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import render
from pcc_addon.blender import compat
from pcc_addon.blender.shade.twin import has_twins
from sample_blends.scenes import add_camera, principled
from tests.blender.helpers import bake, put_in
from tests.render.white import plane_under_a_white_sky

ANGLES = (90, 45, 20, 8)
PRINCIPLED, METALLIC, GLASS = "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfMetallic", "ShaderNodeBsdfGlass"
METALS = pytest.mark.skipif(not compat.FILMS_ON_METAL, reason="Cycles shows no film over metals before 5.0")
BEFORE_5 = 0.0 if compat.FILMS_ON_METAL else 0.1  # by which Cycles' own colours were others

DIELECTRICS = [
    {"Roughness": roughness, "Thin Film IOR": film} for roughness in (0.0, 0.2, 0.4) for film in (1.2, 1.33, 2.0)
]
OTHERS = [
    {"Roughness": 0.0, "Thin Film IOR": 1.33, "IOR": 1.0},
    {"Roughness": 0.2, "Thin Film IOR": 1.6, "Specular IOR Level": 0.9, "Specular Tint": (1.0, 0.5, 0.2, 1.0)},
    {"Roughness": 0.2, "Thin Film IOR": 1.6, "Specular IOR Level": 0.0},
    {"Roughness": 0.2, "Thin Film IOR": 1.6, "Coat Weight": 0.5},
    {"Roughness": 0.4, "Thin Film IOR": 1.33, "IOR": 1.1},
]


@pytest.fixture
def white_world(addon: None) -> bpy.types.Scene:
    return plane_under_a_white_sky()


def coated(kind: str, inputs: dict, color: tuple = (0.6, 0.3, 0.1), distribution: str = "") -> bpy.types.Material:
    """A material whose film becomes thicker from left to right."""
    material = principled("Film")
    tree = material.node_tree
    node = next((n for n in tree.nodes if n.bl_idname == kind), None) or tree.nodes.new(kind)
    node.inputs[0].default_value = (*color, 1.0)
    node.distribution = distribution or node.distribution
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    window, across, thickness = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "SeparateXYZ", "Math"))
    thickness.operation = "MULTIPLY_ADD"
    thickness.inputs[1].default_value, thickness.inputs[2].default_value = 900.0, 100.0
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(window.outputs["Window"], across.inputs[0])
    tree.links.new(across.outputs[0], thickness.inputs[0])
    tree.links.new(thickness.outputs[0], node.inputs["Thin Film Thickness"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def seen(scene: bpy.types.Scene, samples: int) -> np.ndarray:
    """(angles, 32, 3) radiance towards cameras at `ANGLES` above the plane, by the thickness."""
    found = []
    for angle in map(math.radians, ANGLES):
        camera = add_camera(Vector((math.cos(angle), 0.0, math.sin(angle))) * 3.0, Vector(), 200.0, 32, 8)
        camera.data.type, camera.data.ortho_scale = "ORTHO", 1.0
        found.append(render(scene, samples=samples).pixels.mean(0))
        bpy.data.objects.remove(camera)
    return np.array(found)


def compare(scene: bpy.types.Scene, material: bpy.types.Material, tolerance: float) -> None:
    bpy.data.objects["Plane"].data.materials.append(material)
    truth = seen(scene, 256)
    bake(bpy.data.objects["Sky"])
    put_in()
    assert has_twins(material)
    ours = seen(scene, 16)
    colours, theirs = (found - found.mean(1, keepdims=True) for found in (ours, truth))
    off = np.sqrt(np.square(colours - theirs).mean() / np.square(theirs).mean())
    np.testing.assert_allclose(ours, truth, atol=tolerance)
    assert off < 0.35, "the film's colours are others"


def ids(inputs: object) -> str:
    return ", ".join(f"{k} {v}" for k, v in inputs.items()) if isinstance(inputs, dict) else str(inputs)


@pytest.mark.sweep
@pytest.mark.parametrize("inputs", DIELECTRICS + OTHERS, ids=ids)
def test_a_film_over_a_dielectric_shows_the_colours_of_cycles(white_world: bpy.types.Scene, inputs: dict) -> None:
    compare(white_world, coated(PRINCIPLED, inputs), 0.03 + BEFORE_5)


def test_single_scattering_leaves_the_base_what_it_does_in_cycles(white_world: bpy.types.Scene) -> None:
    compare(white_world, coated(PRINCIPLED, {"Roughness": 0.4, "Thin Film IOR": 1.33}, distribution="GGX"), 0.03)


@pytest.mark.sweep
@METALS
@pytest.mark.parametrize("tint", [(1.0, 1.0, 1.0, 1.0), (0.3, 0.6, 1.0, 1.0)])
@pytest.mark.parametrize("inputs", DIELECTRICS, ids=ids)
def test_a_film_over_a_metal_shows_the_colours_of_cycles(
    white_world: bpy.types.Scene, inputs: dict, tint: tuple
) -> None:
    compare(white_world, coated(METALLIC, {**inputs, "Edge Tint": tint}, (0.9, 0.5, 0.1)), 0.03)


@pytest.mark.skipif(not compat.FILMS_ON_BOTH, reason="the shader is too large for Cycles before 5.2")
def test_a_film_covers_what_metallic_mixes(white_world: bpy.types.Scene) -> None:
    inputs = {"Roughness": 0.2, "Metallic": 0.5, "Thin Film IOR": 1.6}
    compare(white_world, coated(PRINCIPLED, inputs, (0.9, 0.5, 0.1)), 0.03)


@pytest.mark.skipif(compat.FILMS_ON_METAL, reason="Cycles shows films over metals from 5.0 on")
def test_a_film_covers_no_metal_where_cycles_shows_none(white_world: bpy.types.Scene) -> None:
    inputs = {"Roughness": 0.2, "Metallic": 0.5, "Thin Film IOR": 1.6}
    compare(white_world, coated(PRINCIPLED, inputs, (0.9, 0.5, 0.1)), 0.03)


@pytest.mark.sweep
@pytest.mark.parametrize("roughness", [0.0, 0.3])
@pytest.mark.parametrize("film", [1.33, 2.0])
def test_a_film_over_glass_shows_the_colours_of_cycles(
    white_world: bpy.types.Scene, roughness: float, film: float
) -> None:
    inputs = {"Transmission Weight": 1.0, "Roughness": roughness, "Thin Film IOR": film}
    compare(white_world, coated(PRINCIPLED, inputs, (0.3, 0.2, 0.1)), 0.03 + BEFORE_5)


@pytest.mark.skipif(compat.FILMS_ON_BOTH, reason="Cycles has room for films over both from 5.2 on")
def test_a_film_that_metallic_mixes_makes_no_shader_that_is_too_large(white_world: bpy.types.Scene) -> None:
    inputs = {"Roughness": 0.2, "Metallic": 0.5, "Thin Film IOR": 1.6}
    material = coated(PRINCIPLED, inputs, (0.9, 0.5, 0.1))
    bpy.data.objects["Plane"].data.materials.append(material)
    truth = seen(white_world, 64).mean()
    bake(bpy.data.objects["Sky"])
    put_in()
    assert has_twins(material)
    assert seen(white_world, 16).mean() == pytest.approx(truth, abs=0.1)


@pytest.mark.sweep
@pytest.mark.skipif(not compat.FILMS_ON_METAL, reason="the Glass BSDF has films from 5.0 on")
@pytest.mark.parametrize("film", [1.33, 2.0])
def test_a_film_over_a_glass_bsdf_shows_the_colours_of_cycles(white_world: bpy.types.Scene, film: float) -> None:
    """It tints what passes as what it mirrors, so that half of the world must be black."""
    tree = white_world.world.node_tree
    background = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground")
    place, split, above = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "SeparateXYZ", "Math"))
    above.operation, above.inputs[1].default_value = "GREATER_THAN", 0.0
    tree.links.new(place.outputs["Generated"], split.inputs[0])
    tree.links.new(split.outputs["Z"], above.inputs[0])
    tree.links.new(above.outputs[0], background.inputs["Strength"])
    bpy.data.objects["Sky"].pcc_probe.resolution = 64
    compare(white_world, coated(GLASS, {"Roughness": 0.0, "Thin Film IOR": film}, (0.8, 0.9, 1.0)), 0.03)
