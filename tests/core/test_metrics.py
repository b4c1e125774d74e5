"""Errors of pictures: exact values, invariants, and what noise does to them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pcc_addon.core.accuracy.metrics import (
    Trust,
    flicker,
    noise_of_halves,
    relative_rmse,
    trust,
    trust_words,
    without_noise,
)
from pcc_addon.core.errors import PccError

ALL = np.ones((6, 8), bool)


def picture(seed: int = 0, shape: tuple[int, int] = (6, 8)) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.1, 3.0, (*shape, 3)).astype(np.float32)


def test_equal_pictures_have_no_error() -> None:
    assert relative_rmse(picture(), picture(), ALL) == 0.0


@pytest.mark.parametrize("scale", [0.0, 0.5, 0.9, 1.25, 3.0])
def test_a_factor_is_off_by_itself_however_bright_the_picture(scale: float) -> None:
    truth = picture().astype(np.float64)
    assert relative_rmse(scale * truth, truth, ALL) == pytest.approx(abs(scale - 1.0), rel=1e-12)
    assert relative_rmse(scale * 1e6 * truth, 1e6 * truth, ALL) == pytest.approx(abs(scale - 1.0), rel=1e-12)


def test_one_value_of_known_size() -> None:
    truth, shown = np.ones((1, 2, 3)), np.ones((1, 2, 3))
    shown[0, 1, 2] = 3.0
    assert relative_rmse(shown, truth, np.ones((1, 2), bool)) == pytest.approx(math.sqrt(4.0 / 6.0))


def test_what_lies_outside_the_mask_does_not_count() -> None:
    mask = ALL.copy()
    mask[2:, :] = False
    shown = picture().copy()
    shown[2:] = np.nan
    assert relative_rmse(shown, picture(), mask) == 0.0
    truth = picture().copy()
    truth[2:] = np.inf
    assert relative_rmse(shown, truth, mask) == 0.0


def test_half_precision_is_summed_in_double() -> None:
    """60,000 squares of 200 would overflow in half and lose digits in single precision."""
    truth = np.full((200, 100, 3), 200.0, np.float16)
    shown = truth + np.float16(2.0)
    assert relative_rmse(shown, truth, np.ones((200, 100), bool)) == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize(
    ("shown", "truth", "mask", "words"),
    [
        (picture(), picture(), ~ALL, "serves no pixel"),
        (picture() * np.nan, picture(), ALL, "the picture has pixels that are not finite"),
        (picture(), picture() * np.inf, ALL, "the truth has pixels that are not finite"),
        (picture(), picture() * 0, ALL, "black"),
    ],
)
def test_what_cannot_be_compared_is_named(shown: np.ndarray, truth: np.ndarray, mask: np.ndarray, words: str) -> None:
    with pytest.raises(PccError, match=words):
        relative_rmse(shown, truth, mask)


def test_other_shapes_are_a_mistake() -> None:
    with pytest.raises(ValueError, match="mask"):
        relative_rmse(picture(), picture(), ALL[1:])
    with pytest.raises(ValueError, match="mask"):
        relative_rmse(picture(), picture(), ALL.astype(np.uint8))


def test_an_error_that_stays_does_not_flicker() -> None:
    truths = [picture(k).astype(np.float64) for k in range(3)]
    wrong = picture(9)
    assert flicker([truth + wrong for truth in truths], truths, [ALL] * 3) == pytest.approx(0.0, abs=1e-12)


def test_changes_that_are_too_large_by_a_factor() -> None:
    truths = [picture(k).astype(np.float64) for k in range(3)]
    assert flicker([1.3 * truth for truth in truths], truths, [ALL] * 3) == pytest.approx(0.3)
    assert flicker([truths[0]] * 3, truths, [ALL] * 3) == pytest.approx(1.0)  # frozen: no change at all


def test_flicker_counts_pixels_that_are_served_in_both_frames() -> None:
    truths = [picture(k).astype(np.float64) for k in range(2)]
    shown = [truths[0].copy(), truths[1].copy()]
    shown[0][0, 0], shown[1][1, 1] = np.nan, np.nan
    masks = [ALL.copy(), ALL.copy()]
    masks[0][0, 0], masks[1][1, 1] = False, False
    assert flicker(shown, truths, masks) == 0.0


@pytest.mark.parametrize("frames", [0, 1, 2])
def test_without_change_there_is_no_flicker(frames: int) -> None:
    assert flicker([picture(k) for k in range(frames)], [picture()] * frames, [ALL] * frames) is None


def test_frames_without_a_common_pixel_are_skipped() -> None:
    truths = [picture(k) for k in range(2)]
    assert flicker(truths, truths, [ALL, ~ALL]) is None
    with pytest.raises(ValueError, match="2 pictures, 2 truths and 1 masks"):
        flicker(truths, truths, [ALL])


def test_halves_tell_the_noise_of_their_mean() -> None:
    """The estimate against the mean's true error, which is known here; both have a scatter of about 0.4 %."""
    rng, mask = np.random.default_rng(5), np.ones((100, 200), bool)
    clean = picture(1, (100, 200)).astype(np.float64)
    first, second = (clean + 0.2 * rng.standard_normal(clean.shape) for _ in range(2))
    true = relative_rmse((first + second) / 2.0, clean, mask)
    assert noise_of_halves(first, second, mask) == pytest.approx(true, rel=0.015)


def test_the_truths_noise_can_be_taken_off() -> None:
    rng, mask = np.random.default_rng(6), np.ones((100, 200), bool)
    clean = picture(1, (100, 200)).astype(np.float64)
    first, second = (clean + 0.2 * rng.standard_normal(clean.shape) for _ in range(2))
    shown = 1.05 * clean
    measured = relative_rmse(shown, (first + second) / 2.0, mask)
    corrected = without_noise(measured, noise_of_halves(first, second, mask))
    assert measured > 0.08 and corrected == pytest.approx(0.05, rel=0.05)


def test_no_error_is_less_than_nothing() -> None:
    assert without_noise(0.01, 0.02) == 0.0
    assert without_noise(0.05, 0.03) == pytest.approx(0.04)
    assert without_noise(0.05, 0.0) == 0.05


@pytest.mark.parametrize(
    ("rmse", "judged"), [(0.0, Trust.LOST), (0.0109, Trust.LOST), (0.012, Trust.BLURRED), (0.03, Trust.CLEAR)]
)
def test_how_far_an_error_can_be_believed(rmse: float, judged: Trust) -> None:
    assert trust(rmse, 0.01) is judged
    assert bool(trust_words(rmse, 0.01)) == (judged is not Trust.CLEAR)


def test_without_noise_every_error_is_clear() -> None:
    assert trust(1e-9, 0.0) is trust(0.0, 0.0) is Trust.CLEAR


def test_words_hold_their_numbers() -> None:
    assert trust_words(0.02, 0.01).startswith(
        "25% of the measured error's square is noise of the truth itself (0.0100)"
    )
    assert "0.0100" in trust_words(0.01, 0.01) and "truth with more samples" in trust_words(0.01, 0.01)
