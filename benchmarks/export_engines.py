"""How near engines come with an export: the emissive room's mirror floor, against path tracing and Cycles' own lookup.

python3 dev.py run benchmarks/export_engines.py [SIZE …]

Engines that are not here are left out, and the page says which: three.js, Babylon.js and PlayCanvas need npm and
Chromium, Godot needs itself and a screen (PCC_GODOT="xvfb-run -a godot").
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import pytest

from benchmarks.measure import ROOT, covered, relative_rmse, render, start, table, write_between
from pcc_addon.blender.export import ExportJob
from pcc_addon.core.accuracy.png import write_png
from pcc_addon.core.export.targets import TARGETS, target_of
from sample_blends.scenes import EMISSIVE_COLORS, EMISSIVE_ROOM, add_room_probe, emissive_room
from tests.engines import views
from tests.engines.shown import ENGINES
from tests.engines.views import Quad

SIZES = (128, 256, 512)
_OVERSAMPLING = 4
_SHOWN = 256  # of the picture in the docs


def main() -> None:
    start()
    sizes = tuple(int(size) for size in sys.argv[1:]) or SIZES
    scene = emissive_room()
    scene.cycles.pixel_filter_type = "BOX"  # as engines' pictures are averaged here
    floor = covered(scene, bpy.data.objects["Wall -Z"])
    truth = render(scene).pixels
    probe = add_room_probe(EMISSIVE_ROOM, (0.0, 0.0, -0.35))
    probe.pcc_probe.samples, probe.pcc_probe.denoise = 16, False
    rows, missing, shown = [], {}, [truth]
    for size in sizes:
        probe.pcc_probe.resolution = size
        bpy.ops.pcc.bake(scope="ALL")
        bpy.ops.pcc.inject()
        lookup = render(scene).pixels
        bpy.ops.pcc.remove()
        own = relative_rmse(lookup, truth, floor)
        pictures = {key: found for key in ENGINES if (found := _picture(key, scene, probe, missing)) is not None}
        errors = {key: relative_rmse(picture, truth, floor) for key, picture in pictures.items()}
        cells = [f"{errors[key]:.4f}" if key in errors else "—" for key in ENGINES]
        worst = f"{max(errors.values()) / own:.2f}" if errors else "—"
        rows.append([size, f"{own:.4f}", *cells, worst])
        if size == _SHOWN:
            shown += [lookup, *pictures.values()]
    head = ["face, px", "Cycles' lookup", *(target_of(key).title for key in ENGINES), "worst ÷ Cycles"]
    text = table(head, rows)
    text += "".join(f"\n\n{target_of(key).title} was not run: {why}." for key, why in missing.items())
    write_between(ROOT / "docs" / "export.md", "engines: written by benchmarks/export_engines.py", text)
    write_between(ROOT / "docs" / "export.md", "levels: written by benchmarks/export_engines.py", levels_table())
    if len(shown) == 2 + len(ENGINES):
        write_png(ROOT / "docs" / "images" / "export_engines.png", _tiled(shown))


def levels_table(width: int = 512) -> str:
    """The roughness of each level of each engine's cubemaps."""
    alike: dict[tuple[float, ...], list[str]] = {}
    for target in TARGETS:
        alike.setdefault(target.roughnesses(width), []).append(target.key)
    most = max(map(len, alike))
    rows = [
        [", ".join(keys), *(f"{r:.2f}" for r in rungs), *[""] * (most - len(rungs))] for rungs, keys in alike.items()
    ]
    return table(["level", *range(most)], rows)


def _picture(key: str, scene: bpy.types.Scene, probe: bpy.types.Object, missing: dict[str, str]) -> np.ndarray | None:
    """What an engine shows of the room; None where it is not here, which `missing` is told."""
    target = target_of(key)
    walls = [Quad(f"Wall {side}", "wall", probe.name) for side in EMISSIVE_COLORS]
    quads = [*walls, Quad("Wall -Z", "mirror", probe.name)]
    with tempfile.TemporaryDirectory() as folder:
        job = ExportJob(scene, bpy.context.view_layer, [probe], target, Path(folder))
        job.finish()
        try:
            picture = ENGINES[key](Path(folder), views.scene(target, quads, _OVERSAMPLING))
        except pytest.skip.Exception as reason:
            missing[key] = str(reason)
            return None
    return views.averaged(picture, _OVERSAMPLING).astype(np.float32)


def _tiled(pictures: list[np.ndarray]) -> np.ndarray:
    """Six pictures in two rows, the first row on top, with a white line between them."""
    framed = [np.pad(picture[::-1], ((0, 4), (0, 4), (0, 0)), constant_values=1.0) for picture in pictures]
    rows = [np.concatenate(framed[k : k + 3], 1) for k in (0, 3)]
    return np.concatenate(rows)[:-4, :-4]


if __name__ == "__main__":
    main()
