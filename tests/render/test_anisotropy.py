"""Brushed metal that shows a probe, against the path tracer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from unittest.mock import patch

import bpy
import numpy as np
import pytest

from benchmarks.measure import covered, relative_rmse, render
from pcc_addon.core.effects import surface
from pcc_addon.core.effects.anisotropy import Anisotropy
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room
from tests.eevee import without_shadows

WHITE = (1.0, 1.0, 1.0, 1.0)
PRINCIPLED, GLOSSY, METALLIC = "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfMetallic"
METAL = {"Base Color": WHITE, "Metallic": 1.0, "Anisotropic": 0.8}
CASES = {
    "along the default tangent": (PRINCIPLED, METAL, False),
    "turned by a quarter": (PRINCIPLED, {**METAL, "Anisotropic Rotation": 0.25}, False),
    "turned by an eighth": (PRINCIPLED, {**METAL, "Anisotropic Rotation": 0.125}, False),
    "along a linked tangent": (PRINCIPLED, METAL, True),
    "glossy": (GLOSSY, {"Color": WHITE, "Anisotropy": 0.6}, False),
    "glossy, the other way": (GLOSSY, {"Color": WHITE, "Anisotropy": -0.6, "Rotation": 0.1}, False),
    "metallic": (METALLIC, {"Base Color": WHITE, "Edge Tint": WHITE, "Anisotropy": 0.8, "Rotation": 0.1}, False),
}


@contextmanager
def shown_as_round() -> Iterator[None]:
    """While this lasts, anisotropy is not looked at."""

    def is_wide(wanted: object) -> bool:
        return getattr(wanted, "__self__", None) is Anisotropy

    kinds = {
        name: replace(kind, effects=tuple(wanted for wanted in kind.effects if not is_wide(wanted)))
        for name, kind in surface.KINDS.items()
    }
    with patch.object(surface, "KINDS", kinds):
        yield


def brushed(kind: str, inputs: dict, linked: bool) -> bpy.types.Object:
    """The floor of the room, brushed."""
    floor = bpy.data.objects["Wall -Z"]
    tree = floor.data.materials[0].node_tree
    node = next((n for n in tree.nodes if n.bl_idname == kind), None) or tree.nodes.new(kind)
    for name, value in {"Roughness": 0.3, **inputs}.items():
        node.inputs[name].default_value = value
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    if linked:
        way = tree.nodes.new("ShaderNodeCombineXYZ")
        way.inputs["X"].default_value, way.inputs["Y"].default_value = 0.6, 0.8
        tree.links.new(way.outputs[0], node.inputs["Tangent"])
    return floor


@pytest.mark.sweep
@pytest.mark.parametrize("case", CASES)
def test_a_brushed_floor_shows_its_wide_lobe_where_cycles_does(addon: None, case: str) -> None:
    """EEVEE too, whose own lobes are round: its default tangent is that of Cycles."""
    scene = emissive_room()
    without_shadows(scene)
    scene.render.resolution_x, scene.render.resolution_y = 96, 54
    floor = brushed(*CASES[case])
    settings = add_room_probe(EMISSIVE_ROOM, (0.0, 0.0, -0.35)).pcc_probe
    settings.samples, settings.denoise, settings.resolution, settings.contact_hardening = 16, False, 128, True
    mask = covered(scene, floor)
    truth = render(scene, samples=128).pixels
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    ours, eevee = (relative_rmse(render(scene, e, samples=16).pixels, truth, mask) for e in Engine)
    bpy.ops.pcc.remove()
    with shown_as_round():
        bpy.ops.pcc.inject()
        plain = relative_rmse(render(scene, samples=16).pixels, truth, mask)
    print("DBG", case, round(ours, 3), round(eevee, 3), round(plain, 3))
    assert ours < 0.85 * plain and eevee < 0.85 * plain
    assert np.isclose(ours, eevee, atol=0.01)
