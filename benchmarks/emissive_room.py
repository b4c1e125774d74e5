"""How near the floor's reflection comes to the truth, by face size, in a room where the truth has no noise.

python3 dev.py run benchmarks/emissive_room.py
"""

from __future__ import annotations

import bpy

from benchmarks.measure import covered, relative_rmse, render, start, table, write_page
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room

SIZES = (128, 256, 512, 1024)


def main() -> None:
    start()
    scene = emissive_room()
    room = EMISSIVE_ROOM
    floor = bpy.data.objects["Wall -Z"]
    mask, truth = covered(scene, floor), render(scene).pixels
    probe = add_room_probe(room, (0.0, 0.0, -0.35)).pcc_probe
    probe.samples, probe.denoise = 16, False
    rows = []
    for size in SIZES:
        probe.resolution = size
        bpy.ops.pcc.bake(scope="ALL")
        bpy.ops.pcc.inject()
        boxed = {engine: relative_rmse(render(scene, engine).pixels, truth, mask) for engine in Engine}
        probe.correction = "NONE"
        classic = relative_rmse(render(scene).pixels, truth, mask)
        probe.correction = "BOX"
        rows.append([size, f"{classic:.3f}", f"{boxed[Engine.CYCLES]:.4f}", f"{boxed[Engine.EEVEE]:.4f}"])
    half = " × ".join(f"{2 * h:g}" for h in room.half_extents)
    text = (
        f"A room of {half} m, turned 30° about z, its centre at {room.centre} m, glowing checkered walls, a mirror for "
        "a floor; captured 0.35 m below the centre by Cycles, 16 samples, no denoising. Relative RMSE over the "
        "floor's pixels against the path-traced picture (64 samples each):\n\n"
        + table(["face, px", "classic lookup", "box, shown by Cycles", "box, shown by EEVEE"], rows)
    )
    write_page("emissive_room.md", "Error in the emissive room", "python3 dev.py run benchmarks/emissive_room.py", text)


if __name__ == "__main__":
    main()
