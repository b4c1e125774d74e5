"""docs/picture_layouts.md: the tables, and what their columns mean."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from benchmarks.measure import table, write_page
from benchmarks.picture_layouts.all_directions import (
    INTERIOR,
    QUAD,
    TIMING_ROUNDS,
    TIMING_SAMPLES,
    InterpolationResult,
    LayoutResult,
)
from benchmarks.picture_layouts.figure import FIGURE, NAMES
from benchmarks.picture_layouts.floor import SAMPLES, FloorResult
from benchmarks.picture_layouts.layouts import GUTTER, SEAM_REACH, GuardedEquirectangular, Layout
from benchmarks.picture_layouts.radiances import OVERSAMPLING
from pcc_addon.core.probe import Engine


def write(
    results: Sequence[LayoutResult], interpolations: Sequence[InterpolationResult], floor: Sequence[FloorResult]
) -> None:
    """Write the page."""
    frames = ", ".join(
        f"{median(_first_in(results, engine).seconds):.1f} s in {name}" for engine, name in NAMES.items()
    )
    samples = ", ".join(f"{TIMING_SAMPLES[engine]} samples in {name}" for engine, name in NAMES.items())
    text = f"""The add-on keeps its pictures equirectangular and looks them up with Linear interpolation, no
nearer to a pole than half a texel: "{GuardedEquirectangular.label}" below.

## Which layout

{_layout_table(results)}

All pictures have the same number of texels to 0.3 %, each the mean of {OVERSAMPLING**2} exact values of the radiance
over its area, and are read with Linear interpolation. The view holds all directions, {QUAD} pixels across 90°, one
sample at each pixel's centre.

- room, smooth: relative RMSE (RMS error over RMS truth) of the lookup against the exact radiance: a room of squares
  with hard edges, and waves between 0.5 and 1.5.
- largest error at seams: of the smooth radiance, within {SEAM_REACH:g} texels of each kind of seam; away from them: at
  least {INTERIOR:g} texels from all.
- nodes: from the direction to the colour. The atlas and the octahedral map have gutters of {GUTTER} texels.
- time: the processor's, for a frame ({3 * QUAD}×{2 * QUAD} pixels; {samples}; EEVEE
  renders in software), over the first layout's in the same round; median and range of {TIMING_ROUNDS} alternating
  rounds. The first layout's median frame takes {frames}.

![Lookups of the smooth radiance around the worst pixel at each kind of seam](images/{FIGURE.name})

## Interpolation

{_interpolation_table(interpolations)}

Of the Environment Texture node in the add-on's lookup; columns as above.

## The floor of the emissive room

{_floor_table(floor)}

Relative RMSE over the floor's pixels, box-corrected lookup against the path-traced mirror in Cycles, {SAMPLES} samples,
Linear interpolation. Exact texels are filled as above; a capture is made from what the bake's six cameras would see,
each pixel the mean of {OVERSAMPLING**2} exact values."""
    write_page("picture_layouts.md", "Picture layouts", "python3 dev.py run benchmarks/picture_layouts", text)


def _first_in(results: Sequence[LayoutResult], engine: Engine) -> LayoutResult:
    """What the others' times are divided by."""
    return next(result for result in results if result.engine is engine)


def _layout_table(results: Sequence[LayoutResult]) -> str:
    head = ["layout", "texels", "nodes", "engine", "room", "smooth", "largest error at seams", "away from them", "time"]
    rows = [
        [
            result.layout.label,
            f"{_size(result.layout)} = {_texels(result.layout)}",
            result.nodes,
            NAMES[result.engine],
            f"{result.accuracy.room:.4f}",
            f"{result.accuracy.smooth:.5f}",
            "; ".join(f"{name} {error:.4f}" for name, error in result.accuracy.seams.items()),
            f"{result.accuracy.interior:.4f}",
            _relative_time(result, _first_in(results, result.engine)),
        ]
        for result in results
    ]
    return table(head, rows)


def _relative_time(result: LayoutResult, first: LayoutResult) -> str:
    """The median over rounds of a layout's frame time over the first layout's in the same round, and its range."""
    ratios = [a / b for a, b in zip(result.seconds, first.seconds, strict=True)]
    return f"{median(ratios):.2f} ({min(ratios):.2f} … {max(ratios):.2f})"


def _interpolation_table(results: Sequence[InterpolationResult]) -> str:
    rows = [[r.interpolation, NAMES[r.engine], f"{r.accuracy.room:.4f}", f"{r.accuracy.smooth:.5f}"] for r in results]
    return table(["interpolation", "engine", "room", "smooth"], rows)


def _floor_table(results: Sequence[FloorResult]) -> str:
    rows = [
        [r.picture, _size(r.layout), f"{_texels(r.layout) / 1e6:.2f}", *(f"{r.errors[engine]:.4f}" for engine in NAMES)]
        for r in results
    ]
    return table(["picture", "size", "million texels", *NAMES.values()], rows)


def _size(layout: Layout) -> str:
    width, height = layout.size
    return f"{width}×{height}"


def _texels(layout: Layout) -> int:
    width, height = layout.size
    return width * height
