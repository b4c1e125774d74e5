"""What captures are to see in place of metals: nothing, or a matt surface of so much of their colour.

python3 dev.py run benchmarks/captured_metals.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from unittest.mock import patch

import bpy
import numpy as np

from benchmarks import engines
from benchmarks.measure import pixels_of, relative_rmse, render, start, table, write_page
from pcc_addon.core.effects import metal
from pcc_addon.core.effects.shading import MATT
from pcc_addon.core.effects.surface import surface_formula
from sample_blends.two_rooms import of_metal

SHARES = (0.0, MATT, 1.0)
FACE, SAMPLES, TRUTH = 128, 64, 192
SIZE = (120, 68)


def furnished() -> bpy.types.Scene:
    """Two furnished rooms with steel in one of them."""
    scene = of_metal()
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    for probe in (o.pcc_probe for o in scene.objects if o.pcc_probe.is_probe):
        probe.resolution, probe.samples, probe.denoise = FACE, SAMPLES, False
    return scene


def floor(lit: bool) -> bpy.types.Scene:
    """A small room with a floor of rough metal."""
    return engines.build(next(case for case in engines.CASES if case.name == "metal, roughness 0.3"), lit)


PLACES: Mapping[str, tuple[Callable[[], bpy.types.Scene], Mapping[str, str]]] = {
    "furnished": (
        furnished,
        {
            "mirror on the wall": "Lounge Mirror",
            "steel, roughness 0.25": "Steel",
            "leather, roughness 0.15": "Leather",
            "tiles, roughness 0.12": "Tiles",
        },
    ),
    "glowing walls": (lambda: floor(False), {"metal floor, roughness 0.3": engines.SERVED}),
    "lamp": (lambda: floor(True), {"metal floor, roughness 0.3": engines.SERVED}),
}


def measure(place: str) -> list[list[str]]:
    """A row for each part of a place: mean over the truth's, and relative error, by share."""
    build, parts = PLACES[place]
    rows: dict[str, list[str]] = {part: [place, part] for part in parts}
    truth, masks = None, {}
    for share in SHARES:
        with patch.object(metal, "MATT", share):
            surface_formula.cache_clear()
            scene = build()
            if truth is None:
                truth = render(scene, samples=TRUTH).pixels
                masks = {part: pixels_of(scene, {material}) for part, material in parts.items()}
            bpy.ops.pcc.bake(scope="ALL")
            bpy.ops.pcc.inject()
            picture = render(scene, samples=SAMPLES).pixels
        for part, mask in masks.items():
            mean = picture[mask].mean() / truth[mask].mean()
            error = relative_rmse(np.minimum(picture, 1.0), np.minimum(truth, 1.0), mask)
            rows[part].append(f"{mean:.3f} ({error:.3f})")
        print(place, share, rows, file=sys.stderr, flush=True)
    surface_formula.cache_clear()
    return list(rows.values())


def main() -> None:
    start()
    rows = [row for place in PLACES for row in measure(place)]
    text = (
        "Diffuse captures hold nothing of a metal, and a lobe seen from the capture point belongs to that point alone. "
        "What is to be in the pictures where a metal is? Nothing, or a matt surface of some of its colour, lit as what "
        "is around it. Mean radiance over path tracing's, and in brackets the relative RMSE with radiance clipped at "
        f"1, as a screen shows it. Two furnished rooms with steel in one of them (`sample_blends/two_rooms.py`), and a "
        f"small room of glowing walls or with a lamp; faces of {FACE} px, {SAMPLES} samples.\n\n"
        + table(["room", "seen on", *(f"{share:g} of the colour" for share in SHARES)], rows)
        + "\n\nHalf is what captures see. Near a metal are things that it mirrors dark, such as its own shadow, so all "
        "of its colour is too much."
    )
    write_page("captured_metals.md", "Metals in captures", "python3 dev.py run benchmarks/captured_metals.py", text)


if __name__ == "__main__":
    main()
