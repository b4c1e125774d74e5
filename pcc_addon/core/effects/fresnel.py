"""Fresnel's curve for dielectrics, exact, as arrays and as expressions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TypeVar

import numpy as np

from ..expression import Expr, minimum, sqrt
from ..ggx import Curve

Number = TypeVar("Number", float, Expr)
_MOST_F0 = 0.99  # of an index that is not infinite
USUAL_IOR = 1.5  # what lobes are fitted for where the index varies


def f0_from_ior(ior: Number) -> Number:
    """Reflectance at normal incidence."""
    root = (ior - 1.0) / (ior + 1.0)
    return root * root


def ior_from_f0(f0: float) -> float:
    """The inverse, for f0 in [0, 1)."""
    root = np.sqrt(min(max(f0, 0.0), _MOST_F0))
    return float((1.0 + root) / (1.0 - root))


def varying_ior_from_f0(f0: Expr) -> Expr:
    """`ior_from_f0` as an expression."""
    root = sqrt(minimum(f0, _MOST_F0))
    return (1.0 + root) / (1.0 - root)


def fresnel_dielectric(cosine: np.ndarray, eta: float) -> np.ndarray:
    """Unpolarised Fresnel reflectance from outside; 1 under total internal reflection."""
    g2 = eta * eta - 1.0 + cosine * cosine
    g = np.sqrt(np.maximum(g2, 0.0))
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.where(g2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def fresnel(cosine: Expr, eta: float | Expr) -> Expr:
    """`fresnel_dielectric` as an expression."""
    g = sqrt(eta * eta - 1.0 + cosine * cosine)
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


@dataclass(frozen=True)
class Facets:
    """How much the microfacets of a lobe reflect, which decides where most of its light comes from.

    Attributes:
        label: a short name, unique for the curve.
        curve: their reflectance by the cosine of the view on them, but for a factor.
    """

    label: str
    curve: Curve


def _usual_metal(cosine: np.ndarray) -> np.ndarray:
    return _METAL_F0 + (1.0 - _METAL_F0) * schlick(cosine)


_METAL_F0 = 0.7  # between iron and silver
MIRRORS = Facets("mirrors", np.ones_like)
"""Facets that reflect as much at all angles."""
METAL = Facets("metal", _usual_metal)
"""Those of a metal of usual brightness."""


@cache
def dielectric_facets(eta: float) -> Facets:
    """Those of a dielectric with an index of refraction of 1 or more."""
    return Facets(f"IOR {eta:.6g}", lambda cosine: fresnel_dielectric(cosine, eta))
