"""The polished floor in the doorway between two rooms: path-traced, and as each probe and both together show it.

python3 dev.py run benchmarks/doorway.py [PICTURES]
"""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from pathlib import Path

import bpy
import numpy as np

from benchmarks.measure import relative_rmse, render, start, table, write_page
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, emissive, principled_node
from sample_blends.two_rooms import DOORWAY_Y, LOUNGE, WHOLE, two_rooms

SAMPLES = {Engine.CYCLES: 32, Engine.EEVEE: 4}
RESOLUTION, TRUTH_SAMPLES = 256, 128
NEAR = 1.0  # metres on both sides of the wall's middle
_OFFSET = 100.0  # keeps positions positive
WAYS = {"Lounge alone": ("Lounge",), "Study alone": ("Study",), "both": ("Lounge", "Study")}


def build(resolution: int = RESOLUTION) -> bpy.types.Scene:
    """The rooms with a polished floor and no mirror, baked; seen from the lounge through the doorway."""
    scene = two_rooms(0.0, doorway=True)
    inputs = principled_node(bpy.data.materials["Tiles"]).inputs
    inputs["IOR"].default_value, inputs["Base Color"].default_value = 2.5, (0.05, 0.05, 0.05, 1.0)
    bpy.data.objects.remove(scene.camera)
    add_camera(LOUNGE.world(1.2, -1.6, 0.7), LOUNGE.world(2.8, DOORWAY_Y, -1.3), 16.0, 240, 135)
    for name in ("Lounge", "Study"):
        bpy.data.objects.remove(bpy.data.objects[f"{name} Mirror"])  # no probe shows a mirror in a mirror
        settings = bpy.data.objects[name].pcc_probe
        settings.resolution, settings.samples = resolution, 8
        settings.outside = "UNCORRECTED"  # each probe alone is to be seen on all of the floor
    bpy.ops.pcc.bake(scope="ALL")
    return scene


def near_doorway(scene: bpy.types.Scene) -> np.ndarray:
    """(h, w) mask of the floor near the doorway, on both sides and in it."""
    material, emission = emissive("Position")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    geometry, add = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
    add.inputs[1].default_value = (_OFFSET,) * 3
    links.new(geometry.outputs["Position"], add.inputs[0])
    links.new(add.outputs[0], emission.inputs["Color"])
    layer = bpy.context.view_layer
    layer.material_override = material
    place = render(scene, samples=1).pixels.astype(np.float64) - _OFFSET
    layer.material_override = None
    bpy.data.materials.remove(material)
    local = (place - np.array(WHOLE.centre)) @ np.array(WHOLE.matrix.to_3x3())
    on_floor = np.abs(local[..., 2] + WHOLE.half_extents[2]) < 0.01
    return on_floor & (np.abs(local[..., 0]) < NEAR) & (np.abs(local[..., 1] - DOORWAY_Y) < NEAR)


def show(probes: tuple[str, ...]) -> None:
    """Let the floor show these probes and no other."""
    nobody = bpy.data.collections.get("Nobody") or bpy.data.collections.new("Nobody")
    for name in ("Lounge", "Study"):
        bpy.data.objects[name].pcc_probe.receivers = None if name in probes else nobody
    bpy.context.view_layer.update()
    bpy.ops.pcc.inject()


def measure(pictures: Path | None = None) -> dict[str, dict[str, float]]:
    """The relative error of the floor near the doorway, by way and engine."""
    scene = build()
    truth, mask = render(scene, samples=TRUTH_SAMPLES).pixels, near_doorway(scene)
    found: dict[str, dict[str, float]] = {}
    _keep(pictures, "path-traced", truth)
    for way, probes in WAYS.items():
        show(probes)
        for engine, samples in SAMPLES.items():
            picture = render(scene, engine, samples).pixels
            errors = found.setdefault(way, {})
            errors[engine.value.title()] = relative_rmse(np.minimum(picture, 1.0), np.minimum(truth, 1.0), mask)
            errors[f"{engine.value.title()}, unclipped"] = relative_rmse(picture, truth, mask)
            _keep(pictures, f"{way}, {engine.value.title()}", picture)
    return found


def _keep(folder: Path | None, name: str, pixels: np.ndarray) -> None:
    """Write a picture to look at."""
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    h, w, _ = pixels.shape
    image = bpy.data.images.new(name, w, h)
    shown = np.ones((h, w, 4), np.float32)
    shown[..., :3] = np.clip(pixels, 0.0, 1.0) ** (1.0 / 2.2)
    image.pixels.foreach_set(shown.ravel())
    image.filepath_raw, image.file_format = str(folder / f"{name}.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        found = measure(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
    columns = list(found["both"])
    rows = [[way, *(f"{errors[column]:.3f}" for column in columns)] for way, errors in found.items()]
    text = (
        "Two furnished rooms with a doorway of 1.0 × 2.1 m in a wall of 12 cm and one polished dark floor "
        "(`sample_blends/two_rooms.py`). Relative error of the floor up to 1 m on both sides of the wall, against "
        f"{TRUTH_SAMPLES} path-traced samples; a probe alone is shown on all of the floor. Radiance is clipped at 1, "
        "as a screen shows it; without that, lamps that the floor reflects through the doorway, which no probe shows "
        "in its place, are nearly all of the error.\n\n" + table(["floor shows", *columns], rows)
    )
    write_page("doorway.md", "Through a doorway", "python3 dev.py run benchmarks/doorway.py", text)


if __name__ == "__main__":
    main()
