"""Prints formulas as functions of a shading language of C's family.

A formula becomes a function of its title: first its inputs in the order of their first use, then a sampler for each
picture, then its outputs as `out` parameters. Everything but letters and digits in names becomes an underscore.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ..expression import Call, Calls, Constant, Expr, Formula, Input, Op, Operation, Sample, Section, Texel


@dataclass(frozen=True)
class Dialect:
    """What languages of this family spell differently.

    Attributes:
        vector: the type of three numbers, and what makes one of three.
        splat: a vector of one number three times, with {} for the number.
        prelude: what every printed function stands on; once a shader. Division by zero is zero, as in Blender's nodes.
        reads_pictures: whether the prelude has what reads equirectangular and flat pictures, and random numbers.
    """

    vector: str
    splat: str
    prelude: str
    reads_pictures: bool = False

    def kind(self, width: int) -> str:
        """The type of one number, or of three."""
        return self.vector if width == 3 else "float"


_PATTERNS = {
    Op.ADD: "{} + {}",
    Op.SUBTRACT: "{} - {}",
    Op.MULTIPLY: "{} * {}",
    Op.DIVIDE: "pp_divide({}, {})",
    Op.MINIMUM: "min({}, {})",
    Op.MAXIMUM: "max({}, {})",
    Op.ABSOLUTE: "abs({})",
    Op.SIGN: "sign({})",
    Op.FLOOR: "floor({})",
    Op.SQRT: "sqrt(max({}, 0.0))",
    Op.EXP2: "exp2({})",
    Op.COSINE: "cos({})",
    Op.MULTIPLY_ADD: "{} * {} + {}",
    Op.DOT: "dot({}, {})",
    Op.LENGTH: "length({})",
    Op.NORMALIZE: "pp_normalize({})",
    Op.REFLECT: "pp_reflect({}, {})",
    Op.CROSS: "cross({}, {})",
    Op.RANDOM: "pp_random({})",
    Op.COMBINE: "{vector}({}, {}, {})",
    Op.COMPONENT_X: "{}.x",
    Op.COMPONENT_Y: "{}.y",
    Op.COMPONENT_Z: "{}.z",
}


def functions(formula: Formula, dialect: Dialect) -> str:
    """The text of a formula's function, after those of the formulas that it calls; the prelude must stand before it.

    Raises:
        ValueError: it needs what the dialect's prelude has not.
    """
    return "\n".join(_Printer(part, dialect).text() for part in _called_first(formula, set()))


def identifier(name: str) -> str:
    """A name as it is in shaders."""
    return re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")


def samplers(formula: Formula) -> tuple[str, ...]:
    """The pictures that a formula and those that it calls read, in the order of its parameters."""
    inner = (name for part in formula.parts() if isinstance(part, Call) for name in samplers(part.calls.formula))
    return tuple(dict.fromkeys((*formula.pictures, *inner)))


def _called_first(formula: Formula, done: set[str]) -> Iterator[Formula]:
    if formula.title in done:
        return
    done.add(formula.title)
    for part in formula.parts():
        if isinstance(part, Call):
            yield from _called_first(part.calls.formula, done)
    yield formula


class _Printer:
    """The lines of one function; each part of the formula is one variable."""

    def __init__(self, formula: Formula, dialect: Dialect) -> None:
        self._formula, self._dialect = formula, dialect
        self._lines: list[str] = []
        self._names: dict[int, str] = {}
        self._calls: dict[int, dict[str, str]] = {}
        self._count = 0

    def text(self) -> str:
        formula, kind = self._formula, self._dialect.kind
        for name, expr in formula.outputs.items():
            self._lines.append(f"out_{identifier(name)} = {self._widened(expr, expr.width)};")
        parameters = [f"{kind(part.width)} {identifier(name)}" for name, part in formula.inputs.items()]
        parameters += [f"sampler2D {identifier(name)}" for name in samplers(formula)]
        parameters += [f"out {kind(e.width)} out_{identifier(name)}" for name, e in formula.outputs.items()]
        body = "".join(f"    {line}\n" for line in self._lines)
        return f"void {identifier(formula.title)}({', '.join(parameters)}) {{\n{body}}}\n"

    def _value(self, expr: Expr) -> str:
        """The name of the variable, or the number, that an expression is."""
        if isinstance(expr, Section):
            return self._value(expr.content)
        if isinstance(expr, Constant):
            numbers = [_number(value) for value in expr.value]
            return numbers[0] if len(numbers) == 1 else f"{self._dialect.vector}({', '.join(numbers)})"
        if isinstance(expr, Input):
            return identifier(expr.name)
        if id(expr) not in self._names:
            self._names[id(expr)] = self._computed(expr)
        return self._names[id(expr)]

    def _computed(self, expr: Expr) -> str:
        if isinstance(expr, Call):
            return self._call(expr.calls)[expr.output]
        needs_more = isinstance(expr, (Texel, Sample)) or (isinstance(expr, Operation) and expr.op is Op.RANDOM)
        if needs_more and not self._dialect.reads_pictures:
            raise ValueError(f"'{self._formula.title}' reads pictures or random numbers, which this dialect has not")
        if isinstance(expr, Texel):
            read = f"pp_flat({identifier(expr.picture)}, {self._value(expr.place)})"
            right = f"{read}.rgb" if expr.width == 3 else f"{read}.a"
        elif isinstance(expr, Sample):
            right = f"pp_equirect({identifier(expr.picture)}, {self._value(expr.direction)})"
        else:
            assert isinstance(expr, Operation)
            widest = max(part.width for part in (expr, *expr.args))
            width = 1 if expr.op is Op.COMBINE else widest
            arguments = [self._widened(part, width) for part in expr.args]
            right = _PATTERNS[expr.op].format(*arguments, vector=self._dialect.vector)
        return self._variable(self._dialect.kind(expr.width), right)

    def _widened(self, expr: Expr, width: int) -> str:
        value = self._value(expr)
        return self._dialect.splat.format(value) if width == 3 and expr.width == 1 else value

    def _call(self, calls: Calls) -> dict[str, str]:
        if id(calls) not in self._calls:
            formula = calls.formula
            arguments = [self._value(argument) for argument in calls.arguments]
            results = {name: self._variable(self._dialect.kind(e.width), None) for name, e in formula.outputs.items()}
            names = [*arguments, *(identifier(name) for name in samplers(formula)), *results.values()]
            self._lines.append(f"{identifier(formula.title)}({', '.join(names)});")
            self._calls[id(calls)] = results
        return self._calls[id(calls)]

    def _variable(self, kind: str, right: str | None) -> str:
        name = f"v{self._count}"
        self._count += 1
        self._lines.append(f"{kind} {name};" if right is None else f"{kind} {name} = {right};")
        return name


def _number(value: float) -> str:
    text = repr(float(value))
    text = text if "." in text or "e" in text else f"{text}.0"
    return f"({text})" if value < 0 else text
