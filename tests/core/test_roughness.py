"""Which levels a roughness reads, and how they are mixed."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.roughness import level_name, mixed_formula, neighbours

RUNGS = (0.0, 0.1, 0.3, 0.6)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.0, 0.0, [0]),
        (0.05, 0.05, [0, 1]),
        (0.1, 0.1, [1]),
        (0.2, 0.2, [1, 2]),
        (0.6, 0.6, [3]),
        (0.8, 0.8, [3]),
        (-0.1, -0.1, [0]),
        (0.0, 1.0, [0, 1, 2, 3]),
        (0.1, 0.3, [1, 2]),
        (0.15, 0.35, [1, 2, 3]),
    ],
)
def test_a_roughness_reads_the_levels_around_it_and_no_others(low: float, high: float, expected: list[int]) -> None:
    assert list(neighbours(RUNGS, low, high)) == expected


def test_a_ladder_of_one_rung_is_always_read() -> None:
    assert list(neighbours((0.2,), 0.0, 0.0)) == list(neighbours((0.2,), 1.0, 1.0)) == [0]


def test_the_radiance_is_mixed_in_proportion_and_the_ends_hold_beyond() -> None:
    levels = {level_name(k): np.array([1.0, 2.0, 4.0]) * value for k, value in enumerate((1.0, 5.0, 2.0, 10.0))}
    roughness = np.array([-1.0, 0.0, 0.025, 0.1, 0.2, 0.3, 0.5, 0.6, 1.0])
    found = evaluate(mixed_formula(RUNGS).outputs, {**levels, "Roughness": roughness}, np.float64)["Radiance"]
    expected = np.interp(roughness, RUNGS, (1.0, 5.0, 2.0, 10.0))
    np.testing.assert_allclose(found, expected[:, None] * [1.0, 2.0, 4.0], atol=1e-12)


def test_levels_are_called_by_number_and_formulas_by_their_rungs() -> None:
    assert level_name(3) == "Level 3"
    assert mixed_formula((0.1, 0.16)).title == "Levels, 0.1 0.16"
    assert mixed_formula((0.1, 0.16)) is mixed_formula((0.1, 0.16))


def test_a_rung_in_single_precision_is_that_rung() -> None:
    rungs = (0.0, 0.05, 0.1, 0.6)
    for k, rung in enumerate(rungs):
        single = float(np.float32(rung))
        assert neighbours(rungs, single, single) == neighbours(rungs, rung, rung) == range(k, k + 1)
    assert neighbours(rungs, 0.0501, 0.0501) == range(1, 3) and neighbours(rungs, 0.0499, 0.0499) == range(2)
