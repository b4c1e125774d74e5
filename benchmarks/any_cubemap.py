"""How near a probe with a given picture comes to a room that is painted with it, and with the world's to the sky.

python3 dev.py run benchmarks/any_cubemap.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

from benchmarks.measure import ROOT, relative_rmse, render, start, table, write_between
from pcc_addon.core.probe import Engine
from sample_blends import ways
from sample_blends.any_cubemap import chequered_sky, mirror_ball, paint_walls, write_cross
from sample_blends.scenes import emissive

SOURCE = 256  # pixels across a face of the picture
SIZES = (64, 128, 256)
SAMPLES = {Engine.CYCLES: 64, Engine.EEVEE: 16}
TILTED = Euler((0.3, -0.2, 0.0))
PAGE = ROOT / "docs" / "any_cubemap.md"


def main() -> None:
    start()
    with tempfile.TemporaryDirectory() as folder:
        rows = [*_painted("turned", None, Path(folder)), *_painted("tilted", TILTED, Path(folder)), *_sky()]
    head = ["picture", "box", "face, px", "classic lookup", "box, Cycles", "box, EEVEE"]
    write_between(PAGE, "figures: written by benchmarks/any_cubemap.py", table(head, rows))


def _painted(words: str, tilt: Euler | None, folder: Path) -> list[list[object]]:
    scene = mirror_ball(tilt=tilt)
    probe = bpy.data.objects["Room"]
    ball = _pixels_of_ball(scene)
    paint_walls(probe.matrix_world, SOURCE)
    truth = render(scene).pixels
    traced = _large(scene, "Painted walls, path-traced", folder / "traced.png")
    for wall in [item for item in bpy.data.objects if item.name.startswith("Wall ")]:
        bpy.data.objects.remove(wall)
    write_cross(folder / "cross.png", SOURCE)
    probe.pcc_probe.source, probe.pcc_probe.picture = "IMAGE", str(folder / "cross.png")
    rows = []
    for size in SIZES:
        classic, boxed = (_shown(scene, size, correction, truth, ball) for correction in ("NONE", "BOX"))
        errors = f"{classic[Engine.CYCLES]:.3f}", *(f"{boxed[engine]:.4f}" for engine in Engine)
        rows.append([f"cross of {SOURCE} px a face", words, size, *errors])
    if tilt is None:
        boxed = _large(scene, "No walls, a probe with the picture", folder / "boxed.png")
        ways.side_by_side([boxed, traced], ROOT / "docs" / "images" / "any_cubemap.png")
    return rows


def _large(scene: bpy.types.Scene, label: str, path: Path) -> ways.Rendered:
    scene.render.resolution_percentage = 200
    rendered = ways.render(scene, label, path)
    scene.render.resolution_percentage = 100
    return rendered


def _sky() -> list[list[object]]:
    """Far away things want no correction; the turned box must not turn them."""
    scene = mirror_ball(tilt=TILTED)
    ball = _pixels_of_ball(scene)
    chequered_sky(scene)
    truth = render(scene).pixels
    bpy.data.objects["Room"].pcc_probe.source = "WORLD"
    bpy.data.objects["Room"].pcc_probe.samples = 16
    rows = []
    for size in SIZES:
        found = _shown(scene, size, "NONE", truth, ball)
        rows.append(["the world", "tilted", size, " / ".join(f"{found[engine]:.4f}" for engine in Engine), "–", "–"])
    return rows


def _shown(
    scene: bpy.types.Scene, size: int, correction: str, truth: np.ndarray, mask: np.ndarray
) -> dict[Engine, float]:
    """The errors of a bake of this size, by the engine that shows it."""
    probe = bpy.data.objects["Room"].pcc_probe
    probe.resolution, probe.correction = size, correction
    bpy.ops.pcc.bake(scope="STALE")
    bpy.ops.pcc.inject()
    return {
        engine: relative_rmse(render(scene, engine, samples).pixels, truth, mask) for engine, samples in SAMPLES.items()
    }


def _pixels_of_ball(scene: bpy.types.Scene) -> np.ndarray:
    """(h, w): where nothing but the ball is seen, of a scene with nothing else in it."""
    slots = bpy.data.objects["Ball"].data.materials
    mirror, slots[0] = slots[0], emissive("White")[0]
    mask = render(scene).pixels.min(-1) > 0.9999
    slots[0] = mirror
    return mask


if __name__ == "__main__":
    main()
