"""The dialect of HLSL, for functions that read no picture; how it is printed, `printing.py` says."""

from __future__ import annotations

from .printing import Dialect

DIALECT = Dialect(
    vector="float3",
    splat="({}).xxx",
    prelude="""\
float pp_divide(float a, float b) { return b == 0.0 ? 0.0 : a / b; }
float3 pp_divide(float3 a, float3 b) {
    return float3(pp_divide(a.x, b.x), pp_divide(a.y, b.y), pp_divide(a.z, b.z));
}
float3 pp_normalize(float3 a) { return pp_divide(a, length(a).xxx); }
float3 pp_reflect(float3 a, float3 b) { float3 n = pp_normalize(b); return a - 2.0 * n * dot(a, n); }
""",
)
