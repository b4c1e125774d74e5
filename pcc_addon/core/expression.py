"""Formulas as values: written once with Python operators, read by an evaluator or by an emitter.

An expression is a scalar (width 1) or a vector (width 3). Where a scalar meets a vector it stands for
all three components. The operations are those that Blender's Math and Vector Math nodes offer, with their
meaning; in particular x / 0 is 0. A `Sample` reads a picture of all directions, a `Texel` a flat one; a `Call` applies
another formula.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, auto
from functools import cached_property
from typing import TYPE_CHECKING


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
    FLOOR = auto()
    SQRT = auto()
    EXP2 = auto()  # 2 to the power of the argument
    COSINE = auto()  # of radians
    MULTIPLY_ADD = auto()  # a * b + c
    DOT = auto()  # two vectors to a scalar
    LENGTH = auto()  # a vector to a scalar
    CROSS = auto()  # two vectors to a vector
    RANDOM = auto()  # a vector to three numbers of 0 … 1 that only equal bits share: Blender's White Noise in 3D
    NORMALIZE = auto()  # the zero vector stays zero
    REFLECT = auto()  # a − 2 (a · n) n with n = b normalised
    COMBINE = auto()  # three scalars to a vector
    COMPONENT_X = auto()  # a vector to a scalar
    COMPONENT_Y = auto()
    COMPONENT_Z = auto()


_TO_SCALAR = {Op.DOT, Op.LENGTH, Op.COMPONENT_X, Op.COMPONENT_Y, Op.COMPONENT_Z}


class Expr:
    """Base of all expressions; `width` is 1 or 3."""

    if TYPE_CHECKING:

        @property
        def width(self) -> int: ...

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
        return 3 if self.op is Op.COMBINE else max(argument.width for argument in self.args)


@dataclass(frozen=True, eq=False)
class Sample(Expr):
    """The radiance of an equirectangular picture along a direction in its axes, of any length but 0."""

    picture: str
    direction: Expr
    width: int = 3


@dataclass(frozen=True, eq=False)
class Texel(Expr):
    """The colour (width 3) or the alpha (width 1) of a flat picture at (u, v, anything); 0 outside 0 … 1.

    Colours are not multiplied by alpha.
    """

    picture: str
    place: Expr
    width: int


@dataclass(frozen=True, eq=False)
class Section(Expr):
    """An expression under a heading, for those who read the formula as nodes or text; its value is the same."""

    title: str
    content: Expr

    @property
    def width(self) -> int:
        return self.content.width


@dataclass(frozen=True, eq=False)
class Formula:
    """Named expressions of the same inputs: a node group, or a function.

    Attributes:
        title: its name, which differs from that of every other formula.
        outputs: expressions by name.
    """

    title: str
    outputs: Mapping[str, Expr]

    @cached_property
    def inputs(self) -> dict[str, Input]:
        """The inputs that its outputs read, by name, in the order of their first use; those of called ones included."""
        found: dict[str, Input] = {}
        for part in self.parts():
            if isinstance(part, Input):
                found.setdefault(part.name, part)
        return found

    @cached_property
    def pictures(self) -> tuple[str, ...]:
        """The names of the pictures that it samples itself."""
        return tuple(dict.fromkeys(part.picture for part in self.parts() if isinstance(part, (Sample, Texel))))

    @property
    def called(self) -> tuple[Formula, ...]:
        """The formulas that it calls itself, each once."""
        calls = (part.calls.formula for part in self.parts() if isinstance(part, Call))
        return tuple({formula.title: formula for formula in calls}.values())

    def parts(self) -> Iterator[Expr]:
        """Its expressions and all that they are made of, each once, arguments first; not the insides of calls."""
        seen: set[int] = set()
        for expr in self.outputs.values():
            yield from _parts(expr, seen)

    def at(self, known: Mapping[str, Operand]) -> Calls:
        """`__call__` with those of some values by name that are inputs of it."""
        return self(**{name.replace(" ", "_"): value for name, value in known.items() if name in self.inputs})

    def __call__(self, **arguments: Operand) -> Calls:
        """Its outputs where inputs are given other expressions; underscores stand for spaces.

        Inputs that are not given are passed on under their own names.

        Raises:
            TypeError: it has no such input.
        """
        given = {name.replace("_", " "): lift(value) for name, value in arguments.items()}
        unknown = given.keys() - self.inputs.keys()
        if unknown:
            raise TypeError(f"formula '{self.title}' has no input {sorted(unknown)}")
        return Calls(self, tuple(given.get(name, part) for name, part in self.inputs.items()))


@dataclass(frozen=True, eq=False)
class Calls:
    """A formula applied to arguments, in the order of its inputs; one call however many outputs are taken."""

    formula: Formula
    arguments: tuple[Expr, ...]

    def __getitem__(self, output: str) -> Call:
        return Call(self, output, self.formula.outputs[output].width)


@dataclass(frozen=True, eq=False)
class Call(Expr):
    """One output of a formula applied to arguments."""

    calls: Calls
    output: str
    width: int


def arguments_of(expr: Expr) -> tuple[Expr, ...]:
    """The expressions that one is made of directly."""
    if isinstance(expr, Operation):
        return expr.args
    if isinstance(expr, Sample):
        return (expr.direction,)
    if isinstance(expr, Texel):
        return (expr.place,)
    if isinstance(expr, Section):
        return (expr.content,)
    return expr.calls.arguments if isinstance(expr, Call) else ()


def _parts(expr: Expr, seen: set[int]) -> Iterator[Expr]:
    if id(expr) in seen:
        return
    seen.add(id(expr))
    for argument in arguments_of(expr):
        yield from _parts(argument, seen)
    yield expr


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


def floor(a: Operand) -> Expr:
    """The largest whole number that is not above it, by component."""
    return operation(Op.FLOOR, a)


def sqrt(a: Operand) -> Expr:
    """Square root by component; 0 for a negative one."""
    return operation(Op.SQRT, a)


def exp2(a: Operand) -> Expr:
    """2 to the power of each component."""
    return operation(Op.EXP2, a)


def cosine(a: Operand) -> Expr:
    """The cosine of each component, radians."""
    return operation(Op.COSINE, a)


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


def cross(a: Operand, b: Operand) -> Expr:
    return operation(Op.CROSS, a, b)


def random(key: Operand) -> Expr:
    """Three numbers of 0 … 1, the same wherever the key's bits are; −0 and 0 are different keys."""
    return operation(Op.RANDOM, key)


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
