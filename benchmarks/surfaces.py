"""Error of the emissive room's floor over its roughness, its bumps and the number of probes that share it.

python3 dev.py run benchmarks/surfaces.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from contextlib import redirect_stdout
from dataclasses import dataclass

import bpy
import numpy as np

from benchmarks.measure import covered, relative_rmse, render, start, table, write_page
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room, principled_node

SAMPLES, FACE = 256, 256
ROUGHNESSES = (0.0, 0.1, 0.2, 0.3, 0.45, 0.6)
STRENGTHS = (0.0, 0.25, 0.5, 0.75, 1.0)
PROBES = (1, 2, 4, 8)
_Change = Callable[[bpy.types.Material], None]


@dataclass(frozen=True)
class Case:
    """A floor and what the path tracer shows of it: the truth, and how far two of its pictures are apart."""

    title: str
    truth: np.ndarray
    noise: float
    change: _Change


def constant(roughness: float) -> _Change:
    return lambda material: _set(material, "Roughness", roughness)


def textured(highest: float) -> _Change:
    """Roughness from 0 to `highest` in soft patches of about a metre."""

    def change(material: bpy.types.Material) -> None:
        noise = _noise(material, 1.0)
        node = material.node_tree.nodes.new("ShaderNodeMapRange")
        node.inputs["From Min"].default_value, node.inputs["From Max"].default_value = 0.3, 0.7
        node.inputs["To Max"].default_value = highest
        material.node_tree.links.new(noise, node.inputs["Value"])
        material.node_tree.links.new(node.outputs[0], principled_node(material).inputs["Roughness"])

    return change


def bumpy(strength: float) -> _Change:
    """Waves of about half a metre, a centimetre high at most."""

    def change(material: bpy.types.Material) -> None:
        bump = material.node_tree.nodes.new("ShaderNodeBump")
        bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = strength, 0.01
        material.node_tree.links.new(_noise(material, 2.0), bump.inputs["Height"])
        material.node_tree.links.new(bump.outputs[0], principled_node(material).inputs["Normal"])

    return change


def _set(material: bpy.types.Material, name: str, value: float) -> None:
    principled_node(material).inputs[name].default_value = value


def _noise(material: bpy.types.Material, scale: float) -> bpy.types.NodeSocket:
    nodes, links = material.node_tree.nodes, material.node_tree.links
    place, noise = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = scale, 0.0
    links.new(place.outputs["Position"], noise.inputs["Vector"])
    return noise.outputs[0]


def plain(material: bpy.types.Material) -> None:
    """Take everything away that a case has put there."""
    node = principled_node(material)
    kept = {"ShaderNodeBsdfPrincipled", "ShaderNodeOutputMaterial"}
    for other in [n for n in material.node_tree.nodes if n.bl_idname not in kept]:
        material.node_tree.nodes.remove(other)
    node.inputs["Roughness"].default_value = 0.0


def path_traced(scene: bpy.types.Scene, mask: np.ndarray, changes: Iterable[tuple[str, _Change]]) -> list[Case]:
    material, cases = bpy.data.materials["Mirror"], []
    for title, change in changes:
        change(material)
        pictures = []
        for seed in (1, 2):
            scene.cycles.seed = seed
            pictures.append(render(scene, samples=SAMPLES).pixels)
        truth = np.mean(pictures, 0)
        noise = relative_rmse(pictures[0], pictures[1], mask) / 2.0  # of the mean of both
        cases.append(Case(title, truth, noise, change))
        plain(material)
    return cases


def shown(
    scene: bpy.types.Scene, mask: np.ndarray, cases: Iterable[Case], probes: list[bpy.types.Object]
) -> list[list]:
    """A row for each case: its error with and without correction by the box, and the noise of the truth."""
    material, rows = bpy.data.materials["Mirror"], []
    for case in cases:
        case.change(material)
        bpy.ops.pcc.inject()
        errors = []
        for correction in ("BOX", "NONE"):
            for probe in probes:
                probe.pcc_probe.correction = correction
            errors.append(relative_rmse(render(scene, samples=SAMPLES).pixels, case.truth, mask))
        for probe in probes:
            probe.pcc_probe.correction = "BOX"
        bpy.ops.pcc.remove()
        plain(material)
        rows.append([case.title, f"{errors[0]:.3f}", f"{errors[1]:.3f}", f"{case.noise:.4f}"])
    return rows


def bake(offsets: Iterable[tuple[float, float, float]]) -> list[bpy.types.Object]:
    """Probes of the whole room captured at these places, each shown in a strip that overlaps its neighbours'."""
    offsets = list(offsets)
    probes = []
    half = EMISSIVE_ROOM.half_extents[0]
    for k, offset in enumerate(offsets):
        probe = add_room_probe(EMISSIVE_ROOM, offset)
        settings = probe.pcc_probe
        settings.resolution, settings.samples, settings.denoise = FACE, 16, False
        settings.effects.faces = "ON"  # the floor is a mirror while they are baked, and then is not
        width = 2.0 * half / len(offsets)
        low, high = k * width - width / 4.0, (len(offsets) - k - 1) * width - width / 4.0
        settings.influence_low[0], settings.influence_high[0] = -max(low, 0.0), -max(high, 0.0)
        settings.falloff = width / 4.0
        probes.append(probe)
    bpy.ops.pcc.bake(scope="ALL")
    return probes


def strip(count: int) -> list[tuple[float, float, float]]:
    """Capture points in a row along the room, 0.35 m below its middle."""
    half = EMISSIVE_ROOM.half_extents[0]
    return [((2 * k + 1 - count) * half / count, 0.0, -0.35) for k in range(count)]


def main() -> None:
    start()
    head = ["floor", "box", "classic", "noise of the truth"]
    with redirect_stdout(sys.stderr):
        scene = emissive_room()
        scene.render.resolution_x, scene.render.resolution_y = 240, 135
        mask = covered(scene, bpy.data.objects["Wall -Z"])
        rough = [(f"roughness {r:g}", constant(r)) for r in ROUGHNESSES]
        rough += [(f"roughness 0 … {r:g}, textured", textured(r)) for r in (0.3, 0.6)]
        cases = path_traced(scene, mask, rough)
        bumps = path_traced(scene, mask, [(f"strength {s:g}", bumpy(s)) for s in STRENGTHS])
        probes = bake(strip(1))
        by_roughness, by_bump = shown(scene, mask, cases, probes), shown(scene, mask, bumps, probes)
        by_count = []
        for count in PROBES:
            for probe in list(probes):
                bpy.data.objects.remove(probe)
            probes = bake(strip(count))
            [[_, box, classic, noise]] = shown(scene, mask, cases[:1], probes)
            by_count.append([count, box, classic, noise])
    text = (
        f"The emissive room, faces of {FACE} pixels, {SAMPLES} samples, 240 × 135 pixels, Cycles. Relative RMSE over "
        "the floor's pixels; the truth is the mean of two path-traced pictures, whose noise is half of how far they "
        "are apart. At roughness 0.6 the levels blur by the capture point's distances and the box gains nothing over "
        "the classic lookup: *Contact Hardening* is for that (docs/lobe_shape.md).\n\n## Roughness of a metal floor\n\n"
        + table(head, by_roughness)
        + "\n\n## Bumps of a mirror floor\n\nSoft waves of about half a metre and a centimetre's height.\n\n"
        + table(head, by_bump)
        + "\n\n## Probes that share a mirror floor\n\nAll boxes are the room's; each probe is captured at the middle "
        "of its strip of the room and hands over to the next one within a quarter of the strip.\n\n"
        + table(["probes", *head[1:]], by_count)
    )
    write_page("surfaces.md", "Roughness, bumps, several probes", "python3 dev.py run benchmarks/surfaces.py", text)


if __name__ == "__main__":
    main()
