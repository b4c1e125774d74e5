"""Glass that shows a probe, against the path tracer: a ball, an egg, a pane and a water surface in a marked room.

python3 dev.py run benchmarks/glass.py
"""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from PIL import Image

from benchmarks.measure import ROOT, relative_rmse, start, table, write_page
from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.core.probe import Engine
from sample_blends.glass import FACE, SIZE, THINGS, build

INDICES = (1.0, 1.1, 1.33, 1.5, 2.4)


def measure(thing: str, ior: float, roughness: float, shown: Path | None) -> list[str]:
    """A row of the table; writes the pictures into a folder where there is one."""
    item, scene = build(thing, ior, roughness), bpy.context.scene

    def picture(name: str, samples: int, engine: Engine = Engine.CYCLES) -> np.ndarray:
        path = shown / f"{thing} {name}.png" if shown else None
        return render(scene, RenderSettings(engine, samples), shown=path).pixels

    truth = picture("truth", 256)
    item.hide_render = True
    empty = render(scene, RenderSettings(Engine.CYCLES, 4)).pixels
    item.hide_render = False
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    boxed, eevee = picture("box", 16), picture("eevee", 4, Engine.EEVEE)
    bpy.data.objects["Room"].pcc_probe.correction = "NONE"
    bpy.ops.pcc.inject()
    classic = picture("classic", 16)
    mask = np.maximum(np.abs(truth - empty), np.abs(boxed - empty)).max(-1) > 0.02
    errors = [relative_rmse(found, truth, mask) for found in (classic, boxed, eevee)]
    return [thing, f"{ior:g}", f"{roughness:g}", *(f"{error:.3f}" for error in errors)]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), TemporaryDirectory() as folder:
        shown = Path(folder)
        cases = [(thing, 1.5, 0.0) for thing in THINGS]
        rows = [measure(*case, shown) for case in cases]
        names = [[shown / f"{thing} {kind}.png" for kind in ("truth", "box", "classic")] for thing in THINGS]
        sheet = Image.new("RGB", (SIZE[0] * len(names), SIZE[1] * 3))
        for column, files in enumerate(names):
            for row, file in enumerate(files):
                sheet.paste(Image.open(file), (column * SIZE[0], row * SIZE[1]))
        sheet.save(ROOT / "docs" / "images" / "glass.png")
        others = [(thing, ior, 0.0) for thing in ("ball", "pane", "single surface") for ior in INDICES if ior != 1.5]
        rough = [(thing, 1.5, roughness) for thing in ("ball", "pane") for roughness in (0.2, 0.4)]
        rows += [measure(*case, None) for case in (*others, *rough)]
    head = ["thing", "IOR", "roughness", "classic lookup", "box, Cycles", "box, EEVEE"]
    text = (
        "![Path traced, through the box, and uncorrected](images/glass.png)\n\n"
        f"*Above: path traced; middle: the probe through its box ({FACE} px faces); below: without correction.*"
        "\n\nRelative RMSE over the pixels that show the glass. A ball, an egg and a cube are looked through as an "
        "ellipsoid of their size, with the refraction at both sides; a pane straight on; a single surface, such as "
        "water's, bends once. What is mirrored inside, which makes most of a cube's picture, is not traced.\n\n"
        + table(head, rows)
    )
    write_page("glass.md", "Glass", "python3 dev.py run benchmarks/glass.py", text)


if __name__ == "__main__":
    main()
