"""Fresnel's curve for dielectrics, exact, as arrays and as expressions."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..expression import Expr, Operand, lift, minimum, sqrt
from .lobe import Curve


def f0_from_ior(ior: float) -> float:
    """Reflectance at normal incidence."""
    return ((ior - 1.0) / (ior + 1.0)) ** 2


def ior_from_f0(f0: float) -> float:
    """The inverse, for f0 in [0, 1)."""
    root = np.sqrt(min(max(f0, 0.0), 0.99))
    return float((1.0 + root) / (1.0 - root))


def fresnel_dielectric(cosine: np.ndarray, eta: float) -> np.ndarray:
    """Unpolarised Fresnel reflectance from outside; 1 under total internal reflection."""
    g2 = eta * eta - 1.0 + cosine * cosine
    g = np.sqrt(np.maximum(g2, 0.0))
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.where(g2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def fresnel(cosine: Expr, eta: Operand) -> Expr:
    """`fresnel_dielectric` as an expression."""
    g = sqrt(lift(eta) * eta - 1.0 + cosine * cosine)
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return minimum(0.5 * a * a * (1.0 + b * b), 1.0)


@cache
def curve_position(eta: float) -> Curve:
    """Where the Fresnel curve of an index stands between its value at normal incidence (0) and 1 (1)."""
    f0 = f0_from_ior(eta)
    return lambda cosine: (fresnel_dielectric(cosine, eta) - f0) / (1.0 - f0)


def schlick(cosine: np.ndarray) -> np.ndarray:
    """Schlick's curve from 0 at normal incidence to 1 along the surface (Schlick 1994)."""
    return (1.0 - cosine) ** 5


def dip(cosine: np.ndarray) -> np.ndarray:
    """What an F82 tint takes away, but for a factor (Hoffman 2023)."""
    return cosine * (1.0 - cosine) ** 6
