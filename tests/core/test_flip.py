"""HDR-FLIP: against its authors' own program, and by what must hold for any picture."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pcc_addon.core.accuracy.flip import exposures, flip, flip_map, ldr_flip
from pcc_addon.core.errors import PccError


def waves(height: int = 45, width: int = 80) -> np.ndarray:
    """Stripes, edges and a bright lamp: (h, w, 3) float32."""
    y, x = np.mgrid[:height, :width].astype(np.float64)
    picture = np.stack([np.sin(x / 9.0) + 1.0, np.cos(y / 7.0) + 1.0, (x * y % 31.0) / 31.0], axis=-1) ** 2
    picture[5:9, 10:14] = 40.0
    return picture.astype(np.float32)


def noisy(truth: np.ndarray, strength: float = 0.2) -> np.ndarray:
    noise = np.random.default_rng(3).standard_normal(truth.shape[:2])[..., None]
    return (truth * np.maximum(1.0 + strength * noise, 0.0)).astype(np.float32)


ALL = np.ones((45, 80), bool)
PAIRS = {
    "noise": noisy(waves()),
    "shift": np.roll(waves(), 2, axis=1),
    "brighter": waves() * np.float32(1.1),
    "blue": waves() * np.float32([1.0, 1.0, 2.0]),
    "mirrored": np.ascontiguousarray(waves()[:, ::-1]),
    "black": np.zeros_like(waves()),
}


@pytest.mark.parametrize("name", PAIRS)
def test_every_pixel_is_that_of_the_authors_program(name: str) -> None:
    theirs = pytest.importorskip("flip_evaluator", reason="pip install flip-evaluator")
    expected, mean, used = theirs.evaluate(waves(), PAIRS[name], "HDR", applyMagma=False, parameters={"ppd": 67.0})
    ours = flip_map(PAIRS[name], waves())
    assert np.abs(ours - expected[..., 0]).max() < 5e-5  # theirs is in single precision
    assert ours.mean() == pytest.approx(mean, abs=1e-5) and mean > 0.01
    steps = exposures(waves().reshape(-1, 3).astype(np.float64))
    assert (len(steps), steps[0], steps[-1]) == (
        used["numExposures"],
        pytest.approx(used["startExposure"], abs=1e-5),
        pytest.approx(used["stopExposure"], abs=1e-5),
    )


def test_low_dynamic_range_is_that_of_the_authors_program() -> None:
    theirs = pytest.importorskip("flip_evaluator", reason="pip install flip-evaluator")
    truth, shown = (np.clip(picture / 4.0, 0.0, 1.0) for picture in (waves(), noisy(waves())))
    expected, *_ = theirs.evaluate(truth, shown, "LDR", inputsRGB=False, applyMagma=False, parameters={"ppd": 67.0})
    assert np.abs(ldr_flip(shown, truth) - expected[..., 0]).max() < 5e-5


def test_equal_pictures_show_no_difference() -> None:
    assert flip(waves(), waves(), ALL) == 0.0


def test_more_noise_is_seen_more() -> None:
    values = [flip(noisy(waves(), strength), waves(), ALL) for strength in (0.01, 0.05, 0.2, 0.8)]
    assert values == sorted(values) and values[0] > 0.0 and values[-1] < 1.0


def test_it_stays_between_nothing_and_all() -> None:
    for shown in PAIRS.values():
        error = flip_map(shown, waves())
        assert error.min() >= 0.0 and error.max() <= 1.0


def test_exposure_makes_no_difference() -> None:
    """Both pictures brighter by a factor: the exposures move, and what is seen stays."""
    assert flip_map(64.0 * noisy(waves()), 64.0 * waves()) == pytest.approx(flip_map(noisy(waves()), waves()), abs=1e-9)


def test_it_finds_what_one_exposure_hides() -> None:
    """A difference in the dark that the lamp's exposure shows as black."""
    truth = np.full((45, 80, 3), 0.002)
    truth[20:24, 30:34] = 500.0
    shown = truth.copy()
    shown[:, :10] *= 3.0
    steps = exposures(truth.reshape(-1, 3))
    assert steps[-1] - steps[0] == pytest.approx(math.log2(500.0 / 0.002))
    assert flip_map(shown, truth)[:, :8].min() > 0.2


def test_errors_outside_the_mask_change_nothing_inside() -> None:
    mask = ALL.copy()
    mask[:, 40:] = False
    truth, shown = waves(), noisy(waves())
    expected = flip(np.where(mask[..., None], shown, truth), truth, mask)
    wrong = shown.copy()
    wrong[:, 40:] = np.nan
    assert flip(wrong, truth, mask) == expected > 0.0
    assert not flip_map(wrong, truth, mask)[:, 40:].any()


def test_only_served_pixels_choose_the_exposures() -> None:
    """A truth that was rendered where the probe is seen, and is black elsewhere, has the same error there."""
    mask = np.zeros_like(ALL)
    mask[10:30, 20:60] = True
    lit = np.where(mask[..., None], waves(), np.float32(0.0))
    lamp = lit.copy()
    lamp[0, 0] = 1e6
    shown = np.where(mask[..., None], noisy(waves()), np.float32(0.0))
    far = np.zeros_like(mask)
    far[20, 40] = True  # farther from the lamp than the filters reach
    assert flip_map(shown, lit, mask)[far] == flip_map(shown, lamp, mask)[far]


def test_what_is_negative_is_black() -> None:
    truth = waves()
    assert flip_map(-truth, truth) == pytest.approx(flip_map(0.0 * truth, truth))


def test_an_even_picture_needs_no_more_than_two_exposures() -> None:
    steps = exposures(np.ones((12, 3)))
    assert len(steps) == 2 and steps[0] == steps[1]


def test_a_black_truth_has_exposures() -> None:
    assert np.isfinite(exposures(np.zeros((12, 3)))).all()


def test_what_cannot_be_compared_is_named() -> None:
    with pytest.raises(PccError, match="serves no pixel"):
        flip(waves(), waves(), ~ALL)
    with pytest.raises(PccError, match="not finite"):
        flip(waves() * np.nan, waves(), ALL)
    with pytest.raises(ValueError, match="picture"):
        flip(waves()[1:], waves(), ALL)
