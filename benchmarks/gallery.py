"""A picture of each system of docs/systems.md: path-traced, by the probe, and without the system; and its error.

python3 dev.py run benchmarks/gallery.py [NAME …]     with names of strips: only those anew
"""

from __future__ import annotations

import sys
from contextlib import nullcontext, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from benchmarks.gallery_scenes import FACE, LIT_FACE, SAMPLES, probes
from benchmarks.gallery_systems import SYSTEMS, System
from benchmarks.measure import ROOT, masks, relative_rmse, start, table, write_page
from pcc_addon.blender.rendering import RenderSettings, render

WIDTH, HEIGHT = 240, 150
TRUTH_SAMPLES, SHOWN_SAMPLES = 96, 24
COLORS, ROUNDS = 256, 2  # of a strip, and of k-means over them: fewer make steps in soft reflections
IMAGES = ROOT / "docs" / "images" / "gallery"
ERRORS = "Relative errors"  # what a strip's file calls them


def measure(system: System, folder: Path) -> None:
    """Write the strip of a system, with the relative errors of the probe and of the third picture in its file."""
    system.build()
    scene, files = bpy.context.scene, [folder / f"{way}.png" for way in ("traced", "probe", "without")]

    def picture(samples: int, path: Path, denoise: bool = True) -> np.ndarray:
        settings = RenderSettings(samples=samples, denoise=denoise, width=WIDTH, height=HEIGHT)
        return np.minimum(render(scene, settings, shown=path).pixels, 1.0)

    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    face = LIT_FACE if bpy.data.lights else FACE
    for probe in probes():
        if not probe.pcc_probe.bake_record:
            probe.pcc_probe.resolution, probe.pcc_probe.samples = face, SAMPLES
    with system.traced():
        truth = picture(TRUTH_SAMPLES, files[0])
    shown = np.logical_or.reduce(list(masks(scene, {name: name for name in system.compared}).values()))
    few, errors = system.noisy or SHOWN_SAMPLES, []
    for change, holding, path in (
        (system.bake, nullcontext, files[1]),
        (system.without, system.lacked, files[2]),
    ):
        with holding():
            change()
            bpy.ops.pcc.inject()
            errors.append(relative_rmse(picture(few, path, not system.noisy), truth, shown))
    _strip(files, errors, IMAGES / f"{system.name}.png")


def _strip(files: list[Path], errors: list[float], path: Path) -> None:
    sheet = Image.new("RGB", (3 * WIDTH + 8, HEIGHT), "white")
    for k, file in enumerate(files):
        sheet.paste(Image.open(file), (k * (WIDTH + 4), 0))
    path.parent.mkdir(parents=True, exist_ok=True)
    noted = PngInfo()
    noted.add_text(ERRORS, " ".join(f"{error:.3f}" for error in errors))
    sheet.quantize(COLORS, kmeans=ROUNDS, dither=Image.Dither.NONE).save(path, optimize=True, pnginfo=noted)


def _errors(system: System) -> list[str]:
    """What a strip's file says of its errors, so that pictures and figures are of one run."""
    with Image.open(IMAGES / f"{system.name}.png") as strip:
        return str(strip.info[ERRORS]).split()


def main() -> None:
    start()
    with redirect_stdout(sys.stderr):
        for system in SYSTEMS:
            if not sys.argv[1:] or system.name in sys.argv[1:]:
                with TemporaryDirectory() as folder:
                    measure(system, Path(folder))
                print(system.name, *_errors(system), flush=True)
    rows = [[f"[{s.title}](#{s.name.replace('_', '-')})", *_errors(s), s.lacking] for s in SYSTEMS]
    sections = [
        f'<a id="{s.name.replace("_", "-")}"></a>\n\n## {s.title[0].upper()}{s.title[1:]}\n\n'
        f"{s.words} ([sample](../sample_blends/{s.sample}))\n\n"
        f"![Path-traced, the probe, {s.lacking}](images/gallery/{s.name}.png)"
        for s in SYSTEMS
    ]
    text = (
        "From left to right: path-traced, the probe, and what the last column of the table says. "
        f"By Cycles, denoised, {TRUTH_SAMPLES} path-traced samples and {SHOWN_SAMPLES} of the others, unless it says "
        f"otherwise; faces of {FACE} pixels ({LIT_FACE} in rooms with lamps) and {SAMPLES} samples, or what the scene "
        "asks for.\n\n"
        "Relative RMSE over the pixels of the objects that show the probe, against the path-traced picture; radiances "
        "above 1 count as 1.\n\n"
        + table(["system", "probe", "third picture", "what that is"], rows)
        + "\n\n"
        + "\n\n".join(sections)
    )
    write_page("gallery.md", "The systems in pictures", "python3 dev.py run benchmarks/gallery.py", text)


if __name__ == "__main__":
    main()
