"""Prints formulas as GLSL functions, for GLSL ES 3.00 and desktop GLSL 3.30 alike; how, `printing.py` says.

A picture is a `sampler2D`: equirectangular with row 0 at the bottom, wrapping around in x and clamped in y.
"""

from __future__ import annotations

from ..expression import Formula
from . import printing
from .printing import Dialect, identifier, samplers

__all__ = ["ARITHMETIC", "DIALECT", "PRELUDE", "functions", "identifier", "samplers"]

ARITHMETIC = """\
float pp_divide(float a, float b) { return b == 0.0 ? 0.0 : a / b; }
vec3 pp_divide(vec3 a, vec3 b) { return vec3(pp_divide(a.x, b.x), pp_divide(a.y, b.y), pp_divide(a.z, b.z)); }
vec3 pp_normalize(vec3 a) { return pp_divide(a, vec3(length(a))); }
vec3 pp_reflect(vec3 a, vec3 b) { vec3 n = pp_normalize(b); return a - 2.0 * n * dot(a, n); }
"""
"""What functions that read no picture stand on."""

PRELUDE = (
    ARITHMETIC
    + """\
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
)
"""What every printed function stands on; once a shader. Division by zero is zero, as in Blender's nodes.

`pp_random` is that of `hashing.py`, whose unsigned sums wrap around as GLSL's do.
"""

DIALECT = Dialect("vec3", "vec3({})", PRELUDE, reads_pictures=True)


def functions(formula: Formula) -> str:
    """The text of a formula's function, after those of the formulas that it calls; `PRELUDE` must stand before it."""
    return printing.functions(formula, DIALECT)
