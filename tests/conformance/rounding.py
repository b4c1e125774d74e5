"""Intervals that hold whatever float32 may find, operation by operation: the bound of formulas without a geometry.

Each operation rounds once, by at most 2⁻²⁴ of its result, or flushes what is smaller than 2⁻¹²⁶ to zero; fusing a
product with a sum rounds less (Higham, *Accuracy and Stability of Numerical Algorithms*, chapters 2 and 3; Moore,
*Interval Analysis*). Ends are float64, whose own rounding is a part in 10⁹ of that. A branch that rounding decides is
the interval of both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .digits import unit

ROUNDOFF = 2.0**-24
SMALLEST = 2.0**-126  # what is smaller may be flushed to zero

Number = "Rounded | np.ndarray | float"


@dataclass(frozen=True)
class Rounded:
    """Where results of n cases lie: (n,) scalars, or (n, 3) vectors component by component."""

    low: np.ndarray
    high: np.ndarray

    __array_ufunc__ = None  # so that arrays leave operators to this class

    @classmethod
    def given(cls, values: np.ndarray | float, off: np.ndarray | float = 0.0) -> Rounded:
        """Numbers that are known, or known but for `off`."""
        values = np.asarray(values, np.float64)
        return cls(values - off, values + off)

    def __neg__(self) -> Rounded:
        return Rounded(-self.high, -self.low)

    def __add__(self, other: Number) -> Rounded:
        other = _lifted(other)
        return _once(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Number) -> Rounded:
        return self + -_lifted(other)

    def __rsub__(self, other: Number) -> Rounded:
        return -self + other

    def __mul__(self, other: Number) -> Rounded:
        other = _lifted(other)
        return _once(*_ends(self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high))

    def __truediv__(self, other: Number) -> Rounded:
        """Anything at all where the divisor may be zero."""
        other = _lifted(other)
        sure = (other.low > 0.0) | (other.high < 0.0)
        low, high = np.where(sure, other.low, 1.0), np.where(sure, other.high, 1.0)
        found = _once(*_ends(self.low / low, self.low / high, self.high / low, self.high / high))
        return Rounded(np.where(sure, found.low, -np.inf), np.where(sure, found.high, np.inf))

    def __getitem__(self, chosen: object) -> Rounded:
        return Rounded(self.low[chosen], self.high[chosen])

    __radd__, __rmul__ = __add__, __mul__

    def within(self, low: float, high: float) -> Rounded:
        """Cut off, which rounds nothing; or known to lie there for another reason."""
        return Rounded(np.clip(self.low, low, high), np.clip(self.high, low, high))

    def off(self, exact: np.ndarray) -> np.ndarray:
        """How far from `exact` results may lie; (n,) or (n, 3), never NaN."""
        with np.errstate(invalid="ignore"):
            found = np.maximum(self.high - exact, exact - self.low)
        return np.where(np.isnan(found), np.inf, found)


def _lifted(value: Number) -> Rounded:
    return value if isinstance(value, Rounded) else Rounded.given(value)


def _once(low: np.ndarray, high: np.ndarray) -> Rounded:
    """What an operation with exact results in this interval gives."""
    return Rounded(low - ROUNDOFF * np.abs(low) - SMALLEST, high + ROUNDOFF * np.abs(high) + SMALLEST)


def _ends(*corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Zero times infinity is zero: what is multiplied is finite, however large."""
    known = [np.where(np.isnan(corner), 0.0, corner) for corner in corners]
    return np.minimum.reduce(known), np.maximum.reduce(known)


def of_length_one(v: np.ndarray) -> Rounded:
    """A unit vector that the numbers (n, 3) are off from by their own rounding."""
    meant = unit(v.astype(np.float64))
    return Rounded.given(meant, ROUNDOFF * np.abs(meant))


def scalar(values: Rounded) -> Rounded:
    """(n, 1) of (n,), to meet vectors."""
    return values[..., None]


def minimum(a: Number, b: Number) -> Rounded:
    a, b = _lifted(a), _lifted(b)
    return Rounded(np.minimum(a.low, b.low), np.minimum(a.high, b.high))


def sqrt(a: Rounded) -> Rounded:
    """Of what is not below 0."""
    a = a.within(0.0, np.inf)
    return _once(np.sqrt(a.low), np.sqrt(a.high))


def positive(a: Rounded) -> Rounded:
    """1 where a number is above zero, else 0."""
    return Rounded((a.low > 0.0).astype(float), (a.high > 0.0).astype(float))


def dot(a: Rounded, b: Rounded) -> Rounded:
    """(n,): three products and two sums, in any order."""
    corners = _ends(a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high)
    lost = 3.0 * ROUNDOFF * np.maximum(*(np.abs(end) for end in corners)).sum(-1) + 5.0 * SMALLEST
    return Rounded(corners[0].sum(-1) - lost, corners[1].sum(-1) + lost)


def length(a: Rounded) -> Rounded:
    """(n,): squares and sums err by 3 roundings, which the root halves, and the root by one."""
    least = np.where((a.low <= 0.0) & (a.high >= 0.0), 0.0, np.minimum(np.abs(a.low), np.abs(a.high)))
    most = np.maximum(np.abs(a.low), np.abs(a.high))
    ends = (np.linalg.norm(v, axis=-1) for v in (least, most))
    low, high = (v * (1.0 + share * ROUNDOFF) for v, share in zip(ends, (-2.5, 2.5), strict=True))
    return Rounded(low - SMALLEST, high + SMALLEST)


def normalize(a: Rounded) -> Rounded:
    """By a division, or by a reciprocal and a product, which round twice."""
    return (a / scalar(length(a)) * 1.0).within(-1.0 - 8.0 * ROUNDOFF, 1.0 + 8.0 * ROUNDOFF)


def reflect(a: Rounded, normal: Rounded) -> Rounded:
    n = normalize(normal)
    return a - n * scalar(dot(a, n)) * 2.0


def mix(a: Rounded, b: Rounded, weight: Rounded) -> Rounded:
    """a where the weight is 0, b where it is 1."""
    return (b - a) * weight + a


def smooth(steps: Rounded) -> Rounded:
    """3 x² − 2 x³ of x cut off to 0 … 1; it rises, so its ends are at the ends."""
    x = steps.within(0.0, 1.0)
    ends = [end * end * (3.0 - 2.0 * end) for end in (x.low, x.high)]
    return Rounded(ends[0] * (1.0 - 6.0 * ROUNDOFF) - SMALLEST, ends[1] * (1.0 + 6.0 * ROUNDOFF) + SMALLEST)
