"""A thin film over a surface: light that is mirrored at its two sides interferes, so that it reflects in colours.

Each reflectance is the Airy sum over the paths of light in the film, for both polarisations. What a colour channel
makes of a path is the Fourier transform of its sensitivity over the wavenumber, at the path's optical length, so that
no spectrum is integrated (Belcour and Barla 2017). A metal's index is that of its colours at normal incidence and at
the edge (Gulbrandsen 2014), as renderers read them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np

from ..expression import (
    Expr,
    Formula,
    Section,
    clamp,
    cosine,
    exp2,
    lift,
    maximum,
    minimum,
    mix,
    scalar,
    sqrt,
    vector,
)
from ..readings import SurfaceReading
from .fresnel import dip
from .lobe import Lobe
from .shading import FILM_IOR, FILM_THICKNESS, Shading

_LEAST = 0.1  # nanometres of a film that is one
_NOT_QUITE_ALL = 0.999  # what a metal reflects whose index is known
_EDGE_COSINE = 1.0 / 7.0
# Sums of bells, an (amplitude, 1/nm, 1/nm) of each channel: fitted to the transform of the linear Rec. 709 combinations
# of the CIE 1931 functions (Wyman, Sloan and Shirley 2013), each of area 1, for paths of up to 4.5 µm above all.
_BELLS = (
    ((-0.4457, -0.0916, -0.1512), (0.012079, 0.014241, 0.011319), (0.0005941, 0.0004853, 0.0006922)),
    ((0.0548, 1.2598, -0.0330), (0.014355, 0.011543, 0.015332), (0.0002852, 0.0007162, 0.0002292)),
    ((1.3909, -0.1682, 1.1842), (0.010370, 0.010191, 0.013943), (0.0004815, 0.0003758, 0.0007227)),
)
_ORDERS = 3  # paths that are mirrored more often inside matter too little

_COSINE, _THICKNESS, _FILM, _BASE = (scalar(name) for name in ("Cosine", "Thickness", "Film IOR", "Base IOR"))
_INDEX, _EXTINCTION, _EDGE = vector("Index"), vector("Extinction"), vector("Edge")


@dataclass(frozen=True)
class ThinFilm:
    """The facets of this surface have a film over them.

    Attributes:
        smooth: whether the surface is a mirror all over, so that all facets are seen at one angle.
        on_metal: whether it covers metallic lobes too.
    """

    smooth: bool = False
    on_metal: bool = True

    @property
    def label(self) -> str:
        return "smooth " * self.smooth + "thin film" + " but for metal" * (not self.on_metal)

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> ThinFilm | None:
        metallic = surface.scalar("Metallic") if surface.has("Metallic") else 0.0
        pure = metallic is not None and metallic >= 1.0
        if not is_coated(surface) or (pure and not surface.films_on_metal):
            return None
        mixed = metallic != 0.0 and not pure
        on_metal = surface.films_on_metal and (surface.films_on_both or not mixed)
        return cls(surface.scalar("Roughness") == 0.0, on_metal)

    def apply(self, shading: Shading) -> Shading:
        return replace(shading, film=self)

    def over_dielectric(self, lobe: Lobe, ior: Expr, film_ior: Expr = FILM_IOR) -> Expr:
        """What the facets of a lobe reflect over a dielectric, but for the lobe's albedo: a colour.

        Args:
            lobe: the lobe.
            ior: of what is under the film, over that of what is before it.
            film_ior: of the film, over that of what is before it.
        """
        return self._averaged(lobe, lambda angle: self.dielectric_at(angle, ior, film_ior))

    def over_metal(self, lobe: Lobe, f0: Expr, tint: Expr | None) -> Expr:
        """The same over a metal of a colour and an F82 tint, or None where that is white."""
        edge = mix(f0, 1.0, (1.0 - _EDGE_COSINE) ** 5)
        edge = edge if tint is None else edge * minimum(tint, 1.0)
        found = METAL_INDEX(Color=f0, Edge=edge)
        index, extinction = found["Index"], found["Extinction"]
        return self._averaged(
            lobe,
            lambda angle: FILM_OVER_METAL(
                Cosine=angle,
                Thickness=FILM_THICKNESS,
                Film_IOR=FILM_IOR,
                Index=index,
                Extinction=extinction,
                Edge=edge,
            )["Reflectance"],
        )

    def dielectric_at(self, angle: Expr, ior: Expr, film_ior: Expr = FILM_IOR) -> Expr:
        """What one facet reflects over a dielectric, by the cosine of the view on it."""
        return FILM_OVER_DIELECTRIC(Cosine=angle, Thickness=FILM_THICKNESS, Film_IOR=film_ior, Base_IOR=ior)[
            "Reflectance"
        ]

    def _averaged(self, lobe: Lobe, at: Callable[[Expr], Expr]) -> Expr:
        if self.smooth:
            return at(lobe.cosine)
        return reduce(add, (at(angle) * share for share, angle in lobe.facet_cosines()))


def is_coated(surface: SurfaceReading) -> bool:
    """Whether a surface has a film somewhere."""
    if not surface.has("Thin Film Thickness"):
        return False
    thickness = surface.scalar("Thin Film Thickness")
    return thickness is None or thickness > _LEAST


def tinted(film: Expr, tint: Expr, f0: Expr) -> Expr:
    """A film's reflectance, tinted: wholly where it reflects as its base does head-on, not at all at the edge.

    Args:
        film: its reflectance, a colour.
        tint: what it is tinted by.
        f0: what its base reflects at normal incidence, a scalar.
    """
    return film * mix(1.0, tint, clamp((lift(1.0) - film) / (lift(1.0) - f0)))


def _inside() -> tuple[Expr, Expr]:
    """(The film's index, the cosine of the ray in it); a film that fades away takes on the index of air."""
    index = mix(1.0, _FILM, clamp(_THICKNESS))
    return index, sqrt(1.0 - (1.0 - _COSINE * _COSINE) / (index * index))


def _amplitudes(before: Expr, behind: Expr, index: Expr) -> tuple[Expr, Expr]:
    """Fresnel's amplitudes of reflection across and along the plane of incidence, by the cosines of both rays."""
    slower, bent = before * index, behind * index
    return (before - bent) / (before + bent), (slower - behind) / (slower + behind)


def _sensitivities(path: Expr, order: int, *, both: bool) -> tuple[Expr, Expr | None]:
    """The real and, where it is asked for, the imaginary part of the channels' answer to so many times a path, nm."""
    real, imaginary = [], []
    for amplitude, wavenumber, width in _BELLS:
        phase = path * tuple(order * k for k in wavenumber)
        spread = path * tuple(order * w / np.sqrt(2.0 * np.log(2.0)) for w in width)
        weight = exp2(spread * spread * -1.0) * amplitude
        real.append(weight * cosine(phase))
        if both:
            imaginary.append(weight * cosine(phase - np.pi / 2.0))
    return reduce(add, real), reduce(add, imaginary) if both else None


def _over_dielectric() -> Expr:
    index, inside = _inside()
    ratio = _BASE / index
    below = sqrt(1.0 - (1.0 - inside * inside) / (ratio * ratio))
    path = Section("Path", 2.0 * index * _THICKNESS * inside)
    answers = [_sensitivities(path, k + 1, both=False)[0] for k in range(_ORDERS)]
    upper, lower = _amplitudes(_COSINE, inside, index), _amplitudes(inside, below, ratio)
    polarised = []
    for r12, r23 in zip(upper, lower, strict=True):
        twice = r12 * r23 * -1.0
        mean, change = _incoherent(r12, r23 * r23)
        total: Expr = mean
        power: Expr = change * 2.0
        for answer in answers:
            power = power * twice
            total = total + answer * power
        polarised.append(Section("Airy sum", total))
    return clamp((polarised[0] + polarised[1]) * 0.5)


def _incoherent(r12: Expr, r23: Expr) -> tuple[Expr, Expr]:
    """(What is reflected without interference, the weight of what interferes) of r12, an amplitude, r23, a share."""
    r12 = r12 * r12
    passed = lift(1.0) - r12
    inner = passed * passed * r23 / (lift(1.0) - r12 * r23)
    return r12 + inner, inner - passed


def _over_metal() -> Expr:
    index, inside = _inside()
    path = Section("Path", 2.0 * index * _THICKNESS * inside)
    answers = [_sensitivities(path, k + 1, both=True) for k in range(_ORDERS)]
    share = Section("Metal", _metal_share(index, inside))
    amplitude = sqrt(share)
    polarised = []
    for r12, (real, imaginary) in zip(_amplitudes(_COSINE, inside, index), _phasors(index, inside), strict=True):
        mean, change = _incoherent(r12, share)
        twice = amplitude * (r12 * -1.0)
        x, y = twice * real, twice * imaginary
        total, weight = mean, change * 2.0
        a, b = x, y
        for k, (even, odd) in enumerate(answers):
            assert odd is not None
            total = total + weight * (a * even - b * odd)
            if k + 1 < _ORDERS:
                a, b = a * x - b * y, a * y + b * x
        polarised.append(Section("Airy sum", total))
    return clamp((polarised[0] + polarised[1]) * 0.5)


def _metal_share(index: Expr, inside: Expr) -> Expr:
    """What a metal reflects of light in a film: F82's curve between its own index under the film and its edge."""
    n, k = _INDEX / index, _EXTINCTION / index
    f0 = ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k)
    depth = (mix(f0, 1.0, (1.0 - _EDGE_COSINE) ** 5) - _EDGE) * (1.0 / float(dip(np.array(_EDGE_COSINE))))
    grazing = 1.0 - inside
    fifth = grazing * grazing * grazing * grazing * grazing
    return clamp(mix(f0, 1.0, fifth) - depth * (inside * fifth * grazing))


def _phasors(index: Expr, inside: Expr) -> tuple[tuple[Expr, Expr], tuple[Expr, Expr]]:
    """The turn of phase at the metal, (real, imaginary) of length 1, across and along the plane of incidence.

    Source: Born and Wolf, Principles of Optics, 14.4.1.
    """
    n2, k2, twice = _INDEX * _INDEX, _EXTINCTION * _EXTINCTION, 2.0 * _INDEX * _EXTINCTION
    before, squared = index * inside, index * index
    t = n2 - k2 - squared * (1.0 - inside * inside)
    whole = sqrt(t * t + twice * twice)
    u, v = sqrt((whole + t) * 0.5), sqrt((whole - t) * 0.5)
    across = (before * before - whole, v * (before * -2.0))
    size = (n2 + k2) * inside
    along = (size * size - squared * whole, (twice * u - (n2 - k2) * v) * (before * 2.0))
    return _unit(*across), _unit(*along)


def _unit(real: Expr, imaginary: Expr) -> tuple[Expr, Expr]:
    size = maximum(sqrt(real * real + imaginary * imaginary), 1e-12)
    return real / size, imaginary / size


def _metal_index() -> dict[str, Expr]:
    """A metal's index and extinction from its reflectances at normal incidence and at the edge."""
    r = minimum(vector("Color"), _NOT_QUITE_ALL)
    root = sqrt(r)
    n = mix((root + 1.0) / (1.0 - root), (1.0 - r) / (r + 1.0), _EDGE)
    return {"Index": n, "Extinction": sqrt((r * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - r))}


FILM_OVER_DIELECTRIC = Formula("Thin Film over Dielectric", {"Reflectance": _over_dielectric()})
"""By the cosine of the view, the film's thickness in nm and the indices of the film and of what is under it."""
METAL_INDEX = Formula("Index of a Metal", _metal_index())
FILM_OVER_METAL = Formula("Thin Film over Metal", {"Reflectance": _over_metal()})
"""The same where what is under it is a metal, by its index, its extinction and its reflectance at a cosine of 1/7."""
