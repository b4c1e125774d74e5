"""The path-traced truth: rendered in two halves with seeds of their own, for as long as it may take."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...core.accuracy.halves import Halves
from ...core.accuracy.metrics import noise_of_halves
from ...core.accuracy.records import Kind, Settings
from ...core.probe import Engine
from .bench import Bench

CLEAN = 0.002  # relative noise below which more samples tell nothing more
_FEWEST, _MOST = 2, 64  # samples of a render: few tell the time, many could not be cancelled


def deepened(
    bench: Bench, number: int, mask: np.ndarray, seconds: float, kept: Halves | None, first_seed: int
) -> Iterator[Halves]:
    """Render a frame again and again without probes; yields what there is after each pair of renders.

    Args:
        bench: where.
        number: of the frame.
        mask: (h, w) bool, the pixels that count.
        seconds: that both halves may take together, those of `kept` included; one pair is rendered in any case.
        kept: what there was before.
        first_seed: none of the seeds from here on is used elsewhere.

    Raises:
        PccError: the truth is black where the probe is seen, or cannot be rendered.
        Cancelled: the user stopped a render.
    """
    halves, samples, seed = kept, _FEWEST, first_seed
    bench.show(Settings(Kind.PATH, Engine.CYCLES))
    if halves is not None:
        yield halves
    while True:
        if halves is not None:
            per_sample = halves.seconds / halves.samples
            left = seconds - halves.seconds
            samples = min(_MOST, halves.samples, int(left / per_sample))
            if samples < _FEWEST or noise_of_halves(halves.first, halves.second, mask) < CLEAN:
                return
        settings = Settings(Kind.PATH, Engine.CYCLES, frame_samples=samples)
        one, other = (bench.frame(settings, number, seed + k) for k in range(2))
        taken = one.seconds + other.seconds
        pair = Halves(one.pixels.astype(np.float64), other.pixels.astype(np.float64), samples, taken)
        halves = pair if halves is None else halves.deepened(pair)
        seed += 2
        yield halves
