"""Seconds a probe for everything that goes over all probes of a file, with 10 to 300 rooms of own materials.

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
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.read.scene import read_scene
from pcc_addon.blender.status import statuses
from pcc_addon.core.plan import make_plan
from sample_blends.scenes import Room, add_wall, empty_scene, principled

COUNTS = (10, 30, 100, 300)
MOST = 60  # probes of a file that are baked and injected
RESOLUTION, SAMPLES = 16, 1
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
    """What Blender itself takes for as many objects; they are removed again."""
    for _ in range(count):
        bpy.ops.object.empty_add()
    for item in [o for o in bpy.data.objects if o.type == "EMPTY" and not o.pcc_probe.is_probe]:
        bpy.data.objects.remove(item)


def select_first(count: int) -> None:
    """Select as many probes, and the objects of their rooms."""
    probes = all_probes(bpy.context.scene)
    chosen = {probe.name for probe in sorted(probes, key=lambda probe: int(probe.name.split()[-1]))[:count]}
    for item in bpy.context.scene.objects:
        room = item.name if item.pcc_probe.is_probe else f"Room {_room_of(item)}"
        item.select_set(room in chosen)


def _room_of(item: bpy.types.Object) -> str:
    return item.material_slots[0].material.name.split()[-1]


def seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def measure(count: int) -> dict[str, float]:
    """Seconds of each piece of work over all rooms of a file, in the order in which a user would ask for them."""
    found = build(count)
    scene, layer, some = bpy.context.scene, bpy.context.view_layer, min(count, MOST)
    with TemporaryDirectory() as folder:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "rooms.blend"))
        taken = {
            "adding": seconds(lambda: add_probes(found)) / count,
            "as many empties, by Blender": seconds(lambda: add_empties(some)) / some,
            "planning": seconds(lambda: make_plan(read_scene(scene, layer))) / count,
        }
        select_first(some)
        return taken | {
            "baking": seconds(lambda: bpy.ops.pcc.bake(scope="SELECTED")) / some,
            "injecting": seconds(lambda: bpy.ops.pcc.inject(scope="SELECTED")) / some,
            "baking again, injected": seconds(lambda: bpy.ops.pcc.bake(scope="SELECTED")) / some,
            "injecting again": seconds(lambda: bpy.ops.pcc.inject(scope="SELECTED")) / some,
            "planning, injected": seconds(lambda: make_plan(read_scene(scene, layer))) / count,
            "status": seconds(lambda: statuses(scene, layer)) / count,
        }


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
    text = (
        f"Seconds a probe. Every room has five wall materials and a polished floor of its own; faces of {RESOLUTION} "
        f"pixels, {SAMPLES} sample. At most {MOST} probes of a "
        f"file are baked and injected; the others are there. The last column is 300 rooms over 10.\n\n"
        + table(["", *(f"{count} rooms" for count in COUNTS), "300 / 10"], rows)
    )
    write_page("many_rooms.md", "Many rooms", "python3 dev.py run benchmarks/many_rooms.py", text)


if __name__ == "__main__":
    main()
