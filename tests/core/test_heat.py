"""Maps of errors: their numbers, their colours, their scale."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.accuracy import colours
from pcc_addon.core.accuracy.heat import heat_map, relative_errors
from pcc_addon.core.accuracy.lettering import write, written
from pcc_addon.core.accuracy.scales import rounded_up
from tests.core.test_png import read

RNG = np.random.default_rng(3)
TRUTH = RNG.uniform(0.1, 2.0, (20, 30, 3)).astype(np.float32)
SERVED = np.zeros((20, 30), bool)
SERVED[:8, 5:25] = True  # at the bottom


def relative_rmse(picture: np.ndarray) -> float:
    error = np.square(picture[SERVED].astype(np.float64) - TRUTH[SERVED]).mean()
    return float(np.sqrt(error / np.square(TRUTH[SERVED].astype(np.float64)).mean()))


def test_the_errors_make_the_relative_rmse() -> None:
    picture = TRUTH * RNG.uniform(0.5, 1.5, TRUTH.shape).astype(np.float32)
    errors = relative_errors(picture, TRUTH, SERVED)
    assert np.sqrt(np.square(errors[SERVED]).mean()) == pytest.approx(relative_rmse(picture), rel=1e-9)
    assert (errors[~SERVED] == 0.0).all()


def test_what_is_not_served_is_grey_and_dark_and_does_not_set_the_scale() -> None:
    picture = TRUTH.copy()
    picture[SERVED] *= 1.1
    picture[~SERVED] = 100.0
    drawn = heat_map(picture, TRUTH, SERVED)
    rest = drawn.picture[:20][::-1][~SERVED]
    assert (rest == rest[:, :1]).all() and rest.max() < 90
    assert drawn.end == 0.2


def test_a_pixel_has_the_colour_of_its_error() -> None:
    picture = TRUTH.copy()
    picture[SERVED] += np.linspace(0.0, 1.0, SERVED.sum())[:, None].astype(np.float32)
    drawn = heat_map(picture, TRUTH, SERVED, end=0.5)
    expected = colours.as_bytes(colours.heat(relative_errors(picture, TRUTH, SERVED)[SERVED] / 0.5))
    assert np.array_equal(drawn.picture[:20][::-1][SERVED], expected)
    assert len(np.unique(expected, axis=0)) > 50


def test_the_bar_goes_from_none_to_the_end_and_is_written() -> None:
    drawn = heat_map(TRUTH, TRUTH, SERVED)
    bar = drawn.picture[20 + 4 + 2]
    assert np.array_equal(bar[4], colours.as_bytes(colours.heat(np.array(0.0))))
    assert np.array_equal(bar[-5], colours.as_bytes(colours.heat(np.array(1.0))))
    assert np.array_equal(read(drawn.png), drawn.picture)
    assert (drawn.picture[20 + 16 :] == 235).all(-1).sum() > 30  # letters


def test_nothing_served_and_a_black_truth_are_no_errors() -> None:
    assert heat_map(TRUTH, TRUTH, np.zeros((20, 30), bool)).end == 0.01
    assert not relative_errors(TRUTH, np.zeros_like(TRUTH), SERVED).any()
    with pytest.raises(ValueError, match="do not fit"):
        relative_errors(TRUTH[:3], TRUTH, SERVED)


@pytest.mark.parametrize("anchors", [colours._HEAT, colours._BEFORE, colours._BEYOND])
def test_equal_steps_of_a_ramp_look_equal_and_screens_show_them(anchors) -> None:
    lab = colours.ramp(anchors)
    steps = np.linalg.norm(np.diff(lab, axis=0), axis=-1)
    assert steps.max() < 1.02 * steps.mean()  # an anchor is cut by a step
    assert (np.diff(lab[:, 0]) * np.sign(lab[-1, 0] - lab[0, 0]) > 0.0).all()
    linear = colours.linear_of(lab)
    assert linear.min() > -0.02 and linear.max() < 1.02


def test_oklab_of_white_and_of_a_known_colour() -> None:
    assert np.allclose(colours.linear_of(np.array([1.0, 0.0, 0.0])), 1.0, atol=1e-6)
    red = np.array([0.6279553606, 0.2248630611, 0.1258462985])
    assert np.allclose(colours.linear_of(red), [1.0, 0.0, 0.0], atol=1e-4)


def test_signs_are_told_apart() -> None:
    before, on, beyond = colours.signed(np.array([-1.0, 0.0, 1.0]))
    assert before[0] > before[2] + 0.3 and beyond[2] > beyond[0] + 0.3 and np.ptp(on) < 0.02 and on.min() > 0.9


@pytest.mark.parametrize(("value", "expected"), [(0.011, 0.02), (0.02, 0.02), (3.0, 5.0), (7.0, 10.0), (1.0, 1.0)])
def test_scales_end_at_round_numbers(value: float, expected: float) -> None:
    assert rounded_up(value) == pytest.approx(expected)


def test_letters() -> None:
    assert written("l").sum() == 10 and written("+X", 3).shape == (21, 33)
    picture = np.zeros((9, 9, 3), np.uint8)
    write(picture, "88", 1, 1, (9, 9, 9))  # what does not fit is cut off
    assert np.array_equal(picture[1:8, 1:6].any(-1), written("8")) and picture[1:8, 7:9].any()
