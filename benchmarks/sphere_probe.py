"""Blender's own sphere probe in EEVEE beside a parallax probe of as many texels, in the same place.

python3 dev.py run benchmarks/sphere_probe.py [ROOM.blend …]

Files are furnished rooms of others, which get a fitted probe where they have none. EEVEE's ray tracing is off, as it
replaces what sphere probes show. Writes a table into docs/accuracy.md.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial
from math import sqrt
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np

from benchmarks.measure import ROOT, open_room, relative_rmse, start, table, write_between
from pcc_addon.blender.accuracy import truth
from pcc_addon.blender.accuracy.bench import Bench
from pcc_addon.blender.accuracy.question import Question, subject_of
from pcc_addon.blender.accuracy.served import served_pixels
from pcc_addon.core.accuracy import labels
from pcc_addon.core.accuracy.records import Kind, Settings
from pcc_addon.core.probe import Engine
from sample_blends import scenes
from sample_blends.build import SAMPLES

PAGE = ROOT / "docs" / "accuracy.md"
SIZES = (128, 512)  # of a sphere probe, which holds n² texels; six faces hold 6 n²
FRAME_SAMPLES, BAKE_SAMPLES, TRUTH_SECONDS, SEED = 8, 64, 60.0, 11


def main() -> None:
    start()
    rooms: dict[str, Callable[[], object]] = {
        "emissive room": SAMPLES["emissive_room.blend"],
        "gallery": scenes.gallery,
    }
    for path in map(Path, sys.argv[1:]):
        rooms[path.stem.replace("_", " ")] = partial(open_room, path, fit=True)
    rows = []
    for name, build in rooms.items():
        build()
        with TemporaryDirectory() as folder:
            for row in _measured(Path(folder)):
                rows.append([name, *row])
                print(*rows[-1], sep=" | ", flush=True)
    head = ["scene", "texels", "sphere probe as it is added", "with a box for its parallax", "box", "relief"]
    write_between(PAGE, "spheres: written by benchmarks/sphere_probe.py", table(head, rows))


def _measured(folder: Path) -> Iterator[list[str]]:
    """A row for each number of texels: it, and the errors of each probe."""
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    subject = subject_of(Question(engine=Engine.EEVEE), scene, view_layer)
    bench = Bench(scene, view_layer, subject.probe, subject.size, subject.frames, folder)
    size, number = subject.size, subject.frames[0]
    _bake(bench, _ours("BOX", 16))
    mask = served_pixels(scene, view_layer, subject.probe, size.width, size.height)
    *_, halves = truth.deepened(bench, number, mask, TRUTH_SECONDS, None, 1000)

    def error(settings: Settings) -> str:
        bench.show(settings)
        found: np.ndarray = bench.frame(settings, number, SEED).pixels
        return labels.error(relative_rmse(found, halves.mean, mask))

    for n in SIZES:
        spheres = [
            error(Settings(Kind.SPHERE, Engine.EEVEE, parallax, n, frame_samples=FRAME_SAMPLES))
            for parallax in ("NONE", "BOX")
        ]
        ours = []
        for correction in ("BOX", "RELIEF"):
            settings = _ours(correction, round(n / sqrt(6.0)))
            _bake(bench, settings)
            ours.append("as the box" if bench.is_needless(settings) else error(settings))
        yield [f"{n * n:,}", *spheres, *ours]


def _ours(correction: str, resolution: int) -> Settings:
    march = {"steps": 12, "refinements": 4} if correction == "RELIEF" else {}
    return Settings(
        Kind.PROBE, Engine.EEVEE, correction, resolution, BAKE_SAMPLES, True, frame_samples=FRAME_SAMPLES, **march
    )


def _bake(bench: Bench, settings: Settings) -> None:
    for _ in bench.bake(settings, SEED):
        pass


if __name__ == "__main__":
    main()
