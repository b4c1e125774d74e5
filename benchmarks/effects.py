"""What each effect costs, and what leaving out those that a scene does not need saves.

python3 dev.py run benchmarks/effects.py                      # the effects, then our samples
python3 dev.py run benchmarks/effects.py effects              # the effects alone; "bakes": those of bakes
python3 dev.py run benchmarks/effects.py relief               # one effect by its key; the others stay as they were
python3 dev.py run benchmarks/effects.py samples ROOM.blend   # the samples alone, and another file

Writes docs/effects.md, and the table of costs that the plan and the panels show.
"""

from __future__ import annotations

import json
import os
import platform
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from datetime import date
from functools import partial
from pathlib import Path
from statistics import median

import bpy

from benchmarks.effects_cases import BAKES, CASES, Case, build, switch
from benchmarks.measure import ROOT, open_room, render, start, table, write_between
from pcc_addon.blender import marks
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.core.costs import TABLE, Cost, cost_table
from pcc_addon.core.decisions import Effect
from pcc_addon.core.probe import Engine
from sample_blends import glass, moving, scenes, two_rooms
from sample_blends.build import FOLDER, SAMPLES

ROUNDS = 5
PIXEL_SAMPLES = {Engine.CYCLES: 32, Engine.EEVEE: 8}
MEASURABLE = 0.05  # of a frame: what shading takes less than that drowns in the noise of whole frames
UNMEASURED = "–"
PAGE = ROOT / "docs" / "effects.md"


def main() -> None:
    start()
    part, *rooms = sys.argv[1:] or ["all"]
    keys = {effect.key for effect in Effect}
    if part in {"all", "effects", "bakes"} | keys:
        anew = part in {"all", "effects"}
        costs = {} if anew else dict(cost_table().costs)
        costs |= {case.effect.key: measure(case) for case in CASES if anew or case.effect.key == part}
        some = {case.effect.key for case in BAKES} & ({part} if part in keys else keys)
        costs |= {case.effect.key: measure_bake(case) for case in BAKES if case.effect.key in some}
        where = f"{_processor()}, {os.cpu_count()} cores, Blender {bpy.app.version_string}, {date.today().isoformat()}"
        document = {"where": where, "effects": {key: asdict(cost) for key, cost in costs.items()}}
        TABLE.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
        cost_table.cache_clear()
        write_between(
            PAGE, "effects: written by benchmarks/effects.py", f"Measured on {where}.\n\n{_of_effects(costs)}"
        )
    if part in {"all", "samples"}:
        write_between(PAGE, "samples: written by benchmarks/effects.py", _of_samples(rooms))


def alternate(scene: bpy.types.Scene, engine: Engine, states: Sequence[Callable[[], None]]) -> list[float]:
    """The median seconds of a frame in each state; a first round of each warms up."""
    seconds: list[list[float]] = [[] for _ in states]
    for turn in range(ROUNDS + 1):
        for k in [(turn + k) % len(states) for k in range(len(states))]:
            states[k]()
            seconds[k].append(render(scene, engine, PIXEL_SAMPLES[engine]).seconds)
    return [median(each[1:]) for each in seconds]


def measure(case: Case) -> Cost:
    """What an effect costs in shaders."""
    scene, glossy, _ = build(case)
    bpy.ops.pcc.bake(scope="ALL")

    def show(on: bool) -> Callable[[], None]:
        def act() -> None:
            switch(case, on)
            bpy.ops.pcc.inject()

        return act

    counts = []
    for on in (True, False):
        show(on)()
        counts.append(count_nodes(glossy))
    ratios = {}
    for engine in Engine:
        with_it, without = alternate(scene, engine, [show(True), show(False)])
        ratios[engine] = round(with_it / without, 3)
    print(case.effect.key, counts, ratios, file=sys.stderr)
    return Cost(counts[0] - counts[1], ratios[Engine.CYCLES], ratios[Engine.EEVEE])


def count_nodes(material: bpy.types.Material) -> int:
    """How many nodes feed the material's output, groups counted as often as they are used."""
    tree = material.node_tree
    return _upstream(tree, [tree.get_output_node("CYCLES").inputs["Surface"]])


def _upstream(tree: bpy.types.NodeTree, sockets: Sequence[bpy.types.NodeSocket]) -> int:
    seen, waiting, total = set(), list(sockets), 0
    wanted: dict[bpy.types.Node, set[int]] = {}
    while waiting:
        for link in waiting.pop().links:
            node = link.from_node
            wanted.setdefault(node, set()).add(list(node.outputs).index(link.from_socket))
            if node not in seen:
                seen.add(node)
                waiting += list(node.inputs)
    for node in seen:
        inner = getattr(node, "node_tree", None)
        if inner is None:
            total += 1
            continue
        end = next(n for n in inner.nodes if n.bl_idname == "NodeGroupOutput")
        total += _upstream(inner, [end.inputs[k] for k in sorted(wanted[node])])
    return total


@dataclass(frozen=True)
class Baked:
    """Seconds of a bake of all probes, and the megabytes of their pictures."""

    seconds: float
    megabytes: float


def bake() -> Baked:
    """Bake all probes into a new folder."""
    scene = bpy.context.scene
    with tempfile.TemporaryDirectory() as folder:
        job = BakeJob(scene, bpy.context.view_layer, all_probes(scene), Path(folder))
        results = job.run()
        assert all(result.error is None for result in results), results
        size = sum(path.stat().st_size for path in Path(folder).glob("*.exr"))
        for probe in all_probes(scene):
            for level in probe.pcc_probe.levels:
                level.image.pack()
    return Baked(sum(result.seconds for result in results), size / 1e6)


def measure_bake(case: Case) -> Cost:
    """What an effect costs that bakes have."""
    build(case)
    probe = next(o for o in bpy.data.objects if o.pcc_probe.is_probe)
    probe.pcc_probe.resolution, probe.pcc_probe.samples = 256, 16
    bakes: dict[bool, list[Baked]] = {True: [], False: []}
    for _ in range(5):
        for on in (True, False):
            switch(case, on)
            bakes[on].append(bake())
    seconds = [median(b.seconds for b in bakes[on]) for on in (True, False)]
    sizes = [bakes[on][-1].megabytes for on in (True, False)]
    cost = Cost(None, None, None, *(round(a / b, 3) for a, b in (seconds, sizes)))
    print(case.effect.key, cost, file=sys.stderr)
    return cost


def _of_effects(costs: dict[str, Cost]) -> str:
    rows = []
    for effect in Effect:
        cost = costs.get(effect.key)
        if cost is not None:
            ratios = [cost.cycles, cost.eevee, cost.bake, cost.megabytes]
            cells = ["" if ratio is None else f"{ratio:.2f}" for ratio in ratios]
            rows.append([effect.label, effect.meaning, "" if cost.nodes is None else f"{cost.nodes:+}", *cells])
    return table(["effect", "what it does", "nodes", "Cycles", "EEVEE", "bake", "MB"], rows)


def _of_samples(rooms: Sequence[str]) -> str:
    rows = []
    for name, open_it in _samples(rooms).items():
        open_it()
        rows.append([name, *measure_sample()])
        print(rows[-1], file=sys.stderr)
    columns = zip(*(row[1:] for row in rows), strict=True)
    numbers = [[float(cell) for cell in column if cell != UNMEASURED] for column in columns]
    rows.append(["**median**", *(f"**{median(column):.2f}**" if column else UNMEASURED for column in numbers)])
    return table(["scene", "Cycles frame", "Cycles shading", "EEVEE frame", "EEVEE shading", "bake", "MB"], rows)


def _samples(rooms: Sequence[str]) -> dict[str, Callable[[], object]]:
    found: dict[str, Callable[[], object]] = {
        "emissive room": SAMPLES["emissive_room.blend"],
        "gallery": scenes.gallery,
        "any cubemap": partial(open_room, FOLDER / "any_cubemap.blend"),  # its picture is found from there
        "glass": glass.glass,
        "moving": moving.moving,
        "two rooms": two_rooms.two_rooms,
        "two rooms of metal": two_rooms.of_metal,
    }
    return found | {Path(room).stem.replace("_", " "): partial(open_room, Path(room)) for room in rooms}


def measure_sample() -> list[str]:
    """Of the open scene: what is needed ÷ everything on, by frame and shading in each engine, bake and megabytes."""
    scene = bpy.context.scene
    largest = max(scene.render.resolution_x, scene.render.resolution_y)
    scene.render.resolution_percentage = max(1, round(100 * 240 / largest))
    for probe in all_probes(scene):
        probe.pcc_probe.resolution, probe.pcc_probe.samples = 128, 8
    bakes = []
    for everything in (False, True):
        force(everything)
        bakes.append(min((bake() for _ in range(3)), key=lambda each: each.seconds))

    def show(everything: bool, flat: bool = False) -> Callable[[], None]:
        def act() -> None:
            bpy.ops.pcc.remove()
            force(everything)
            bpy.ops.pcc.inject()
            if flat:
                flatten()

        return act

    cells = []
    for engine in Engine:
        pruned, full, flat = alternate(scene, engine, [show(False), show(True), show(False, flat=True)])
        shading = f"{(pruned - flat) / (full - flat):.2f}" if full - flat > MEASURABLE * full else UNMEASURED
        cells += [f"{pruned / full:.2f}", shading]
    pruned_bake, full_bake = bakes
    ratios = (pruned_bake.seconds / full_bake.seconds, pruned_bake.megabytes / full_bake.megabytes)
    return [*cells, *(f"{ratio:.2f}" for ratio in ratios)]


def force(everything: bool) -> None:
    """Force all effects on that change no picture, for all probes and materials, or leave them to the plan."""
    for settings in (
        *(o.pcc_probe.effects for o in all_probes(bpy.context.scene)),
        *(m.pcc.effects for m in bpy.data.materials),
    ):
        for effect in Effect:
            if effect.lossless and hasattr(settings, effect.key):
                setattr(settings, effect.key, "ON" if everything else "AUTO")


def flatten() -> None:
    """Let materials emit one grey in place of their reflections."""
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else ():
            if marks.role(node) == "glow" and node.bl_idname == "ShaderNodeEmission":
                for link in list(node.inputs["Color"].links):
                    material.node_tree.links.remove(link)
                node.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.is_file() else []
    models = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


if __name__ == "__main__":
    main()
