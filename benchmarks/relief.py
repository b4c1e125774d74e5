"""What relief brings in furnished rooms with a mirror for a floor, and what it costs.

python3 dev.py run benchmarks/relief.py                     # our own room
python3 dev.py run benchmarks/relief.py ROOM.blend FLOOR    # and another file, whose material FLOOR becomes a mirror

A room that has no probe gets one around all that is in it, fitted if it can be. Writes docs/relief.md.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median

import bpy
import numpy as np
from mathutils import Vector

from benchmarks.measure import ROOT, open_room, pixels_of, relative_rmse, render, start, table, write_between
from pcc_addon.blender.read.probes import all_probes, bake_record
from pcc_addon.core.probe import Engine
from sample_blends import scenes

PAGE = ROOT / "docs" / "relief.md"
WIDTH, TRUTH_SAMPLES, RESOLUTION, BAKE_SAMPLES = 320, 256, 256, 32
PICTURE_SAMPLES, FRAME_SAMPLES, ROUNDS = 32, 4, 3


@dataclass(frozen=True)
class Rung:
    """Settings of a probe, how the table calls them, and whether its frames are timed."""

    words: str
    correction: str
    steps: int = 12
    refinements: int = 4
    timed: bool = True


BOX = Rung("box", "BOX")
RUNGS = (
    Rung("classic", "NONE", timed=False),
    BOX,
    *(Rung(f"relief, {k} steps", "RELIEF", k, timed=k in {12, 24}) for k in (4, 8, 12, 16, 24, 48)),
    *(Rung(f"relief, 12 steps, {k} halvings", "RELIEF", 12, k, timed=False) for k in (0, 2, 8)),
)
TWO = Rung("relief, 12 steps, two probes", "RELIEF")


def main() -> None:
    start()
    rooms: dict[str, Callable[[], str]] = {"our furnished room": _furnished}
    if len(sys.argv) > 2:
        path, floor = sys.argv[1:3]
        rooms[Path(path).stem.replace("_", " ")] = partial(_another, path, floor)
    text = []
    for name, build in rooms.items():
        text.append(f"### {name[0].upper()}{name[1:]}\n\n{measured(build())}")
        print(text[-1])
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

    pictures = {}
    for rung in RUNGS:
        _show(scene, rung)
        pictures[rung] = render(scene, Engine.CYCLES, PICTURE_SAMPLES).pixels
    seconds = {engine: _alternate(scene, engine) for engine in Engine}
    _second_probe(scene, probe)
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    _show(scene, TWO)
    pictures[TWO] = render(scene, Engine.CYCLES, PICTURE_SAMPLES).pixels
    rows = []
    for rung, found in pictures.items():
        ratios = [f"{times[rung] / times[BOX]:.2f}" if rung in times else "" for times in seconds.values()]
        errors = [f"{relative_rmse(found, truth, where):.3f}" for where in (mask, dim)]
        rows.append([rung.words, *errors, f"{_of_logarithms(found[mask], truth[mask]):.3f}", *ratios])
    head = ["correction", "error", "without lamps", "in stops", "Cycles frame ÷ box", "EEVEE frame ÷ box"]
    departs = f"What was captured departs from the box by up to {100.0 * record.departure:.0f} % of the distance."
    return f"{departs}\n\n{table(head, rows)}"


def _of_logarithms(found: np.ndarray, truth: np.ndarray) -> float:
    """The mean difference of radiances in stops, which a few bright pixels do not decide."""
    floor = 0.05 * float(np.median(truth))
    return float(np.abs(np.log2((found + floor) / (truth + floor))).mean())


def _show(scene: bpy.types.Scene, rung: Rung) -> None:
    for probe in all_probes(scene):
        settings = probe.pcc_probe
        settings.correction = rung.correction
        settings.relief_steps, settings.relief_refinements = rung.steps, rung.refinements


def _alternate(scene: bpy.types.Scene, engine: Engine) -> dict[Rung, float]:
    """Median seconds of a frame, without those in which EEVEE compiles shaders."""
    times: dict[Rung, list[float]] = {rung: [] for rung in RUNGS if rung.timed}
    for _ in range(ROUNDS):
        for rung, found in times.items():
            _show(scene, rung)
            render(scene, engine, 1)
            found.append(render(scene, engine, FRAME_SAMPLES).seconds)
    return {rung: median(found) for rung, found in times.items()}


def _second_probe(scene: bpy.types.Scene, probe: bpy.types.Object) -> None:
    """A probe of the same box that sees the room from the other side of its middle, shown below the first."""
    offset = Vector(probe.pcc_probe.capture_offset)
    sideways = offset if offset.length > 0.25 else Vector((0.4 * probe.scale[0], 0.4 * probe.scale[1], 0.0))
    bpy.ops.pcc.probe_add(
        name=f"{probe.name} Too",
        location=probe.matrix_world.translation,
        rotation=probe.matrix_world.to_euler(),
        half_extents=probe.matrix_world.to_scale(),
        capture_offset=(-sideways.x, -sideways.y, offset.z),
    )
    other = bpy.context.object
    for name in ("resolution", "samples", "correction"):
        setattr(other.pcc_probe, name, getattr(probe.pcc_probe, name))
    probe.pcc_probe.priority = 1


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
