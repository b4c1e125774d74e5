"""In which layout should the shader read a probe's picture? Measures some, in both engines, and writes the answer.

python3 dev.py run benchmarks/picture_layouts

All layouts get the same number of texels, each the mean of a known radiance over its area, so that what is measured is
the layout and its lookup alone. `all_directions` compares the lookups to the exact radiance everywhere, `floor` what
they make of a mirror floor to the path-traced one.
"""

from __future__ import annotations

from benchmarks.measure import start
from benchmarks.picture_layouts.all_directions import measure_interpolations, measure_layouts
from benchmarks.picture_layouts.figure import draw
from benchmarks.picture_layouts.floor import measure_floor
from benchmarks.picture_layouts.page import write


def main() -> None:
    start()
    results = measure_layouts()
    write(results, measure_interpolations(), measure_floor())
    draw(results)


if __name__ == "__main__":
    main()
