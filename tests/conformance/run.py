"""Runs formulas on cases through the node groups that Blender makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from operator import add
from typing import Any

import numpy as np

from pcc_addon.core.effects.records import Correction
from pcc_addon.core.expression import Expr, absolute, dot, normalize, scalar, vector
from pcc_addon.core.probe import Engine
from tests.shader_harness import evaluate_expressions

from . import variants
from .cases import Cases
from .digits import float64
from .families import FAMILIES
from .rounding import ROUNDOFF
from .subjects import Subject
from .verdict import Verdict, side_by_side

EXPECTED_ROUNDING = 1e-7  # of a direction (radians), or of 1: of the expected results that EEVEE is given
_MAGNIFIED = 4096.0  # half floats then resolve differences of 1e-10, and still hold the largest


def in_cycles(outputs: Mapping[str, Expr], inputs: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """float32 of what Cycles computes, by output; NaN in all components where one is not finite."""
    found = evaluate_expressions({**outputs, **_finite(outputs)}, {**inputs, **_ZEROS})
    sure = found.pop("Is Finite") == 1.0
    return {name: np.where(_beside(sure, v), v, np.nan) for name, v in found.items()}


def off_in_eevee(
    outputs: Mapping[str, Expr],
    inputs: Mapping[str, np.ndarray],
    expected: Mapping[str, np.ndarray],
) -> dict[str, np.ndarray]:
    """How far EEVEE's results end from the `expected` ones, (n,) or (n, 3); NaN where they are not finite.

    The shader subtracts, because EEVEE's pictures are half floats.
    """
    sure = evaluate_expressions(_finite(outputs), {**inputs, **_ZEROS}, Engine.EEVEE)["Is Finite"] == 1.0
    found = {}
    for name, e in outputs.items():
        given = scalar("Expected") if e.width == 1 else vector("Expected")
        magnified = {"Off": absolute(e - given) * _MAGNIFIED}
        off = evaluate_expressions(magnified, {**inputs, "Expected": expected[name]}, Engine.EEVEE)["Off"] / _MAGNIFIED
        found[name] = np.where(_beside(sure, off), off, np.nan)
    return found


def judged_in_eevee(subject: Subject, cases: Any) -> Verdict:
    """How a subject fares in EEVEE, which is given the exact results in float32: that counts as a part of the bound."""
    truth, bounds = subject.truth(cases, float64), subject.bound(cases)
    outputs = {name: normalize(e) if subject.directions else e for name, e in subject.formula.outputs.items()}
    errors, allowed = [], []
    for name, off in off_in_eevee(outputs, cases.inputs(), truth).items():
        given = EXPECTED_ROUNDING if subject.directions else ROUNDOFF * np.abs(truth[name]) + _HALF_FLOATS
        if off.ndim > 1 and not subject.directions:
            given = given + _MIXED * off.max(-1, keepdims=True)
        errors.append(np.linalg.norm(off, axis=-1) if subject.directions else off)
        allowed.append(bounds[name] + given)
    error, bound = side_by_side(errors), side_by_side(allowed)
    return Verdict(error, bound, np.isfinite(error).all(-1))


_HALF_FLOATS = 2.0**-24 / _MAGNIFIED  # their smallest step
_MIXED = 2.0**-10  # of the brightest channel: what EEVEE's film, of brightness and hues, lets get into others

MOST_IN_EEVEE = 13  # inputs, the expected result not counted

_ZEROS = {"Zero": np.float32(0.0)}


def _finite(outputs: Mapping[str, Expr]) -> dict[str, Expr]:
    """1 where all are; by an input, because constants would be folded away."""
    sums = (e if e.width == 1 else dot(e, (1.0, 1.0, 1.0)) for e in outputs.values())
    return {"Is Finite": reduce(add, (total * scalar("Zero") for total in sums)) + 1.0}


def _beside(flags: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(n,) flags in the shape of (n,) or (n, 3) values."""
    return flags.reshape(-1, *[1] * (values.ndim - 1))


def directions(cases: Cases, direction: Expr) -> np.ndarray:
    """(n, 3) float32 of what Cycles computes; NaN where a component is not finite."""
    return in_cycles({"Direction": direction}, variants.inputs(cases))["Direction"]


def errors_in_eevee(cases: Cases, direction: Expr, expected: np.ndarray) -> np.ndarray:
    """(n,) how far EEVEE's unit directions end from `expected` (n, 3), of length 1 too; NaN where one is not finite."""
    outputs = {"Direction": normalize(direction)}
    off = off_in_eevee(outputs, variants.inputs(cases), {"Direction": expected})["Direction"]
    return np.linalg.norm(off, axis=-1)


def values(cases: Cases, outputs: Mapping[str, Expr], extra: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What Cycles computes for several outputs, given the cases' inputs and `extra` ones."""
    return evaluate_expressions(outputs, variants.inputs(cases) | dict(extra))


def together(count: int, correction: Correction, finite: bool = True) -> tuple[Cases, dict[str, slice]]:
    """`count` cases of every family that has some for a correction, in one; and where each family's are."""
    chosen = [f for f in FAMILIES if correction in f.corrections and f.finite is finite]
    joined = Cases.joined([f.cases(count, correction) for f in chosen])
    return joined, {f.name: slice(k * count, (k + 1) * count) for k, f in enumerate(chosen)}
