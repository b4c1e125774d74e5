"""What a render of many small pictures by Cycles takes whatever it shows, and what each picture adds, by objects.

python3 dev.py run benchmarks/renders_together.py

`capture` decides by these how many probes share a render. Writes into docs/many_probes.md.
"""

from __future__ import annotations

import sys
import time
from contextlib import ExitStack, redirect_stdout
from pathlib import Path

import bpy

from benchmarks.many_probes import add_probes
from benchmarks.many_rooms import build
from benchmarks.measure import start, table, write_between
from pcc_addon.blender.bake import capture
from pcc_addon.blender.read.probes import all_probes, probe_spec
from pcc_addon.core.cubemap import FACES
from pcc_addon.core.probe import ProbeSpec

PAGE = Path(__file__).resolve().parents[1] / "docs" / "many_probes.md"
ROOMS, FEW, MANY, ROUNDS = (30, 100, 300, 1000), 1, 24, 3


def seconds(specs: list[ProbeSpec]) -> float:
    """Of the processor, in all threads, for one render of all faces of some probes."""
    with ExitStack() as stack:
        stage = capture.Stage(stack, bpy.context.scene, bpy.context.view_layer, specs)
        stage.aim(stack, specs[0])
        begin = time.process_time()
        stage.face(specs[0], 0)
        return time.process_time() - begin


def measure(rooms: int) -> list[object]:
    """A row: rooms, objects, and microseconds for each object in a render and in each of its views."""
    add_probes(build(rooms))
    scene = bpy.context.scene
    specs = [probe_spec(probe) for probe in all_probes(scene)][:MANY]
    few, many = (min(seconds(specs[:count]) for _ in range(ROUNDS)) for count in (FEW, MANY))
    view = (many - few) / (len(FACES) * (MANY - FEW))
    bpy.context.view_layer.update()  # reading a depsgraph behind the data crashes Blender
    objects = len(bpy.context.view_layer.depsgraph.object_instances)
    render = few - FEW * len(FACES) * view
    return [rooms, objects, f"{1e6 * render / objects:.0f}", f"{1e6 * view / objects:.1f}"]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), ExitStack() as stack:
        stack.callback(setattr, capture, "_VIEWS_TO_REST", capture._VIEWS_TO_REST)
        capture._VIEWS_TO_REST = 10**9
        rows = [measure(rooms) for rooms in ROOMS]
    text = table(["rooms", "objects", "µs an object in a render", "µs an object in each view"], rows)
    write_between(PAGE, "renders: written by benchmarks/renders_together.py", text)


if __name__ == "__main__":
    main()
