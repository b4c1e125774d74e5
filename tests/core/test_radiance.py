"""Pixels that no picture should hold."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.radiance import BRIGHTEST, clean, clean_whole, linear_of_srgb


def picture(**pixels: object) -> np.ndarray:
    """Grey, 8 × 8; pixels by "column_row", as in c3r5=(r, g, b)."""
    result = np.full((8, 8, 3), 0.5, np.float32)
    for place, colour in pixels.items():
        column, row = (int(k) for k in place[1:].split("r"))
        result[row, column] = colour
    return result


def test_a_good_picture_comes_back_as_it_is() -> None:
    good = picture(c1r1=(0.0, np.nextafter(np.float32(BRIGHTEST), np.float32(0)), 1e-30), c2r2=(-0.0, 1.0, 2.0))
    cleaned, bad = clean(0, good)
    assert cleaned is good
    assert bad is None


@pytest.mark.parametrize(
    ("value", "becomes"),
    [
        (np.nan, 0.0),
        (-np.inf, 0.0),
        (np.inf, BRIGHTEST),
        (-1e-20, 0.0),
        (-5.0, 0.0),
        (BRIGHTEST, BRIGHTEST),  # where EEVEE cuts off
        (65505.0, BRIGHTEST),
        (1e30, BRIGHTEST),
    ],
)
def test_each_bad_value_becomes_what_the_rule_says_and_its_neighbours_stay(value: float, becomes: float) -> None:
    before = picture(c3r5=(0.25, value, 7.0))
    kept = before.copy()
    cleaned, bad = clean(1, before)
    assert cleaned[5, 3].tolist() == [0.25, becomes, 7.0]
    assert (cleaned != 0.5).any(-1).sum() == 1
    np.testing.assert_array_equal(before, kept, err_msg="the capture itself is left alone")
    assert bad is not None
    assert bad.first == (3, 5)
    assert bad.face == "-X"
    assert cleaned.dtype == np.float32


def test_half_floats_hold_the_brightest_value() -> None:
    assert np.isfinite(np.float16(BRIGHTEST))
    with np.errstate(over="ignore"):
        assert np.isinf(np.float16(BRIGHTEST + 32.0))


def test_pixels_are_counted_by_what_was_wrong_with_them() -> None:
    bad_pixels = {
        "c7r2": (np.nan, np.nan, np.nan),
        "c0r4": (np.inf, 0.0, 0.0),
        "c1r4": (-1.0, -2.0, 0.0),
        "c2r4": (-1.0, 0.0, 1e9),
        "c3r6": (1e6, 0.0, 0.0),
        "c0r7": (-3.0, 0.0, 0.0),
    }
    _, bad = clean(5, picture(**bad_pixels))
    assert bad is not None
    assert (bad.not_finite, bad.negative, bad.too_bright) == (2, 3, 2)
    assert bad.first == (7, 2), "the lowest row first"
    assert str(bad) == (
        "face -Z: 2 not finite, 3 negative, 2 too bright pixels were replaced, the first at column 7, row 2"
    )


def test_what_did_not_happen_is_not_mentioned() -> None:
    _, bad = clean(2, picture(c4r0=(0.0, -1.0, 0.0)))
    assert str(bad) == "face +Y: 1 negative pixels were replaced, the first at column 4, row 0"


def test_pixels_beyond_a_faces_90_degrees_are_replaced_but_counted_in_the_next_face() -> None:
    """Positions are those of the face without its overscan."""
    before = picture(c1r3=(np.nan, 0.0, 0.0), c7r7=(1e9, 0.0, 0.0))
    cleaned, bad = clean(0, before, overscan=2)
    assert cleaned[3, 1, 0] == 0.0
    assert cleaned[7, 7, 0] == BRIGHTEST
    assert bad is None
    before[5, 4], before[6, 4] = -1.0, -1.0
    _, bad = clean(0, before, overscan=2)
    assert bad is not None
    assert (bad.not_finite, bad.negative, bad.too_bright, bad.first) == (0, 1, 0, (2, 3))


def test_a_given_picture_of_any_shape_is_cleaned_by_the_same_rule_and_named() -> None:
    given_picture = np.full((2, 4, 3), 0.5, np.float32)
    assert clean_whole("sky.hdr", given_picture) == (given_picture, "")
    given_picture[0, 3], given_picture[1, 0, 1], given_picture[1, 1, 2] = np.nan, -1.0, 1e9
    cleaned, words = clean_whole("sky.hdr", given_picture)
    assert words == "picture 'sky.hdr': 1 not finite, 1 negative, 1 too bright pixels were replaced"
    assert (cleaned[0, 3] == 0.0).all() and cleaned[1, 0, 1] == 0.0 and cleaned[1, 1, 2] == BRIGHTEST
    assert (cleaned == 0.5).sum() == 24 - 5


def test_encoded_values_become_light_as_the_standard_says() -> None:
    encoded = np.array([0.0, 0.04045, 0.0404501, 0.5, 1.0], np.float32)
    np.testing.assert_allclose(
        linear_of_srgb(encoded), [0.0, 0.0031308, 0.0031308, 0.21404114, 1.0], rtol=2e-5, atol=1e-9
    )
    ramp = linear_of_srgb(np.linspace(0.0, 1.0, 256, dtype=np.float32))
    assert (np.diff(ramp) > 0.0).all() and ramp.dtype == np.float32


@given(st.lists(st.floats(width=32), min_size=12, max_size=12))
def test_a_cleaned_picture_stays_as_it_is(values: list[float]) -> None:
    cleaned, _ = clean(0, np.array(values, np.float32).reshape(2, 2, 3))
    assert ((cleaned >= 0.0) & (cleaned <= BRIGHTEST)).all()
    np.testing.assert_array_equal(clean(0, cleaned)[0], cleaned)
