"""docs/images/picture_layouts.png: each layout where it is worst."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from benchmarks.measure import ROOT
from benchmarks.picture_layouts.all_directions import LayoutResult, directions_seen
from benchmarks.picture_layouts.layouts import SEAM_REACH
from benchmarks.picture_layouts.radiances import smooth
from pcc_addon.core.probe import Engine

FIGURE = ROOT / "docs" / "images" / "picture_layouts.png"
REACH = 16  # pixels from a crop's centre to its edges
ZOOM = 6
MARGIN, HEAD = 8, 40  # pixels of the sheet
NAMES = {Engine.CYCLES: "Cycles", Engine.EEVEE: "EEVEE"}


def draw(results: Sequence[LayoutResult]) -> None:
    """Crops around the worst pixel at each kind of seam: engines in rows, seams in columns."""
    shown = {(r.layout, r.engine): r.accuracy.shown for r in results}
    columns = [(r.layout, seam) for r in results if r.engine is Engine.CYCLES for seam in r.accuracy.seams]
    side = 2 * REACH * ZOOM
    sheet = Image.new("RGB", (MARGIN + len(columns) * (side + MARGIN), HEAD + 2 * (side + HEAD)), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    directions = directions_seen()
    truth = smooth(directions)
    for c, (layout, seam) in enumerate(columns):
        error = np.maximum.reduce([np.abs(shown[layout, engine] - truth).max(-1) for engine in Engine])
        row, column = _centre_of_crop(np.where(layout.seams(directions)[seam] <= SEAM_REACH, error, 0.0))
        x = MARGIN + c * (side + MARGIN)
        pen.text((x, 4), _plain(layout.label.replace(", ", ",\n  ")), "black", font)
        for r, engine in enumerate(Engine):
            crop = shown[layout, engine][row - REACH : row + REACH, column - REACH : column + REACH][::-1] / 1.5
            tile = Image.fromarray((255 * np.clip(crop, 0.0, 1.0) ** (1 / 2.2)).astype(np.uint8))
            y = HEAD + r * (side + HEAD)
            sheet.paste(tile.resize((side, side), Image.Resampling.NEAREST), (x, y))
            pen.text((x, y + side + 4), _plain(f"{NAMES[engine]}: {seam}"), "black", font)
    sheet.save(FIGURE, optimize=True)


def _centre_of_crop(error: np.ndarray) -> tuple[int, int]:
    """Row and column of the largest error, or the nearest pixel that is REACH away from the picture's edges."""
    worst = np.unravel_index(error.argmax(), error.shape)
    return tuple(int(np.clip(k, REACH, size - REACH)) for k, size in zip(worst, error.shape, strict=True))


def _plain(text: str) -> str:
    """`text` with the signs that the figure's font lacks spelt in ASCII."""
    return text.replace("−", "-").replace("×", "x")
