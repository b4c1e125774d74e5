"""What parallax correction costs per frame: medians of alternating renders in one process, as ratios.

python3 dev.py run benchmarks/shading_cost.py
"""

from __future__ import annotations

from statistics import median

import bpy

from benchmarks.measure import render, start, table, write_page
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room, gallery

ROUNDS = 15


def main() -> None:
    start()
    rows = [measure("emissive room, mirror floor", _emissive()), measure("gallery, polished floor", _gallery())]
    text = (
        f"Medians of {ROUNDS} alternating Cycles renders in one process, divided by each other; shading alone, "
        "baking not counted. The emissive room is the extreme: a frame in which nothing else is computed.\n\n"
        + table(["scene", "box ÷ classic lookup", "box ÷ path-traced", "seconds, path-traced"], rows)
    )
    write_page("shading_cost.md", "What a reflection costs", "python3 dev.py run benchmarks/shading_cost.py", text)


def measure(name: str, scene: bpy.types.Scene) -> list[str]:
    """A row: the scene's name, both ratios, and the path-traced seconds for scale."""
    probe = next(o for o in scene.objects if o.pcc_probe.is_probe)
    probe.pcc_probe.resolution, probe.pcc_probe.samples = 256, 8
    bpy.ops.pcc.bake(scope="ALL")
    kinds = ("BOX", "NONE", "PATH")
    seconds: dict[str, list[float]] = {kind: [] for kind in kinds}
    for turn in range(ROUNDS + 1):
        for kind in kinds[turn % 3 :] + kinds[: turn % 3]:  # none always follows the same other
            bpy.ops.pcc.remove()
            if kind != "PATH":
                probe.pcc_probe.correction = kind
                bpy.ops.pcc.inject()
            seconds[kind].append(render(scene, samples=32).seconds)
    box, classic, path = (median(seconds[kind][1:]) for kind in kinds)  # the first round warms up
    return [name, f"{box / classic:.3f}", f"{box / path:.3f}", f"{path:.2f}"]


def _emissive() -> bpy.types.Scene:
    scene = emissive_room()
    add_room_probe(EMISSIVE_ROOM)
    return scene


def _gallery() -> bpy.types.Scene:
    scene = gallery()
    scene.render.resolution_x, scene.render.resolution_y = 480, 270
    return scene


if __name__ == "__main__":
    main()
