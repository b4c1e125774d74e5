"""What relief brings in furnished rooms with a mirror for a floor, and what it costs.

python3 dev.py run benchmarks/relief.py                     # our own room
python3 dev.py run benchmarks/relief.py ROOM.blend FLOOR    # and another file, whose material FLOOR becomes a mirror

A room that has no probe gets one around all that is in it, fitted if it can be. Writes docs/relief.md.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import bpy
import numpy as np

from benchmarks.measure import ROOT, open_room, pixels_of, relative_rmse, render, start, table, write_between
from pcc_addon.blender.read.probes import all_probes, bake_record
from pcc_addon.core.probe import Engine
from sample_blends import scenes

PAGE = ROOT / "docs" / "relief.md"
WIDTH, TRUTH_SAMPLES, RESOLUTION, BAKE_SAMPLES = 480, 512, 512, 64
FRAME_SAMPLES, ROUNDS = {Engine.CYCLES: 8, Engine.EEVEE: 8}, 3


@dataclass(frozen=True)
class Rung:
    """Settings of a probe, and how the table calls them."""

    words: str
    correction: str
    steps: int = 12
    refinements: int = 4


RUNGS = (
    Rung("classic", "NONE"),
    Rung("box", "BOX"),
    *(Rung(f"relief, {k} steps", "RELIEF", k) for k in (4, 8, 12, 16, 24, 48)),
    *(Rung(f"relief, 12 steps, {k} halvings", "RELIEF", 12, k) for k in (0, 2, 8)),
)


def main() -> None:
    start()
    rooms: dict[str, Callable[[], str]] = {"our furnished room": _furnished}
    if len(sys.argv) > 2:
        path, floor = sys.argv[1:3]
        rooms[Path(path).stem.replace("_", " ")] = lambda: _another(path, floor)
    text = []
    for name, build in rooms.items():
        floor = build()
        text.append(f"### {name[0].upper()}{name[1:]}\n\n{measured(floor)}")
    write_between(PAGE, "rooms: written by benchmarks/relief.py", "\n\n".join(text))


def measured(floor: str) -> str:
    """The table of the open scene, of the pixels that show a material."""
    scene = bpy.context.scene
    largest = max(scene.render.resolution_x, scene.render.resolution_y)
    scene.render.resolution_percentage = max(1, round(100 * WIDTH / largest))
    mask = pixels_of(scene, {floor})
    scene.cycles.use_denoising = True
    truth = render(scene, Engine.CYCLES, TRUTH_SAMPLES).pixels
    scene.cycles.use_denoising = False
    probe = all_probes(scene)[0]
    settings = probe.pcc_probe
    settings.resolution, settings.samples = RESOLUTION, BAKE_SAMPLES
    settings.correction = "RELIEF"
    bpy.ops.pcc.bake(scope="ALL")
    record = bake_record(probe)
    bpy.ops.pcc.inject()
    bright = truth[mask].max(-1) > 20.0 * np.median(truth[mask])
    dim = mask.copy()
    dim[mask] = ~bright

    def show(rung: Rung) -> None:
        settings.correction = rung.correction
        settings.relief_steps, settings.relief_refinements = rung.steps, rung.refinements

    pictures = {}
    for rung in RUNGS:
        show(rung)
        pictures[rung] = render(scene, Engine.CYCLES, 64).pixels
    seconds = {engine: _alternate(scene, engine, show) for engine in Engine}
    rows = []
    for k, rung in enumerate(RUNGS):
        found = pictures[rung]
        ratios = [f"{times[k] / times[1]:.2f}" for times in seconds.values()]
        errors = [f"{relative_rmse(found, truth, where):.3f}" for where in (mask, dim)]
        rows.append([rung.words, *errors, f"{_of_logarithms(found[mask], truth[mask]):.3f}", *ratios])
    head = ["correction", "error", "without lamps", "in stops", "Cycles frame ÷ box", "EEVEE frame ÷ box"]
    departs = f"What was captured departs from the box by up to {100.0 * record.departure:.0f} % of the distance."
    return f"{departs}\n\n{table(head, rows)}"


def _of_logarithms(found: np.ndarray, truth: np.ndarray) -> float:
    """The mean difference of radiances in stops, which a few bright pixels do not decide."""
    floor = 0.05 * float(np.median(truth))
    return float(np.abs(np.log2((found + floor) / (truth + floor))).mean())


def _alternate(scene: bpy.types.Scene, engine: Engine, show: Callable[[Rung], None]) -> Sequence[float]:
    times: list[list[float]] = [[] for _ in RUNGS]
    for turn in range(ROUNDS + 1):  # the first one warms up
        for k, rung in enumerate(RUNGS):
            show(rung)
            seconds = render(scene, engine, FRAME_SAMPLES[engine]).seconds
            if turn:
                times[k].append(seconds)
    return [median(each) for each in times]


def _furnished() -> str:
    """The gallery's hall with a table, shelves and boxes on a mirror."""
    scenes.gallery()
    room = scenes.GALLERY
    floor = bpy.data.materials["Polished Stone"]
    _mirror(floor)
    wood = scenes.principled("Wood", Base_Color=(0.35, 0.18, 0.08, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    low = -room.half_extents[2]
    for place, half in (
        ((1.5, 0.5, low + 0.72), (0.9, 0.5, 0.03)),
        *(((1.5 + x, 0.5 + y, low + 0.35), (0.04, 0.04, 0.35)) for x in (-0.8, 0.8) for y in (-0.4, 0.4)),
        ((-2.5, 2.6, low + 0.9), (0.5, 0.3, 0.9)),
        ((3.8, -1.8, low + 0.4), (0.6, 0.6, 0.4)),
    ):
        scenes.add_box(room, "Furniture", place, half, wood)
    bpy.context.view_layer.update()
    return floor.name


def _another(path: str, floor: str) -> str:
    open_room(Path(path), fit=True)
    _mirror(bpy.data.materials[floor])
    return floor


def _mirror(material: bpy.types.Material) -> None:
    node = scenes.principled_node(material)
    for name, value in (("Metallic", 1.0), ("Roughness", 0.0), ("Base Color", (0.9, 0.9, 0.9, 1.0))):
        for link in list(node.inputs[name].links):
            material.node_tree.links.remove(link)
        node.inputs[name].default_value = value


if __name__ == "__main__":
    main()
