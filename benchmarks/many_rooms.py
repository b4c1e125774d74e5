"""Processor seconds a probe for everything that goes over all probes of a file, with 10 to 300 rooms of own materials.

python3 dev.py run benchmarks/many_rooms.py
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy

from benchmarks.measure import start, table, write_page
from pcc_addon.blender.read.scene import read_scene
from pcc_addon.blender.status import statuses
from pcc_addon.core.plan import make_plan
from sample_blends.scenes import Room, add_wall, empty_scene, principled

COUNTS = (10, 30, 100, 300)
RESOLUTION, SAMPLES = 16, 1
EMPTIES = "as many empties, by Blender"
_COLORS = {"+X": (1.0, 0.3, 0.2), "-X": (0.2, 0.8, 0.9), "+Y": (0.3, 0.9, 0.3), "-Y": (0.9, 0.4, 0.9), "+Z": (1, 1, 1)}


def rooms(count: int) -> list[Room]:
    """Separate box rooms in a square grid."""
    columns = math.ceil(math.sqrt(count))
    return [Room((2.0, 1.5, 1.25), (5.0 * (k % columns), 4.0 * (k // columns), 1.25), 0.0) for k in range(count)]


def build(count: int) -> list[Room]:
    """A new file with rooms of five glowing walls and a polished floor, each with materials of its own."""
    empty_scene()
    found = rooms(count)
    for k, room in enumerate(found):
        for side, color in _COLORS.items():
            add_wall(room, side, _wall(f"{side} {k}", color))
        add_wall(room, "-Z", principled(f"Floor {k}", Roughness=0.1))
    return found


def _wall(name: str, color: tuple) -> bpy.types.Material:
    return principled(
        name, Base_Color=(*color, 1), Specular_IOR_Level=0.0, Emission_Color=(*color, 1), Emission_Strength=0.5
    )


def add_probes(found: list[Room]) -> None:
    for k, room in enumerate(found):
        bpy.ops.pcc.probe_add(name=f"Room {k}", location=room.centre, half_extents=room.half_extents)
        settings = bpy.context.object.pcc_probe
        settings.resolution, settings.samples, settings.denoise = RESOLUTION, SAMPLES, False


def add_empties(count: int) -> None:
    """What Blender itself takes for as many objects."""
    for _ in range(count):
        bpy.ops.object.empty_add()


def remove_empties() -> None:
    bpy.data.batch_remove([o for o in bpy.data.objects if o.type == "EMPTY"])
    bpy.context.view_layer.update()


def seconds(work: Callable[[], object]) -> float:
    """Of the processor, in all threads: other programs on the machine count little."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def measure(count: int) -> dict[str, float]:
    """Seconds of each piece of work over all rooms of a file, in the order in which a user would ask for them."""
    found = build(count)
    scene, layer = bpy.context.scene, bpy.context.view_layer
    with TemporaryDirectory() as folder:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "rooms.blend"))
        empties = seconds(lambda: add_empties(count))
        remove_empties()
        works: dict[str, Callable[[], object]] = {
            "adding": lambda: add_probes(found),
            "planning": lambda: make_plan(read_scene(scene, layer)),
            "baking": lambda: bpy.ops.pcc.bake(scope="ALL"),
            "injecting": lambda: bpy.ops.pcc.inject(),
            "baking again, injected": lambda: bpy.ops.pcc.bake(scope="ALL"),
            "injecting again": lambda: bpy.ops.pcc.inject(),
            "planning, injected": lambda: make_plan(read_scene(scene, layer)),
            "status": lambda: statuses(scene, layer),
        }
        taken = {EMPTIES: empties / count}
        return taken | {name: seconds(work) / count for name, work in works.items()}


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        measure(1)  # what a first run compiles and loads is no part of it
        found = {count: measure(count) for count in COUNTS}
    rows = []
    for name in found[COUNTS[0]]:
        each = [found[count][name] for count in COUNTS]
        ratio = each[COUNTS.index(300)] / each[COUNTS.index(10)]
        rows.append([name, *(f"{value:.4f}" for value in each), f"{ratio:.2f}"])
    over = [found[count]["adding"] / found[count][EMPTIES] for count in COUNTS]
    text = (
        f"Processor seconds a probe. Every room has five wall materials and a polished floor of its own; faces of "
        f"{RESOLUTION} pixels, {SAMPLES} sample; all probes of a file are baked and injected. The last column is 300 "
        f"rooms over 10.\n\n" + table(["", *(f"{count} rooms" for count in COUNTS), "300 / 10"], rows) + "\n\n"
        "Blender itself takes longer for each object the more there are, and so does adding probes: it takes "
        f"{', '.join(f'{ratio:.2f}' for ratio in over)} times as long as adding as many empties with Blender's own "
        "operator."
    )
    write_page("many_rooms.md", "Many rooms", "python3 dev.py run benchmarks/many_rooms.py", text)


if __name__ == "__main__":
    main()
