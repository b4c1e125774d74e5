"""Formulas as values: written once with Python operators, read by an evaluator or by an emitter.

An expression is a scalar (width 1) or a vector (width 3). Where a scalar meets a vector it stands for
all three components. The operations are those that Blender's Math and Vector Math nodes offer, with their
meaning; in particular x / 0 is 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from functools import cached_property


class Op(Enum):
    """What an `Operation` does to its arguments; component by component unless it says otherwise."""

    ADD = auto()
    SUBTRACT = auto()
    MULTIPLY = auto()
    DIVIDE = auto()
    MINIMUM = auto()
    MAXIMUM = auto()
    ABSOLUTE = auto()
    SIGN = auto()
    SQRT = auto()  # scalar
    MULTIPLY_ADD = auto()  # a * b + c
    DOT = auto()  # two vectors to a scalar
    LENGTH = auto()  # a vector to a scalar
    NORMALIZE = auto()  # the zero vector stays zero
    REFLECT = auto()  # a − 2 (a · n) n with n = b normalised
    COMBINE = auto()  # three scalars to a vector
    COMPONENT_X = auto()  # a vector to a scalar
    COMPONENT_Y = auto()
    COMPONENT_Z = auto()


_TO_SCALAR = {Op.DOT, Op.LENGTH, Op.COMPONENT_X, Op.COMPONENT_Y, Op.COMPONENT_Z}
_TO_VECTOR = {Op.COMBINE, Op.NORMALIZE, Op.REFLECT}


class Expr:
    """Base of `Constant`, `Input` and `Operation`; `width` is 1 or 3."""

    width: int

    def __add__(self, other: Operand) -> Expr:
        return operation(Op.ADD, self, other)

    def __radd__(self, other: Operand) -> Expr:
        return operation(Op.ADD, other, self)

    def __sub__(self, other: Operand) -> Expr:
        return operation(Op.SUBTRACT, self, other)

    def __rsub__(self, other: Operand) -> Expr:
        return operation(Op.SUBTRACT, other, self)

    def __mul__(self, other: Operand) -> Expr:
        return operation(Op.MULTIPLY, self, other)

    def __rmul__(self, other: Operand) -> Expr:
        return operation(Op.MULTIPLY, other, self)

    def __truediv__(self, other: Operand) -> Expr:
        return operation(Op.DIVIDE, self, other)

    def __rtruediv__(self, other: Operand) -> Expr:
        return operation(Op.DIVIDE, other, self)

    @property
    def x(self) -> Expr:
        return operation(Op.COMPONENT_X, self)

    @property
    def y(self) -> Expr:
        return operation(Op.COMPONENT_Y, self)

    @property
    def z(self) -> Expr:
        return operation(Op.COMPONENT_Z, self)


@dataclass(frozen=True, eq=False)
class Constant(Expr):
    """A number or three numbers, known when the formula is written."""

    value: tuple[float, ...]

    @property
    def width(self) -> int:
        return len(self.value)


@dataclass(frozen=True, eq=False)
class Input(Expr):
    """A value that arrives from outside under a name."""

    name: str
    width: int


@dataclass(frozen=True, eq=False)
class Operation(Expr):
    """An `Op` applied to arguments."""

    op: Op
    args: tuple[Expr, ...]

    @cached_property
    def width(self) -> int:
        if self.op in _TO_SCALAR:
            return 1
        if self.op in _TO_VECTOR:
            return 3
        return max(argument.width for argument in self.args)


Operand = Expr | float | tuple


def scalar(name: str) -> Input:
    """A named input of width 1."""
    return Input(name, 1)


def vector(name: str) -> Input:
    """A named input of width 3."""
    return Input(name, 3)


def lift(value: Operand) -> Expr:
    """The expression for `value`: itself, or a `Constant` of a number or of a tuple of three numbers."""
    if isinstance(value, Expr):
        return value
    if isinstance(value, tuple):
        return Constant(tuple(float(v) for v in value))
    return Constant((float(value),))


def operation(op: Op, *args: Operand) -> Operation:
    """`op` applied to `args`, numbers lifted to constants."""
    return Operation(op, tuple(lift(argument) for argument in args))


def minimum(a: Operand, b: Operand) -> Expr:
    return operation(Op.MINIMUM, a, b)


def maximum(a: Operand, b: Operand) -> Expr:
    return operation(Op.MAXIMUM, a, b)


def absolute(a: Operand) -> Expr:
    return operation(Op.ABSOLUTE, a)


def sign(a: Operand) -> Expr:
    """−1, 0 or 1 by component."""
    return operation(Op.SIGN, a)


def sqrt(a: Operand) -> Expr:
    """Square root of a scalar; 0 for a negative one."""
    return operation(Op.SQRT, a)


def multiply_add(a: Operand, b: Operand, c: Operand) -> Expr:
    """a · b + c."""
    return operation(Op.MULTIPLY_ADD, a, b, c)


def dot(a: Operand, b: Operand) -> Expr:
    return operation(Op.DOT, a, b)


def length(a: Operand) -> Expr:
    return operation(Op.LENGTH, a)


def reflect(a: Operand, normal: Operand) -> Expr:
    """The mirror image of direction `a` in the plane of a normal of any length: it ends on the plane's other side."""
    return operation(Op.REFLECT, a, normal)


def normalize(a: Operand) -> Expr:
    return operation(Op.NORMALIZE, a)


def combine(x: Operand, y: Operand, z: Operand) -> Expr:
    return operation(Op.COMBINE, x, y, z)


def clamp(a: Operand, low: Operand = 0.0, high: Operand = 1.0) -> Expr:
    return minimum(maximum(a, low), high)


def greatest(v: Expr) -> Expr:
    """The largest component of a vector."""
    return maximum(maximum(v.x, v.y), v.z)


def mix(a: Operand, b: Operand, weight: Operand) -> Expr:
    """a where weight is 0, b where it is 1."""
    return multiply_add(lift(b) - a, weight, a)
