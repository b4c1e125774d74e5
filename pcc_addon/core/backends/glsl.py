"""Prints formulas as GLSL functions, for GLSL ES 3.00 and desktop GLSL 3.30 alike.

A formula becomes a function of its title: first its inputs in the order of their first use, then a `sampler2D` for each
picture, then its outputs as `out` parameters. Everything but letters and digits in names becomes an underscore.
Pictures are equirectangular with row 0 at the bottom, wrapping around in x and clamped in y.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..expression import Call, Calls, Constant, Expr, Formula, Input, Op, Operation, Sample, Section, Texel

PRELUDE = """\
float pp_divide(float a, float b) { return b == 0.0 ? 0.0 : a / b; }
vec3 pp_divide(vec3 a, vec3 b) { return vec3(pp_divide(a.x, b.x), pp_divide(a.y, b.y), pp_divide(a.z, b.z)); }
vec3 pp_normalize(vec3 a) { return pp_divide(a, vec3(length(a))); }
vec3 pp_reflect(vec3 a, vec3 b) { vec3 n = pp_normalize(b); return a - 2.0 * n * dot(a, n); }
vec3 pp_equirect(sampler2D picture, vec3 d) {
    float u = 0.5 - atan(d.y, d.x) / 6.283185307179586;
    float v = 0.5 + atan(d.z, length(d.xy)) / 3.141592653589793;
    return textureLod(picture, vec2(u, v), 0.0).rgb;
}
vec4 pp_flat(sampler2D picture, vec3 place) {
    bool inside = all(greaterThanEqual(place.xy, vec2(0.0))) && all(lessThanEqual(place.xy, vec2(1.0)));
    return inside ? textureLod(picture, place.xy, 0.0) : vec4(0.0);
}
uint pp_rotated(uint x, int k) { return (x << k) | (x >> (32 - k)); }
uint pp_final(uint a, uint b, uint c) {
    c = (c ^ b) - pp_rotated(b, 14); a = (a ^ c) - pp_rotated(c, 11); b = (b ^ a) - pp_rotated(a, 25);
    c = (c ^ b) - pp_rotated(b, 16); a = (a ^ c) - pp_rotated(c, 4); b = (b ^ a) - pp_rotated(a, 14);
    return (c ^ b) - pp_rotated(b, 24);
}
float pp_share(uint x) { return float(x) / 4294967295.0; }
float pp_random(uvec3 k, float salt) {
    uint a = 3735928588u + k.x, b = 3735928588u + k.y, c = 3735928588u + k.z;
    a = (a - c) ^ pp_rotated(c, 4); c += b; b = (b - a) ^ pp_rotated(a, 6); a += c;
    c = (c - b) ^ pp_rotated(b, 8); b += a; a = (a - c) ^ pp_rotated(c, 16); c += b;
    b = (b - a) ^ pp_rotated(a, 19); a += c; c = (c - b) ^ pp_rotated(b, 4); b += a;
    return pp_share(pp_final(a + floatBitsToUint(salt), b, c));
}
vec3 pp_random(vec3 key) {
    uvec3 k = floatBitsToUint(key);
    float first = pp_share(pp_final(3735928584u + k.x, 3735928584u + k.y, 3735928584u + k.z));
    return vec3(first, pp_random(k, 1.0), pp_random(k, 2.0));
}
"""
"""What every printed function stands on; once a shader. Division by zero is zero, as in Blender's nodes.

`pp_random` is that of `hashing.py`, whose unsigned sums wrap around as GLSL's do.
"""

_TYPES = {1: "float", 3: "vec3"}
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
    Op.COMBINE: "vec3({}, {}, {})",
    Op.COMPONENT_X: "{}.x",
    Op.COMPONENT_Y: "{}.y",
    Op.COMPONENT_Z: "{}.z",
}


def functions(formula: Formula) -> str:
    """The text of a formula's function, after those of the formulas that it calls; `PRELUDE` must stand before it."""
    return "\n".join(_Printer(part).text() for part in _called_first(formula, set()))


def identifier(name: str) -> str:
    """A name as it is in GLSL."""
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

    def __init__(self, formula: Formula) -> None:
        self._formula = formula
        self._lines: list[str] = []
        self._names: dict[int, str] = {}
        self._calls: dict[int, dict[str, str]] = {}
        self._count = 0

    def text(self) -> str:
        formula = self._formula
        for name, expr in formula.outputs.items():
            self._lines.append(f"out_{identifier(name)} = {self._widened(expr, expr.width)};")
        parameters = [f"{_TYPES[part.width]} {identifier(name)}" for name, part in formula.inputs.items()]
        parameters += [f"sampler2D {identifier(name)}" for name in samplers(formula)]
        parameters += [f"out {_TYPES[e.width]} out_{identifier(name)}" for name, e in formula.outputs.items()]
        body = "".join(f"    {line}\n" for line in self._lines)
        return f"void {identifier(formula.title)}({', '.join(parameters)}) {{\n{body}}}\n"

    def _value(self, expr: Expr) -> str:
        """The name of the variable, or the number, that an expression is."""
        if isinstance(expr, Section):
            return self._value(expr.content)
        if isinstance(expr, Constant):
            numbers = [_number(value) for value in expr.value]
            return numbers[0] if len(numbers) == 1 else f"vec3({', '.join(numbers)})"
        if isinstance(expr, Input):
            return identifier(expr.name)
        if id(expr) not in self._names:
            self._names[id(expr)] = self._computed(expr)
        return self._names[id(expr)]

    def _computed(self, expr: Expr) -> str:
        if isinstance(expr, Call):
            return self._call(expr.calls)[expr.output]
        if isinstance(expr, Texel):
            read = f"pp_flat({identifier(expr.picture)}, {self._value(expr.place)})"
            right = f"{read}.rgb" if expr.width == 3 else f"{read}.a"
        elif isinstance(expr, Sample):
            right = f"pp_equirect({identifier(expr.picture)}, {self._value(expr.direction)})"
        else:
            assert isinstance(expr, Operation)
            widest = max(part.width for part in (expr, *expr.args))
            width = 1 if expr.op is Op.COMBINE else widest
            right = _PATTERNS[expr.op].format(*(self._widened(part, width) for part in expr.args))
        return self._variable(_TYPES[expr.width], right)

    def _widened(self, expr: Expr, width: int) -> str:
        value = self._value(expr)
        return f"vec3({value})" if width == 3 and expr.width == 1 else value

    def _call(self, calls: Calls) -> dict[str, str]:
        if id(calls) not in self._calls:
            formula = calls.formula
            arguments = [self._value(argument) for argument in calls.arguments]
            results = {name: self._variable(_TYPES[e.width], None) for name, e in formula.outputs.items()}
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
