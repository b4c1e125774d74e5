"""What the benchmarks share: a render as an array, errors, medians, tables."""

from __future__ import annotations

import atexit
import sys
from collections.abc import Container, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np

import pcc_addon
from pcc_addon.blender import rendering
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.rendering import Frame
from pcc_addon.core.probe import Engine
from pcc_addon.quiet import quiet_blender
from sample_blends.scenes import add_probe_around, emissive

ROOT = Path(__file__).resolve().parents[1]


def start() -> None:
    """Register the add-on and keep the lines of Blender's C code off standard output, until the interpreter ends."""
    pcc_addon.register()
    ending = ExitStack()
    atexit.register(ending.close)
    ending.callback(pcc_addon.unregister)  # Blender 4.5 as a module crashes at exit where types are left registered
    sys.stdout = ending.enter_context(quiet_blender())


def render(scene: bpy.types.Scene, engine: Engine = Engine.CYCLES, samples: int = 64) -> Frame:
    """Render the scene's camera; its settings are afterwards as before."""
    return rendering.render(scene, rendering.RenderSettings(engine, samples))


def open_room(path: Path, *, fit: bool = False) -> bpy.types.Scene:
    """A room of others; where it has no probe, one around all that is in it, or fitted to it."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    if not all_probes(scene):
        add_probe_around(scene)
        if fit:
            bpy.ops.pcc.fit()
    return scene


def covered(scene: bpy.types.Scene, item: bpy.types.Object) -> np.ndarray:
    """(h, w) mask of the pixels that only `item` covers, in a scene that is black behind it."""
    item.hide_render = True
    without = render(scene, samples=4).pixels
    item.hide_render = False
    return without.sum(-1) == 0.0


def pixels_of(scene: bpy.types.Scene, materials: Container[str]) -> np.ndarray:
    """(h, w) mask of the pixels that show a material of one of these names."""
    override = bpy.data.materials.new("Mask")
    if override.node_tree is None:
        override.use_nodes = True
    nodes = override.node_tree.nodes
    nodes.clear()
    info, glow, output = (
        nodes.new(kind) for kind in ("ShaderNodeObjectInfo", "ShaderNodeEmission", "ShaderNodeOutputMaterial")
    )
    override.node_tree.links.new(glow.outputs[0], output.inputs["Surface"])
    for item in scene.objects:
        item.pass_index = int(any(slot.material and slot.material.name in materials for slot in item.material_slots))
    override.node_tree.links.new(info.outputs["Object Index"], glow.inputs["Strength"])
    layer, world = scene.view_layers[0], scene.world
    layer.material_override, scene.world = override, None
    mask = render(scene, samples=4).pixels[..., 0] > 0.5
    layer.material_override, scene.world = None, world
    bpy.data.materials.remove(override)
    return mask


def masks(scene: bpy.types.Scene, parts: Mapping[str, str]) -> dict[str, np.ndarray]:
    """(h, w) for each part, at the scene's frame: the pixels in which nothing but the object of that name is seen."""
    material, emission = emissive("Which")
    info = material.node_tree.nodes.new("ShaderNodeObjectInfo")
    material.node_tree.links.new(info.outputs["Object Index"], emission.inputs["Color"])
    for k, name in enumerate(parts.values()):
        bpy.data.objects[name].pass_index = k + 1
    layer = bpy.context.view_layer
    layer.material_override = material
    which = render(scene, samples=1).pixels[..., 0]
    layer.material_override = None
    bpy.data.materials.remove(material)
    for name in parts.values():
        bpy.data.objects[name].pass_index = 0
    return {part: which == k + 1 for k, part in enumerate(parts)}


def relative_rmse(picture: np.ndarray, truth: np.ndarray, mask: np.ndarray | slice = slice(None)) -> float:
    """Root mean square error over `mask`, divided by the root mean square of the truth there; everywhere by default."""
    error = np.square(picture[mask].astype(np.float64) - truth[mask]).mean()
    return float(np.sqrt(error / np.square(truth[mask].astype(np.float64)).mean()))


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def write_page(name: str, title: str, command: str, text: str) -> None:
    """Write docs/NAME with how to make it again, and print the text."""
    page = f"# {title}\n\nMade by `{command}` with Blender {bpy.app.version_string}.\n\n{text}\n"
    (ROOT / "docs" / name).write_text(page, encoding="utf-8")
    print(text)


def write_between(page: Path, marker: str, text: str) -> None:
    """Put text into a page between the comment `marker` and the next "end" comment, and print it."""
    begin, end = f"<!-- {marker} -->\n", "<!-- end -->"
    before, found, rest = page.read_text(encoding="utf-8").partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise ValueError(f"{page.name} has no part between {begin.strip()} and {end}")
    page.write_text(f"{before}{begin}\n{text}\n\n{end}{after}", encoding="utf-8")
    print(text)
