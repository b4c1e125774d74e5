"""Perturbed normals: one that would mirror the view into the surface is bent until the reflection just leaves it."""

from __future__ import annotations

from ..expression import Expr, Formula, clamp, dot, minimum, mix, multiply_add, normalize, sign, sqrt, vector
from .lookup import INCOMING, NORMAL

TRUE_NORMAL = vector("True Normal")  # of the face, unit, on the side of the eye
_LOWEST = 0.01  # sine of the least angle above the face that a reflection may have, where the view has a greater one


def _bent() -> Expr:
    """The normal in the plane of both whose reflection rises by t over the face, or the given one if that rises more.

    With I the way to the eye, x along the given normal's lean and z along the true one, R_z = t means
    2 (N_x I_x + N_z I_z) N_z − I_z = t; squared, a quadratic in u = N_z²: 4 a u² − 2 b u + c = 0.
    """
    i_z = dot(INCOMING, TRUE_NORMAL)
    t = minimum(i_z * 0.9, _LOWEST)
    reflected = 2.0 * dot(NORMAL, INCOMING) * dot(NORMAL, TRUE_NORMAL) - i_z
    lean = normalize(NORMAL - TRUE_NORMAL * dot(NORMAL, TRUE_NORMAL))
    i_x = dot(INCOMING, lean)
    a = multiply_add(i_x, i_x, i_z * i_z)
    b = 2.0 * multiply_add(i_z, t, a)
    c = (t + i_z) * (t + i_z)
    root = sqrt(b * b - 4.0 * a * c) * (minimum(sign(i_x), 0.0) * -2.0 - 1.0)
    u = clamp(0.25 * (b + root) / a)
    bent = lean * sqrt(1.0 - u) + TRUE_NORMAL * sqrt(u)
    leaves = minimum(sign(reflected - t) + 1.0, 1.0)
    return mix(bent, NORMAL, leaves)


VALID_NORMAL = Formula("Valid Normal", {"Normal": _bent()})
"""As Cycles bends normals for specular lobes. The given normal and the way to the eye are unit vectors."""
