"""Runs a lookup on cases through the node group that Blender makes of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields

import numpy as np

from pcc_addon.core.effects.records import Correction
from pcc_addon.core.expression import Expr, absolute, dot, normalize, vector
from pcc_addon.core.probe import Engine
from tests.shader_harness import evaluate_expressions

from . import variants
from .cases import Cases
from .families import FAMILIES

EXPECTED_ROUNDING = 1e-7  # radians: of the expected directions that EEVEE is given
_MAGNIFIED = 4096.0  # half floats then resolve differences of 1e-10, and still hold the largest


def directions(cases: Cases, direction: Expr) -> np.ndarray:
    """(n, 3) float32 of what Cycles computes; NaN where a component is not finite."""
    zero = vector("Zero")  # by an input: constants would be folded away
    outputs = {"Direction": direction, "Is Finite": dot(direction, zero) + 1.0}
    found = _run(outputs, cases, {"Zero": np.zeros(3)}, Engine.CYCLES)
    return np.where(found["Is Finite"][:, None] == 1.0, found["Direction"], np.nan)


def errors_in_eevee(cases: Cases, direction: Expr, expected: np.ndarray) -> np.ndarray:
    """(n,) how far EEVEE's unit directions end from `expected` (n, 3), of length 1 too; NaN where one is not finite.

    The shader subtracts, because EEVEE's pictures are half floats.
    """
    offset = absolute(normalize(direction) - vector("Expected")) * _MAGNIFIED
    outputs = {"Offset": offset, "Is Finite": dot(direction, vector("Zero")) + 1.0}
    found = _run(outputs, cases, {"Expected": expected, "Zero": np.zeros(3)}, Engine.EEVEE)
    return np.where(found["Is Finite"] == 1.0, np.linalg.norm(found["Offset"], axis=-1) / _MAGNIFIED, np.nan)


def values(cases: Cases, outputs: Mapping[str, Expr], extra: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What Cycles computes for several outputs, given the cases' inputs and `extra` ones."""
    return _run(outputs, cases, extra, Engine.CYCLES)


def _run(
    outputs: Mapping[str, Expr], cases: Cases, extra: Mapping[str, np.ndarray], engine: Engine
) -> dict[str, np.ndarray]:
    return evaluate_expressions(outputs, variants.inputs(cases) | dict(extra), engine)


def together(count: int, correction: Correction, finite: bool = True) -> tuple[Cases, dict[str, slice]]:
    """`count` cases of every family that has some for a correction, in one; and where each family's are."""
    chosen = [f for f in FAMILIES if correction in f.corrections and f.finite is finite]
    parts = [f.cases(count, correction) for f in chosen]
    arrays = [field.name for field in fields(Cases) if field.name != "correction"]
    joined = Cases(correction, **{name: np.concatenate([getattr(p, name) for p in parts]) for name in arrays})
    return joined, {f.name: slice(k * count, (k + 1) * count) for k, f in enumerate(chosen)}
