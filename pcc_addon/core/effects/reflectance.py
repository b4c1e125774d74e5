"""How much a Principled surface reflects: the split-sum Fresnel term, and what it leaves to the diffuse part.

Follows the layering of Blender's Principled BSDF: a metallic lobe (F82 tint) mixed by Metallic with a
dielectric lobe (exact Fresnel curve scaled to its F0 and tint) over the diffuse base, which gets what the
largest channel of the dielectric lobe leaves. Multiple scattering after Turquin 2019 / Kulla and Conty 2017.

For a mirror the terms are exact. For a rough lobe they are integrated over the GGX lobe and fitted by a
polynomial in the view cosine, which Horner's rule evaluates in the shader.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ..expression import (
    Expr,
    clamp,
    dot,
    greatest,
    lift,
    maximum,
    minimum,
    mix,
    multiply_add,
    scalar,
    sqrt,
    vector,
)
from ..ggx import directional_averages, hemispherical_average
from .lookup import INCOMING, NORMAL
from .records import DielectricLobe, SurfaceEffects

RADIANCE = vector("Radiance")
BASE_COLOR = vector("Base Color")
METALLIC = scalar("Metallic")
SPECULAR_LEVEL = scalar("Specular IOR Level")
SPECULAR_TINT = vector("Specular Tint")

FIT_DEGREE = 6
_F82_COSINE = 1.0 / 7.0


def f0_from_ior(ior: float) -> float:
    """Reflectance at normal incidence."""
    return ((ior - 1.0) / (ior + 1.0)) ** 2


def ior_from_f0(f0: float) -> float:
    """The inverse, for f0 in [0, 1)."""
    root = np.sqrt(min(max(f0, 0.0), 0.99))
    return float((1.0 + root) / (1.0 - root))


def dielectric_lobe(ior: float, level: float | None, tinted: bool = False) -> DielectricLobe | None:
    """The lobe of an index of refraction, or None where it reflects nothing.

    Args:
        ior: of the material.
        level: the specular IOR level, or None where it varies.
        tinted: whether the specular tint is not white all over.
    """
    f0 = f0_from_ior(ior) if level is None else f0_from_ior(ior) * 2.0 * level
    eta = ior
    if level is not None and level != 0.5:
        eta = ior_from_f0(f0)
        eta = 1.0 / eta if ior < 1.0 else eta
    if eta == 1.0 or ior == 1.0:
        return None
    return DielectricLobe(ior, eta, None if tinted or level is None else min(f0, 1.0))


def fresnel_dielectric(cosine: np.ndarray, eta: float) -> np.ndarray:
    """Unpolarised Fresnel reflectance from outside; 1 under total internal reflection."""
    g2 = eta * eta - 1.0 + cosine * cosine
    g = np.sqrt(np.maximum(g2, 0.0))
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.where(g2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def _curve_position(cosine: np.ndarray, eta: float) -> np.ndarray:
    """Where the Fresnel curve stands between its value at normal incidence (0) and 1 (1)."""
    f0 = f0_from_ior(eta)
    return (fresnel_dielectric(cosine, eta) - f0) / (1.0 - f0)


def _cosine_grid() -> np.ndarray:
    return 0.5 - 0.5 * np.cos(np.pi * (np.arange(48) + 0.5) / 48)


Coefficients = tuple[tuple[float, ...], ...]  # from the highest power down, each with one or three terms


def _fitted(cosines: np.ndarray, values: np.ndarray) -> Coefficients:
    """Least-squares polynomials in the cosine through `values` (terms, n)."""
    chebyshev = np.polynomial.chebyshev
    basis = chebyshev.chebvander(2.0 * cosines - 1.0, FIT_DEGREE)
    fits = np.linalg.lstsq(basis, values.T, rcond=None)[0]
    powers = [chebyshev.Chebyshev(fit, domain=[0, 1]).convert(kind=np.polynomial.Polynomial).coef for fit in fits.T]
    padded = np.stack([np.pad(p, (0, FIT_DEGREE + 1 - len(p))) for p in powers])
    return tuple(tuple(float(c) for c in column) for column in padded.T[::-1])


@cache
def _dielectric_terms(roughness: float, eta: float) -> np.ndarray:
    """∫ 1 − s and ∫ s at the grid's cosines, s being the position on the Fresnel curve of `eta`: (2, n)."""
    curves = [lambda c: 1.0 - _curve_position(c, eta), lambda c: _curve_position(c, eta)]
    return directional_averages(_cosine_grid(), roughness, curves)


@cache
def _metal_terms(roughness: float) -> np.ndarray:
    """∫ 1 − s, ∫ s and ∫ c (1 − c)⁶ at the grid's cosines, with Schlick's s = (1 − c)⁵: (3, n)."""
    curves = [lambda c: 1.0 - (1.0 - c) ** 5, lambda c: (1.0 - c) ** 5, lambda c: c * (1.0 - c) ** 6]
    return directional_averages(_cosine_grid(), roughness, curves)


def _horner(cosine: Expr, coefficients: Coefficients) -> Expr:
    value = lift(coefficients[0] if len(coefficients[0]) > 1 else coefficients[0][0])
    for coefficient in coefficients[1:]:
        value = multiply_add(value, cosine, coefficient if len(coefficient) > 1 else coefficient[0])
    return clamp(value)


def _multiscatter(single, albedo, f0, average_albedo: float):
    """Energy that scattering between microfacets gives back to a lobe of single-scattering reflectance `single`.

    Takes expressions or arrays.
    """
    average_fresnel = f0 + (1.0 - f0) * (1.0 / 21.0)
    returned = average_fresnel * average_albedo / (1.0 - average_fresnel * (1.0 - average_albedo))
    return single * (1.0 + returned * ((1.0 - albedo) / (albedo + 1e-6)))


def _dielectric(cosine: Expr, lobe: DielectricLobe, effects: SurfaceEffects) -> Expr:
    """Reflectance of the dielectric lobe: a scalar where its F0 is grey and constant, else a colour."""
    if effects.roughness == 0.0:
        return _mirror_dielectric(cosine, lobe)
    cosines = _cosine_grid()
    terms = _dielectric_terms(effects.roughness, lobe.eta)
    albedo = terms[0] + terms[1]
    average = hemispherical_average(cosines, albedo)
    if lobe.f0 is not None:
        total = lobe.f0 * terms[0] + terms[1]
        if effects.multiscatter:
            total = _multiscatter(total, albedo, lobe.f0, average)
        return _horner(cosine, _fitted(cosines, total[None]))
    f0 = _tinted_f0(lobe)
    fit = _horner(cosine, _fitted(cosines, np.stack([*terms, 0.0 * cosines])))
    single = multiply_add(f0, fit.x, fit.y)
    return _multiscatter(single, fit.x + fit.y, f0, average) if effects.multiscatter else single


def _mirror_dielectric(cosine: Expr, lobe: DielectricLobe) -> Expr:
    g = sqrt(lobe.eta**2 - 1.0 + cosine * cosine)
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    fresnel = minimum(0.5 * a * a * (1.0 + b * b), 1.0)
    start = f0_from_ior(lobe.eta)
    if lobe.f0 is not None and abs(lobe.f0 - start) < 1e-6:
        return fresnel
    f0 = _tinted_f0(lobe) if lobe.f0 is None else lift(lobe.f0)
    # The curve of a high index dips below its start, which must not make a black tint negative.
    return maximum(mix(f0, 1.0, (fresnel - start) / (1.0 - start)), 0.0)


def _tinted_f0(lobe: DielectricLobe) -> Expr:
    return minimum(SPECULAR_TINT * (SPECULAR_LEVEL * (2.0 * f0_from_ior(lobe.ior))), 1.0)


def _metal(cosine: Expr, effects: SurfaceEffects) -> Expr:
    """Reflectance of the metallic lobe: a colour."""
    f0 = clamp(BASE_COLOR)
    mirror = effects.roughness == 0.0
    if mirror:
        grazing = 1.0 - cosine
        squared = grazing * grazing
        fifth = squared * squared * grazing
        single, dip_term = mix(f0, 1.0, fifth), cosine * fifth * grazing
    else:
        cosines, terms = _cosine_grid(), _metal_terms(effects.roughness)
        average = hemispherical_average(cosines, terms[0] + terms[1])
        fit = _horner(cosine, _fitted(cosines, terms))
        single, dip_term = multiply_add(f0, fit.x, fit.y), fit.z
    if effects.tinted:
        at_82 = mix(f0, 1.0, (1.0 - _F82_COSINE) ** 5)
        dip = at_82 * (1.0 - minimum(SPECULAR_TINT, 1.0)) * (1.0 / (_F82_COSINE * (1.0 - _F82_COSINE) ** 6))
        single = clamp(single - dip * dip_term)
    if mirror or not effects.multiscatter:
        return single
    return _multiscatter(single, fit.x + fit.y, f0, average)


def surface(effects: SurfaceEffects) -> dict[str, Expr]:
    """A Principled surface lit by a probe.

    Returns:
        "Reflection": the radiance that the specular lobe sends to the eye; "Diffuse Color": the base colour
        that is left for a BSDF without specular and metal. Both are linear colours.
    """
    cosine = clamp(dot(NORMAL, INCOMING), 1e-12)  # at 0 and below the critical angle Fresnel's terms are 0/0
    reflectance, left = lift(0.0), lift(1.0)
    if effects.dielectric:
        reflectance = _dielectric(cosine, effects.dielectric, effects)
        left = 1.0 - (reflectance if reflectance.width == 1 else minimum(greatest(reflectance), 1.0))
    if effects.metal:
        metal = _metal(cosine, effects)
        reflectance = mix(reflectance, metal, METALLIC) if effects.dielectric else metal * METALLIC
        left = left * (1.0 - METALLIC)
    return {"Reflection": RADIANCE * reflectance, "Diffuse Color": BASE_COLOR * left}
