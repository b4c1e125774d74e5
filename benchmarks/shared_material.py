"""What a frame costs where up to 64 rooms share a material: as copies that show their own rooms, and by place alone.

python3 dev.py run benchmarks/shared_material.py
"""

from __future__ import annotations

import sys
import time
from contextlib import ExitStack, redirect_stdout
from statistics import median
from unittest import mock

import bpy

from benchmarks.many_rooms import rooms
from benchmarks.measure import render, start, table, write_page
from pcc_addon.core import parts, plan
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, add_wall, empty_scene, principled

COUNTS = (1, 64)
BY_PLACE = (2, 10)
ROUNDS = 2
SAMPLES = {Engine.CYCLES: 32, Engine.EEVEE: 2}
_COLORS = {"+X": (1.0, 0.3, 0.2), "-X": (0.2, 0.8, 0.9), "+Y": (0.3, 0.9, 0.3), "-Y": (0.9, 0.4, 0.9), "+Z": (1, 1, 1)}


def build(count: int) -> bpy.types.Scene:
    """A new file with box rooms whose mirror floors share a material, baked; a camera in one."""
    scene = empty_scene()
    found = rooms(count)
    floor = principled("Floor", Metallic=1.0, Roughness=0.0)
    walls = {
        side: principled(f"Wall {side}", Specular_IOR_Level=0.0, Emission_Color=(*color, 1), Emission_Strength=0.5)
        for side, color in _COLORS.items()
    }
    for k, room in enumerate(found):
        for side, material in {**walls, "-Z": floor}.items():
            wall = add_wall(room, side, material)
            wall.visible_camera = side != "+Z"
        bpy.ops.pcc.probe_add(name=f"Room {k}", location=room.centre, half_extents=room.half_extents)
        settings = bpy.context.object.pcc_probe
        settings.resolution, settings.samples, settings.denoise = 64, 1, False
    bpy.ops.pcc.bake(scope="ALL")
    add_camera(found[0].world(-1.8, -1.3, 0.6), found[0].world(1.5, 1.0, -1.2), 18.0, 480, 270)
    return scene


def seconds(scene: bpy.types.Scene, engine: Engine) -> float:
    """Median processor seconds of a frame; the first is left out."""
    taken = []
    for _ in range(ROUNDS + 1):
        begin = time.process_time()
        render(scene, engine, SAMPLES[engine])
        taken.append(time.process_time() - begin)
    return median(taken[1:])


def measure(count: int, *, by_place: bool = False) -> dict[str, float]:
    """Processor seconds of frames by engine, without probes and with them, and the seconds that injecting took."""
    with ExitStack() as stack:
        if by_place:
            stack.enter_context(mock.patch.object(parts, "TOGETHER", count))
            stack.enter_context(mock.patch.object(plan, "SAMPLERS", 3 * count))
        scene = build(count)
        bare = {f"{engine.value.title()}, no probe shown": seconds(scene, engine) for engine in Engine}
        begin = time.perf_counter()
        bpy.ops.pcc.inject()
        found = {"injecting, s": time.perf_counter() - begin} | bare
        for engine in Engine:
            found[f"{engine.value.title()}, in one room"] = seconds(scene, engine)
    return found


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        copies = {count: measure(count) for count in COUNTS}
        together = {count: measure(count, by_place=True) for count in BY_PLACE}
    names = [name for name in copies[1] if name != "injecting, s"]
    rows = [[n, *(f"{copies[count][n]:.2f}" for count in COUNTS), f"{copies[64][n] / copies[1][n]:.2f}"] for n in names]
    for engine in Engine:
        bare, shown = (f"{engine.value.title()}, {what}" for what in ("no probe shown", "in one room"))
        over = {count: copies[count][shown] / copies[count][bare] for count in COUNTS}
        ratios = (*(over[count] for count in COUNTS), over[64] / over[1])
        rows.append([f"{engine.value.title()}, probe over none", *(f"{ratio:.2f}" for ratio in ratios)])
    rows.append(["injecting, s", *(f"{copies[count]['injecting, s']:.2f}" for count in COUNTS), ""])
    inside = [name for name in names if "in one room" in name]
    chained = [[n, *(f"{together[count][n] / copies[1][n]:.2f}" for count in BY_PLACE)] for n in inside]
    text = (
        f"Box rooms with mirror floors of one material, a probe each; processor seconds of a frame of 480×270 pixels "
        f"(median of {ROUNDS}), in which little else is computed. The floors wear copies of the material that show "
        "their own room's probe; the last column is 64 rooms over one. The renderer itself takes longer for 64 rooms: "
        "*probe over none* is what the probes add to that.\n\n"
        + table(["view", *(f"{count} rooms" for count in COUNTS), "64 / 1"], rows)
        + "\n\nThe same rooms where one material shows all probes, each point that of its place, over one room:\n\n"
        + table(["view", *(f"{count} probes" for count in BY_PLACE)], chained)
    )
    command = "python3 dev.py run benchmarks/shared_material.py"
    write_page("shared_material.md", "A material of many rooms", command, text)


if __name__ == "__main__":
    main()
