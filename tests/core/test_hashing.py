"""Random numbers by the bits of three floats: of keys in any shape; which numbers they are, the vectors say."""

from __future__ import annotations

import warnings

import numpy as np

from pcc_addon.core.backends.hashing import random

KEYS = np.random.default_rng(4).normal(size=(24, 3)).astype(np.float32)


def test_keys_of_any_shape_have_their_numbers_in_that_shape() -> None:
    flat = random(KEYS)
    assert flat.shape == (24, 3) and len(np.unique(flat)) == flat.size
    for shape in ((4, 6, 3), (2, 3, 4, 3), (1, 24, 3)):
        np.testing.assert_array_equal(random(KEYS.reshape(shape)), flat.reshape(shape))


def test_one_key_alone_has_the_same_numbers_without_a_word() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        alone = [random(key) for key in KEYS]
    np.testing.assert_array_equal(alone, random(KEYS))


def test_numbers_fill_zero_to_one_evenly_and_do_not_follow_one_another() -> None:
    cells = np.stack(np.meshgrid(*[np.arange(40.0)] * 2, [7.0], indexing="ij"), -1).reshape(-1, 3)
    numbers = random(cells)
    assert numbers.min() >= 0.0 and numbers.max() <= 1.0 and numbers.dtype == np.float64
    np.testing.assert_allclose(numbers.mean(0), 0.5, atol=4.0 / np.sqrt(12.0 * len(cells)))
    np.testing.assert_allclose(np.corrcoef(numbers.T), np.eye(3), atol=4.0 / np.sqrt(len(cells)))
    beside = np.corrcoef(numbers[:-1, 0], numbers[1:, 0])[0, 1]
    assert abs(beside) < 4.0 / np.sqrt(len(cells))
