"""The formula with one guard taken away, and the articles' formula as it is printed: what each guard is for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects
from pcc_addon.core.expression import (
    Expr,
    absolute,
    combine,
    dot,
    greatest,
    maximum,
    minimum,
    multiply_add,
    reflect,
    sign,
    vector,
)

from .cases import Cases

# Where the articles subtract: the box's centre along the face normals, taken off after the multiplication.
_OFFSET = vector("Box Offset")
_NORMALS = (formula.NORMAL_X, formula.NORMAL_Y, formula.NORMAL_Z)


@dataclass(frozen=True)
class Variant:
    """Another way to compute the lookup direction inside a box.

    Attributes:
        name: as tables show it.
        direction: makes the expression for a correction.
        corrections: for which it differs from the formula.
    """

    name: str
    direction: Callable[[Correction], Expr]
    corrections: tuple[Correction, ...] = tuple(c for c in Correction if c is not Correction.NONE)


def full(correction: Correction) -> Expr:
    """The formula as it is shipped."""
    return formula.lookup(LookupEffects(correction, None))["Direction"]


def _back() -> Expr:
    return reflect(formula.INCOMING, formula.NORMAL)


def _coordinates(correction: Correction) -> tuple[Expr, Expr]:
    from_centre = formula.POSITION - formula.CENTRE
    return tuple(formula.along_face_normals(correction, v) for v in (from_centre, _back()))


def _least(v: Expr) -> Expr:
    return minimum(minimum(v.x, v.y), v.z)


def _without_wall_guard(correction: Correction) -> Expr:
    q, d = _coordinates(correction)
    nearness = greatest(absolute(d) / multiply_add(q, sign(d), formula.HALF_WIDTHS))
    return (formula.POSITION - formula.CAPTURE_POINT) * nearness - _back()


def _two_planes_an_axis(correction: Correction) -> Expr:
    q, d = _coordinates(correction)
    ray = d * -1.0
    distance = _least(maximum((q * -1.0 - formula.HALF_WIDTHS) / ray, (formula.HALF_WIDTHS - q) / ray))
    return (formula.POSITION - formula.CAPTURE_POINT) - _back() * distance


def _centre_last(correction: Correction) -> Expr:
    q = combine(*(dot(n, formula.POSITION) for n in _NORMALS)) - _OFFSET
    d = formula.along_face_normals(correction, _back())
    return (formula.POSITION - formula.CAPTURE_POINT) * formula.nearness(q, d) - _back()


def _articles(correction: Correction) -> Expr:
    """As printed: o = M·P, d = M₃·R in the unit box, t = min of max((−1 − o)/d, (1 − o)/d), hit = P + tR."""
    ray = _back() * -1.0
    if correction is Correction.ALIGNED_BOX:  # the form for boxes along the axes
        low, high = formula.CENTRE - formula.HALF_WIDTHS, formula.CENTRE + formula.HALF_WIDTHS
        planes = [(corner - formula.POSITION) / ray for corner in (low, high)]
    else:
        o = (combine(*(dot(n, formula.POSITION) for n in _NORMALS)) - _OFFSET) / formula.HALF_WIDTHS
        d = combine(*(dot(n, ray) for n in _NORMALS)) / formula.HALF_WIDTHS
        planes = [(o * -1.0 - 1.0) / d, (o * -1.0 + 1.0) / d]
    return formula.POSITION + ray * _least(maximum(*planes)) - formula.CAPTURE_POINT


ARTICLES = Variant("articles as printed", _articles)
WITHOUT = (
    Variant("one plane an axis, chosen by sign", _two_planes_an_axis),
    Variant("no wall nearer than 1e-12 m", _without_wall_guard),
    Variant("centre subtracted first", _centre_last, (Correction.ORIENTED_BOX,)),
)


def inputs(cases: Cases) -> dict[str, np.ndarray]:
    """What the variants read: the lookup's inputs, and what a matrix would hold in its last column."""
    normals = cases.exact_face_normals()  # the articles know no mirror
    with np.errstate(invalid="ignore"):
        offset = np.einsum("nij,nj->ni", normals, cases.centre.astype(np.float64))
    faces = {f"Face Normal {axis}": normals[:, k] for k, axis in enumerate("XYZ")}
    return cases.inputs() | faces | {"Box Offset": offset}
