"""What makes a bake stale and what does not, as the tests have it, and how long the question takes.

python3 dev.py run benchmarks/staleness.py
"""

from __future__ import annotations

import math
import sys
import time
from contextlib import redirect_stdout

import bpy
import numpy as np

from benchmarks.measure import start, table, write_page
from pcc_addon.blender.status import statuses
from sample_blends.scenes import empty_scene, principled
from tests.blender.helpers import pretend_bake, small_probe
from tests.blender.stale.all import ROWS, Row

TRIANGLES, PROBES = (50_000, 500_000, 5_000_000), (1, 8, 64)
OBJECTS = 100
RUNS = 5


def build(triangles: int, probes: int) -> int:
    """A new file with objects that have meshes and materials of their own, and probes; returns how many triangles."""
    scene = empty_scene()
    side = math.isqrt(triangles // (2 * OBJECTS))
    mesh = _grid(side)
    for k in range(OBJECTS):
        own = mesh.copy()
        own.materials.append(principled(f"Material {k}", Roughness=k / OBJECTS))
        item = bpy.data.objects.new(f"Object {k}", own)
        item.location = (k % 10, k // 10, 0.0)
        scene.collection.objects.link(item)
    for k in range(probes):
        probe = small_probe(f"Probe {k:02}")
        pretend_bake(probe)
        probe.pcc_probe.hidden_objects.add().object = bpy.data.objects[f"Object {k}"]
    bpy.context.view_layer.update()
    return sum(len(item.data.polygons) for item in scene.objects if item.type == "MESH")


def _grid(side: int) -> bpy.types.Mesh:
    """2·side² triangles with UVs."""
    mesh = bpy.data.meshes.new("Grid")
    x, y = np.meshgrid(np.arange(side + 1) / side, np.arange(side + 1) / side)
    corners = np.stack([x.ravel(), y.ravel(), np.sin(7.0 * x.ravel())], 1)
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.concatenate([first[:, None] + [0, 1, side + 2], first[:, None] + [0, side + 2, side + 1]])
    mesh.from_pydata(corners, [], faces)
    uv = mesh.uv_layers.new(name="UV")
    uv.uv.foreach_set("vector", corners[faces.ravel(), :2].astype(np.float32).ravel())
    return mesh


def seconds() -> tuple[float, float]:
    """Of the processor, for asking how the probes stand: the first time in a file, and the least of those after it."""
    taken = []
    for _ in range(1 + RUNS):
        begin = time.process_time()
        statuses(bpy.context.scene, bpy.context.view_layer)
        taken.append(time.process_time() - begin)
    return taken[0], min(taken[1:])


def listed(rows: list[Row]) -> str:
    """The rows of the tests by subject."""
    subjects = list(dict.fromkeys(row.subject for row in rows))
    lines = []
    for subject in subjects:
        names = [row.name + " (EEVEE)" * (row.engine.value == "EEVEE") for row in rows if row.subject == subject]
        lines.append([subject, "; ".join(names)])
    return table(["of", "changes"], lines)


def main() -> None:
    start()
    rows = []
    with redirect_stdout(sys.stderr):
        for triangles in TRIANGLES:
            line: list[object] = []
            for probes in PROBES:
                count = build(triangles, probes)
                first, again = seconds()
                line.append(f"{first:.2f}, {again:.2f}")
            rows.append([f"{count:,}", *line])
    text = (
        f"Processor seconds that `status` takes, in one thread, in an open file of {OBJECTS} objects, each with a mesh "
        "and a material of its own, by triangles and probes, each of which hides another object: the first "
        f"time, and the least of {RUNS} more. Nothing but what image files hold is kept between two.\n\n"
        + table(["triangles", *(f"{probes} probe{'s' * (probes > 1)}" for probes in PROBES)], rows)
        + "\n\nWhat follows are the rows of `tests/blender/test_stale_rows.py`, by Cycles unless it says otherwise.\n\n"
        "## A bake is stale after\n\n"
        + listed([row for row in ROWS if row.counts])
        + "\n\n## It is not after\n\n"
        + listed([row for row in ROWS if not row.counts])
    )
    write_page("staleness.md", "When a bake is stale", "python3 dev.py run benchmarks/staleness.py", text)


if __name__ == "__main__":
    main()
