"""How near windows of flat panes come to rooms that are there, and what they cost.

python3 dev.py run benchmarks/interior.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from statistics import median

import bpy
import numpy as np
from mathutils import Vector

from benchmarks.measure import ROOT, relative_rmse, render, start, table, write_between
from pcc_addon.blender.shade.interior import Window, interior_node, room_of_probe, window_material
from pcc_addon.blender.windows import put_on
from pcc_addon.core.effects.interior import Cells
from pcc_addon.core.probe import Engine
from sample_blends.interior import (
    MAIN,
    ROOM,
    Front,
    add_front,
    add_panes,
    bake_room,
    collected,
    furnished_room,
    interior,
    real_rooms,
)
from sample_blends.scenes import EMISSIVE_COLORS, add_camera, add_wall, emissive_checker, empty_scene
from sample_blends.ways import render as render_shown
from sample_blends.ways import side_by_side

PAGE = ROOT / "docs" / "interior.md"
SIZES = (128, 256, 512)
FAR_FRONT = Front("Far", 2, 2, (300.0, -200.0, 40.0), math.radians(28.0), 0.2)
RUNS = 3


def main() -> None:
    start()
    scene, _ = glowing_house()
    glowing = [_row(scene, size, 8, 1) for size in SIZES]
    scene, _ = furnished_house()
    furnished = [_row(scene, size, 64, 256) for size in SIZES[:2]]
    head = ["face, px", "flat picture on the pane", "interior mapping, Cycles", "interior mapping, EEVEE"]
    text = (
        f"Blender {bpy.app.version_string}. Relative RMSE over the panes against path-traced rooms behind them. Four "
        "rooms of 4 × 5 × 3 m behind a front turned by 28°, 360 m from the origin, seen from 6 m before it.\n\n"
        f"Empty rooms whose checkered walls glow, without noise:\n\n{table(head, glowing)}\n\n"
        "Furnished rooms with a lamp, captured with 64 samples, denoised; radiances above 1 count as 1:\n\n"
        f"{table(head, furnished)}\n\n{_times()}"
    )
    write_between(PAGE, "figures: written by benchmarks/interior.py", text)
    _picture()


def glowing_house() -> tuple[bpy.types.Scene, bpy.types.Collection]:
    """Panes far from the origin, of a room whose walls only glow; the room has no wall where the window is."""
    scene = empty_scene()
    before = set(scene.objects)
    for side in ("-X", "+X", "+Y", "+Z", "-Z"):
        add_wall(ROOM, side, emissive_checker(f"Glow {side}", *EMISSIVE_COLORS[side.replace("-Z", "-Y")]))
    room = collected("Room", before)
    _far_panes()
    return scene, room


def furnished_house() -> tuple[bpy.types.Scene, bpy.types.Collection]:
    """The same of a room with furniture and a lamp, and the front's wall before it."""
    scene = empty_scene()
    room = furnished_room()
    add_front(FAR_FRONT)
    _far_panes()
    return scene, room


def _far_panes() -> None:
    add_panes(FAR_FRONT)
    place = FAR_FRONT.matrix
    add_camera(place @ Vector((6.5, -6.0, 2.2)), place @ Vector((3.6, 0.0, 3.1)), 26.0, 320, 240)


def show_rooms(resolution: int, samples: int) -> bpy.types.Material:
    """Bake the room and put it behind the panes: without variety and without glass, as real rooms would be."""
    if "Room" not in bpy.data.objects:
        bake_room(resolution, samples)
    probe = bpy.data.objects["Room"]
    probe.pcc_probe.resolution, probe.pcc_probe.samples = resolution, samples
    bpy.ops.pcc.bake(scope="ALL")
    width, depth, height = (2.0 * h for h in ROOM.half_extents)
    sizes = {"Width": width, "Depth": depth, "Height": height}
    window = Window((room_of_probe(probe),), Cells.UV)
    material = window_material("Window", window, {**sizes, "Mirrored": 0.0, "IOR": 1.0})
    glass = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    glass.inputs["Specular IOR Level"].default_value = 0.0
    put_on(material, [bpy.data.objects["Far Panes"]])
    return material


def seen_panes(scene: bpy.types.Scene) -> np.ndarray:
    """(h, w) mask of the pixels that the panes alone cover: those that differ between two of their colours."""
    panes, shown = bpy.data.objects["Far Panes"], []
    before = panes.active_material
    for radiance in (0.0, 1.0):
        material = bpy.data.materials.new("Mask")
        if material.node_tree is None:
            material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        emission.inputs["Color"].default_value = (radiance, radiance, radiance, 1.0)
        material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
        panes.active_material = material
        shown.append(render(scene, samples=8).pixels[..., 0])
        panes.active_material = before
        bpy.data.materials.remove(material)
    return shown[1] - shown[0] > 0.999


@contextmanager
def rooms_behind(front: Front, room: bpy.types.Collection) -> Iterator[None]:
    """Real rooms instead of the panes, meanwhile."""
    copies = real_rooms(front, room)
    yield
    for copy in copies:
        bpy.data.objects.remove(copy)
    bpy.data.objects[f"{front.name} Panes"].hide_render = False


def _row(scene: bpy.types.Scene, size: int, baked_with: int, truth_samples: int) -> list[object]:
    material = show_rooms(size, baked_with)
    room = next(c for c in bpy.data.collections if c.name in ("Room", "Furnished Room"))
    with rooms_behind(FAR_FRONT, room):
        truth = render(scene, samples=max(truth_samples, 64)).pixels
    mask = seen_panes(scene)
    boxed = {engine: _error(render(scene, engine).pixels, truth, mask) for engine in Engine}
    interior_node(material).inputs["Depth"].default_value = 0.001
    flat = _error(render(scene).pixels, truth, mask)
    return [size, f"{flat:.3f}", f"{boxed[Engine.CYCLES]:.4f}", f"{boxed[Engine.EEVEE]:.4f}"]


def _error(picture: np.ndarray, truth: np.ndarray, mask: np.ndarray) -> float:
    """Of what a screen shows: a lamp is a thousand times as bright as a wall, and would be all that counts."""
    return relative_rmse(np.minimum(picture, 1.0), np.minimum(truth, 1.0), mask)


def _times() -> str:
    scene, room = furnished_house()
    show_rooms(256, 16)
    panes = median(render(scene, samples=64).seconds for _ in range(RUNS))
    with rooms_behind(FAR_FRONT, room):
        real = median(render(scene, samples=64).seconds for _ in range(RUNS))
    return f"A frame of the furnished ones in Cycles takes {panes / real:.2f} of the time that real rooms take."


def _picture() -> None:
    """The sample's main front, its rooms all alike, beside real rooms."""
    scene = interior(384, 64)
    scene.cycles.use_denoising = True
    scene.render.resolution_x, scene.render.resolution_y = 560, 315
    folder = ROOT / "build" / "interior"
    folder.mkdir(parents=True, exist_ok=True)
    varied = render_shown(scene, "Flat panes, varied", folder / "varied.png")
    node = interior_node(bpy.data.materials["Window"])
    white = (1.0, 1.0, 1.0, 1.0)
    plain = {"Mirrored": 0.0, "Lit": 1.0, "Tint A": white, "Tint B": white, "Curtains": 0.0, "Middle": 0.0}
    for name, value in plain.items():
        node.inputs[name].default_value = value
    alike = render_shown(scene, "Flat panes, all alike", folder / "alike.png")
    with rooms_behind(MAIN, bpy.data.collections["Furnished Room"]):
        real = render_shown(scene, "Real rooms behind the main front", folder / "real.png")
    side_by_side([varied, alike, real], ROOT / "docs" / "images" / "interior.png")


if __name__ == "__main__":
    main()
