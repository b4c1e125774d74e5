"""How many levels a probe needs: the error of mixing two neighbours, and what a ladder costs in time and memory.

python3 dev.py run benchmarks/ladder.py
"""

from __future__ import annotations

import time
from functools import cache

import numpy as np

from benchmarks.measure import start, table, write_page
from pcc_addon.core import equirect
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.roughness import level_name, mixed
from pcc_addon.core.expression import scalar
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.prefilter import prefilter

HEIGHT = 256
BAKED_HEIGHT = 1024  # of the picture of 512 pixel faces
LADDERS = {
    "6 levels": (0.0, 0.08, 0.15, 0.25, 0.4, 0.6),
    "7, evenly": (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
    "8 (chosen)": LADDER,
    "10 levels": (0.0, 0.04, 0.08, 0.12, 0.17, 0.22, 0.28, 0.36, 0.47, 0.6),
    "12 levels": (0.0, 0.03, 0.06, 0.09, 0.12, 0.16, 0.2, 0.25, 0.31, 0.39, 0.48, 0.6),
}
ROUGHNESSES = np.linspace(0.02, 0.6, 30)


@cache
def picture(kind: str, height: int) -> np.ndarray:
    """(h, 2h, 3): dim walls with edges all around; "lamps" adds five of 8° to 16°, a hundred times as bright."""
    directions = equirect.directions(2 * height, height)
    x, y = directions[..., :1], directions[..., 1:2]
    pixels = np.full((height, 2 * height, 3), 0.05, np.float32)
    pixels += 0.4 * (np.sin(18.0 * x) * np.sin(20.0 * y) > 0.0)
    if kind == "lamps":
        centres = np.random.default_rng(3).normal(size=(5, 3))
        centres[:, 2] = np.abs(centres[:, 2])
        for k, centre in enumerate(centres / np.linalg.norm(centres, axis=1, keepdims=True)):
            pixels[directions @ centre > np.cos(np.radians(4 + k))] = 40.0
    return pixels


@cache
def level(kind: str, roughness: float) -> np.ndarray:
    """(h, 2h, 3): the exact level at every texel's direction."""
    return equirect.lookup(prefilter(picture(kind, HEIGHT), roughness), equirect.directions(2 * HEIGHT, HEIGHT)).astype(
        np.float32
    )


def errors(kind: str, ladder: tuple[float, ...]) -> np.ndarray:
    """Relative RMSE over the sphere of the mixed radiance, for each of `ROUGHNESSES`."""
    weight = np.sqrt(equirect.solid_angles(2 * HEIGHT, HEIGHT))[:, None, None]
    found = []
    for roughness in ROUGHNESSES:
        inputs = {level_name(k): level(kind, rung) for k, rung in enumerate(ladder)}
        mix = evaluate({"Radiance": mixed(ladder, scalar("Roughness"))}, {**inputs, "Roughness": roughness})
        exact = level(kind, float(roughness))
        found.append(np.linalg.norm((mix["Radiance"] - exact) * weight) / np.linalg.norm(exact * weight))
    return np.array(found)


def cost(ladder: tuple[float, ...]) -> tuple[float, float]:
    """Seconds to make the levels of a picture of 512 pixel faces, and their megabytes."""
    source = picture("lamps", BAKED_HEIGHT)
    begin = time.perf_counter()
    levels = [prefilter(source, rung) for rung in ladder]
    return time.perf_counter() - begin, sum(pixels.nbytes for pixels in levels) / 2**20


def main() -> None:
    start()
    costs = {name: cost(ladder) for name, ladder in LADDERS.items()}
    chosen = costs["8 (chosen)"][0]
    rows = []
    for name, ladder in LADDERS.items():
        lamps, walls = errors("lamps", ladder), errors("walls", ladder)
        seconds, megabytes = costs[name]
        found = (f"{value:.3f}" for value in (lamps.max(), lamps.mean(), walls.max(), walls.mean()))
        rows.append([name, *found, f"{seconds / chosen:.2f}", f"{megabytes:.0f}"])
    text = (
        "A roughness between two levels is mixed from both, linearly in the roughness. Relative RMSE over the sphere "
        f"against the exact level, over roughness {ROUGHNESSES[0]:g} … {ROUGHNESSES[-1]:g}; time (as a ratio) and "
        "memory of the levels of a bake with 512 pixel faces, the capture included. The chosen ladder is "
        f"{', '.join(f'{rung:g}' for rung in LADDER)}.\n\n"
        + table(["ladder", "lamps, worst", "mean", "walls, worst", "mean", "time", "MB"], rows)
    )
    write_page("ladder.md", "How many levels", "python3 dev.py run benchmarks/ladder.py", text)


if __name__ == "__main__":
    main()
