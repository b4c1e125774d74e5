"""Runs an expression on NumPy arrays, in the precision asked for, with the meaning that shader nodes give it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from .. import equirect, flat
from ..expression import Call, Calls, Constant, Expr, Input, Op, Operation, Sample, Section, Texel
from .hashing import random


def _divide(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    a, b = np.broadcast_arrays(a, b)
    return np.divide(a, b, out=np.zeros_like(a), where=b != 0)


def _length(a: np.ndarray) -> np.ndarray:
    return np.sqrt((a * a).sum(-1, keepdims=True))


def _normalize(a: np.ndarray) -> np.ndarray:
    return _divide(a, _length(a))


def _reflect(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    normal = _normalize(b)
    return a - 2 * normal * (a * normal).sum(-1, keepdims=True)


_RULES: dict[Op, Callable[..., np.ndarray]] = {
    Op.ADD: np.add,
    Op.SUBTRACT: np.subtract,
    Op.MULTIPLY: np.multiply,
    Op.DIVIDE: _divide,
    Op.MINIMUM: np.minimum,
    Op.MAXIMUM: np.maximum,
    Op.ABSOLUTE: np.abs,
    Op.SIGN: np.sign,
    Op.FLOOR: np.floor,
    Op.SQRT: lambda a: np.sqrt(np.maximum(a, 0)),
    Op.EXP2: np.exp2,
    Op.COSINE: np.cos,
    Op.MULTIPLY_ADD: lambda a, b, c: a * b + c,
    Op.DOT: lambda a, b: (a * b).sum(-1, keepdims=True),
    Op.LENGTH: _length,
    Op.NORMALIZE: _normalize,
    Op.REFLECT: _reflect,
    Op.CROSS: np.cross,
    Op.RANDOM: random,
    Op.COMBINE: lambda x, y, z: np.concatenate(np.broadcast_arrays(x, y, z), -1),
    Op.COMPONENT_X: lambda a: a[..., 0:1],
    Op.COMPONENT_Y: lambda a: a[..., 1:2],
    Op.COMPONENT_Z: lambda a: a[..., 2:3],
}


def evaluate(
    outputs: Mapping[str, Expr],
    inputs: Mapping[str, np.ndarray],
    dtype: type = np.float32,
    pictures: Mapping[str, np.ndarray] | None = None,
) -> dict[str, np.ndarray]:
    """Evaluate `outputs` at `inputs`.

    Args:
        outputs: expressions by name.
        inputs: an array by input name; vectors have shape (..., 3), scalars any shape (...) that broadcasts
            with the vectors' leading shape.
        dtype: np.float32 (as shaders compute) or np.float64; every step is rounded to it.
        pictures: those that are read, by name, row 0 at the bottom, bilinearly: (h, 2h, 3) equirectangular ones for
            `Sample`, (h, w, 4) with alpha for `Texel`.

    Returns:
        Arrays by output name: (..., 3) for vectors, (...) for scalars, in `dtype`.

    Raises:
        KeyError: an input or a picture that an expression needs is missing.
    """
    given: dict[str, np.ndarray] = {}

    def read(part: Input) -> np.ndarray:
        if part.name not in given:
            array: np.ndarray = np.asarray(inputs[part.name], dtype)
            given[part.name] = array if part.width == 3 else array[..., None]
        return given[part.name]

    run = _Run(read, pictures or {}, dtype)
    with np.errstate(all="ignore"):
        results = {name: run.value(expr) for name, expr in outputs.items()}
    return {name: r if outputs[name].width == 3 else r[..., 0] for name, r in results.items()}


class _Run:
    """One evaluation of a formula; computes each part once."""

    def __init__(self, read: Callable[[Input], np.ndarray], pictures: Mapping[str, np.ndarray], dtype: type) -> None:
        self._read, self._pictures, self._dtype = read, pictures, dtype
        self._known: dict[int, np.ndarray] = {}
        self._inside: dict[int, _Run] = {}

    def value(self, expr: Expr) -> np.ndarray:
        if id(expr) not in self._known:
            self._known[id(expr)] = self._compute(expr)
        return self._known[id(expr)]

    def _compute(self, expr: Expr) -> np.ndarray:
        if isinstance(expr, Constant):
            return np.asarray(expr.value, self._dtype)
        if isinstance(expr, Input):
            return self._read(expr)
        if isinstance(expr, Section):
            return self.value(expr.content)
        if isinstance(expr, Sample):
            direction = self.value(expr.direction)
            return equirect.lookup(self._pictures[expr.picture], direction).astype(self._dtype)
        if isinstance(expr, Texel):
            texel = flat.lookup(self._pictures[expr.picture], self.value(expr.place))
            return (texel[..., :3] if expr.width == 3 else texel[..., 3:]).astype(self._dtype)
        if isinstance(expr, Call):
            return self._call(expr.calls).value(expr.calls.formula.outputs[expr.output])
        assert isinstance(expr, Operation)
        return _RULES[expr.op](*(self.value(argument) for argument in expr.args))

    def _call(self, calls: Calls) -> _Run:
        if id(calls) not in self._inside:
            given = dict(zip(calls.formula.inputs, calls.arguments, strict=True))
            self._inside[id(calls)] = _Run(lambda part: self.value(given[part.name]), self._pictures, self._dtype)
        return self._inside[id(calls)]
