"""Numbers to be exact with: float64 for many cases, 50 digits for some; both are arrays of one computation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import mpmath
import numpy as np

Numbers = Callable[[np.ndarray], np.ndarray]


def float64(array: np.ndarray) -> np.ndarray:
    return array.astype(np.float64)


@contextmanager
def fifty() -> Iterator[Numbers]:
    """Makes arrays of numbers with 50 digits; what is computed with them within the context keeps these."""
    with mpmath.workdps(50):
        yield lambda array: np.vectorize(lambda value: mpmath.mpf(float(value)), otypes=[object])(array)


def inner(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The dot product of vectors (…, 3) as (…, 1)."""
    return (a * b).sum(-1, keepdims=True)


def unit(v: np.ndarray) -> np.ndarray:
    """Vectors (…, 3) of length 1; the zero vector stays zero."""
    length = inner(v, v) ** 0.5
    return np.where(length > 0, v / np.where(length > 0, length, 1), v)


def root(a: np.ndarray) -> np.ndarray:
    """Square root; 0 for what is below."""
    return np.maximum(a, 0) ** 0.5
