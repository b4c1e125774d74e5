"""Bakes of 1 to 1,000 probes: processor seconds a probe, memory, and what 1,000 probes take to be asked about.

python3 dev.py run benchmarks/many_probes.py
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy

from benchmarks.many_rooms import RESOLUTION, SAMPLES, build
from benchmarks.measure import start, table, write_between
from pcc_addon.blender.bake.going_on import Going
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.probes import add_probe
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.status import stale_probes, statuses
from pcc_addon.blender.store.levels import bake_folder
from sample_blends.scenes import Room

PAGE = Path(__file__).resolve().parents[1] / "docs" / "many_probes.md"
REPEATS = {1: 7, 10: 5, 100: 2, 1000: 1}


def add_probes(rooms: list[Room]) -> None:
    """A probe in each room; Blender's own operator would go over all objects for each."""
    for k, room in enumerate(rooms):
        collection = bpy.context.scene.collection
        probe = add_probe(collection, f"Room {k}", room.centre, (0.0, 0.0, 0.0), room.half_extents, (0.0, 0.0, 0.0))
        settings = probe.pcc_probe
        settings.resolution, settings.samples, settings.denoise = RESOLUTION, SAMPLES, False
    bpy.context.view_layer.update()


def seconds(work: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Of the processor, in all threads, or by another clock."""
    begin = clock()
    work()
    return clock() - begin


def bake_all() -> None:
    scene = bpy.context.scene
    job = BakeJob(
        scene, bpy.context.view_layer, all_probes(scene), bake_folder(scene), going=Going()
    )  # as the shell does
    results = job.run()
    failed = [result.error for result in results if result.error]
    if failed:
        raise RuntimeError(failed[0])


def resident() -> float:
    """Megabytes that this process holds now; 0 where the system does not tell as Linux does."""
    status = Path("/proc/self/status")
    lines = status.read_text().splitlines() if status.exists() else []
    return next((int(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmRSS")), 0.0)


def measure(count: int) -> tuple[float, float]:
    """Processor seconds a probe of a bake of all, the median of some, and the megabytes that it leaves held."""
    add_probes(build(count))
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(bpy.app.tempdir) / f"rooms{count}.blend"))
    before = resident()
    taken = statistics.median(seconds(bake_all) for _ in range(REPEATS[count]))
    return taken / count, resident() - before


def asked() -> list[list[str]]:
    """What it takes to ask about all probes of the open file, in seconds, before and after an injection."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    works: dict[str, Callable[[], object]] = {
        "plan": lambda: plan_scene(scene, layer),
        "status": lambda: statuses(scene, layer),
        "bake of what is stale, which is nothing": lambda: stale_probes(scene, layer, all_probes(scene)),
    }
    baked = {name: seconds(work, time.perf_counter) for name, work in works.items()}
    bpy.ops.pcc.inject()
    injected = {name: seconds(work, time.perf_counter) for name, work in works.items()}
    return [[name, f"{baked[name]:.1f}", f"{injected[name]:.1f}"] for name in works]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), TemporaryDirectory() as folder:
        bpy.context.preferences.filepaths.temporary_directory = folder
        measure(1)  # what a first run compiles and loads is no part of it
        found = {count: measure(count) for count in REPEATS}
        questions = asked()
    base = found[10][0]
    rows = [[count, f"{each:.4f}", f"{each / base:.2f}", f"{held:.0f}"] for count, (each, held) in found.items()]
    text = (
        table(["probes", "seconds a probe", "÷ that of 10", "MB more held afterwards"], rows)
        + "\n\n"
        + table([f"{max(REPEATS)} probes", "seconds, baked", "seconds, injected"], questions)
    )
    write_between(PAGE, "figures: written by benchmarks/many_probes.py", text)


if __name__ == "__main__":
    main()
