"""Runs an expression on NumPy arrays, in the precision asked for, with the meaning that shader nodes give it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..expression import Constant, Expr, Input, Op, Operation


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


_RULES = {
    Op.ADD: np.add,
    Op.SUBTRACT: np.subtract,
    Op.MULTIPLY: np.multiply,
    Op.DIVIDE: _divide,
    Op.MINIMUM: np.minimum,
    Op.MAXIMUM: np.maximum,
    Op.ABSOLUTE: np.abs,
    Op.SIGN: np.sign,
    Op.SQRT: lambda a: np.sqrt(np.maximum(a, 0)),
    Op.MULTIPLY_ADD: lambda a, b, c: a * b + c,
    Op.DOT: lambda a, b: (a * b).sum(-1, keepdims=True),
    Op.LENGTH: _length,
    Op.NORMALIZE: _normalize,
    Op.REFLECT: _reflect,
    Op.COMBINE: lambda x, y, z: np.concatenate(np.broadcast_arrays(x, y, z), -1),
    Op.COMPONENT_X: lambda a: a[..., 0:1],
    Op.COMPONENT_Y: lambda a: a[..., 1:2],
    Op.COMPONENT_Z: lambda a: a[..., 2:3],
}


def evaluate(
    outputs: Mapping[str, Expr], inputs: Mapping[str, np.ndarray], dtype: type = np.float32
) -> dict[str, np.ndarray]:
    """Evaluate `outputs` at `inputs`.

    Args:
        outputs: expressions by name.
        inputs: an array by input name; vectors have shape (..., 3), scalars any shape (...) that broadcasts
            with the vectors' leading shape.
        dtype: np.float32 (as shaders compute) or np.float64; every step is rounded to it.

    Returns:
        Arrays by output name: (..., 3) for vectors, (...) for scalars, in `dtype`.

    Raises:
        KeyError: an input that an expression needs is missing.
    """
    known: dict[int, np.ndarray] = {}

    def value(expr: Expr) -> np.ndarray:
        if id(expr) not in known:
            known[id(expr)] = compute(expr)
        return known[id(expr)]

    def compute(expr: Expr) -> np.ndarray:
        if isinstance(expr, Constant):
            return np.asarray(expr.value, dtype)
        if isinstance(expr, Input):
            array = np.asarray(inputs[expr.name], dtype)
            return array if expr.width == 3 else array[..., None]
        assert isinstance(expr, Operation)
        return _RULES[expr.op](*(value(argument) for argument in expr.args))

    with np.errstate(all="ignore"):
        results = {name: value(expr) for name, expr in outputs.items()}
    return {name: r if outputs[name].width == 3 else r[..., 0] for name, r in results.items()}
