"""Light through glass and water: the view is refracted and looked up in the same probe, mixed with the reflection.

A surface may bend light once, as water does; twice, as a solid thing of glass does, where the far side is that of an
ellipsoid; or not at all, as a thin pane does, whose two sides are parallel. Light that is mirrored inside leaves a
solid along the way of the rest, so that none is lost; in a pane its series has a sum (Stokes 1862).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache

from ..expression import (
    Expr,
    Formula,
    Section,
    clamp,
    combine,
    dot,
    lift,
    maximum,
    minimum,
    mix,
    multiply_add,
    normalize,
    reflect,
    scalar,
    sign,
    sqrt,
    vector,
)
from ..readings import SurfaceReading
from .fresnel import USUAL_IOR, Facets, curve_position, dielectric_facets, f0_from_ior, fresnel
from .lookup import INCOMING, NORMAL
from .shading import BASE_COLOR, COLOR, FILM_IOR, IOR, SPECULAR_TINT, TRANSMISSION, Shading
from .thin_film import tinted

BACKFACING = scalar("Backfacing")  # 1 where the inner side of a surface is seen, else 0
DIMENSIONS = vector("Dimensions")  # of the object's bounds along its own axes, metres
AXIS_X, AXIS_Y, AXIS_Z = vector("Axis X"), vector("Axis Y"), vector("Axis Z")  # of the object, in world space, unit


class Interface(str, Enum):
    """How often a transmitting thing bends what is seen through it."""

    ONCE = "ONCE"  # a surface with the medium behind it
    SOLID = "SOLID"  # going in and coming out at another angle
    PANE = "PANE"  # going in and coming out in parallel
    VESSEL = "VESSEL"  # other things stand in it, which no probe could show

    @property
    def words(self) -> str:
        return {"ONCE": "one interface", "SOLID": "solid", "PANE": "thin pane", "VESSEL": "vessel"}[self.value]


@dataclass(frozen=True)
class Transmission:
    """What shines through a surface, mixed over its opaque part by its weight.

    Attributes:
        ior: index of refraction, or None where it varies.
        interface: how often it bends light.
        whole: whether nothing is opaque, so that no weight is mixed by.
        colored: whether one colour tints reflection and transmission alike, as in a Glass BSDF; a Principled BSDF
            tints what passes by the square root of its base colour at each interface, and the reflection at F0.
        mirrors: whether it reflects as well.
    """

    ior: float | None
    interface: Interface = Interface.SOLID
    whole: bool = False
    colored: bool = False
    mirrors: bool = True

    @property
    def label(self) -> str:
        words = ["coloured"] * self.colored + ["glass" if self.mirrors else "refraction"]
        index = "varying IOR" if self.ior is None else f"IOR {self.ior:.6g}"
        return f"{' '.join(words)}, {self.interface.words}, {index}" + " alone" * self.whole

    @property
    def narrowing(self) -> float:
        """The roughness of a mirror that spreads as much as what is seen through, over the surface's.

        A mirror turns its ray by twice the angle of a small tilt, one interface by 1 − 1/n of it, two by n − 1 each,
        which add up like independent errors.
        """
        spread = 1.0 - 1.0 / self._usual if self.interface is Interface.ONCE else math.sqrt(2.0) * (self._usual - 1.0)
        return math.sqrt(abs(spread) / 2.0)

    @property
    def _usual(self) -> float:
        """An index near that of the surface."""
        return USUAL_IOR if self.ior is None else self.ior

    @property
    def facets(self) -> Facets:
        return dielectric_facets(max(self._usual, 1.0 / self._usual))

    @property
    def ray(self) -> Formula:
        """The ray that is seen through it."""
        return seen_through(self.interface, self.ior)

    @classmethod
    def of_principled(cls, surface: SurfaceReading) -> Transmission | None:
        if not surface.has("Transmission Weight"):
            return None
        weight, metallic = surface.scalar("Transmission Weight"), surface.scalar("Metallic")
        if (weight is not None and weight <= 0.0) or (metallic is not None and metallic >= 1.0):
            return None
        return cls(surface.scalar("IOR"), whole=weight is not None and weight >= 1.0)

    @classmethod
    def of_glass(cls, surface: SurfaceReading) -> Transmission:
        return cls(surface.scalar("IOR"), whole=True, colored=True)

    @classmethod
    def of_refraction(cls, surface: SurfaceReading) -> Transmission:
        return cls(surface.scalar("IOR"), whole=True, colored=True, mirrors=False)

    def apply(self, shading: Shading) -> Shading:
        reflected, through = self._shares(shading)
        if self.whole:
            return replace(shading, reflectance=reflected, transmittance=through, left=shading.left * 0.0)
        return replace(
            shading,
            reflectance=mix(shading.reflectance, reflected, TRANSMISSION),
            transmittance=through * TRANSMISSION,
            left=shading.left * (1.0 - TRANSMISSION),
        )

    def _shares(self, shading: Shading) -> tuple[Expr, Expr]:
        """How much of the radiance along the reflected and along the refracted ray reaches the eye, colours."""
        mirrored, passed = self._interface(shading)
        tint = maximum(COLOR, 0.0) if self.colored else _root(clamp(BASE_COLOR))
        if not self.mirrors:
            return lift(0.0), passed * (tint if self.interface is Interface.ONCE else tint * tint)
        mirrored = mirrored * tint if self.colored else mirrored
        once = passed * tint
        if self.interface is Interface.ONCE:
            return mirrored, once
        if self.interface is Interface.SOLID:
            return mirrored, once * tint
        twice = once * once / (1.0 - minimum(mirrored * mirrored, _NOT_QUITE_ALL))
        return mirrored + mirrored * twice, twice

    def _interface(self, shading: Shading) -> tuple[Expr, Expr]:
        """What one interface reflects and lets through of white light, before the tints."""
        lobe = shading.lobe
        if self.ior is not None and abs(self.ior - 1.0) < _NO_STEP and shading.film is None:
            return lift(0.0), lift(1.0)
        if not self.mirrors:
            return lift(0.0), lobe.transmittance(self._usual)
        most = max(self._usual, 1.0 / self._usual)
        index = IOR if self.ior is None else lift(self.ior)
        if shading.film is not None:
            facet = shading.film.over_dielectric(lobe, self._eta(index), self._eta_of_film(index))
            reflected = facet if self.colored else tinted(facet, SPECULAR_TINT, f0_from_ior(index))
        else:
            facet = fresnel(lobe.effective_cosine(curve_position(most), f0_from_ior(most)), self._eta(index))
            reflected = facet
            if not self.colored:
                f0 = f0_from_ior(index)
                position = (facet - f0) / (1.0 - f0)
                reflected = maximum(mix(SPECULAR_TINT * f0, 1.0, position), 0.0)
        mirrored, passed = lobe.albedo() * reflected, lobe.transmittance(self._usual) * (1.0 - facet)
        if not shading.keeps_energy:
            return mirrored, passed
        all_of_it = lobe.albedo() * facet + passed
        return mirrored / all_of_it, passed / all_of_it

    def _eta(self, index: Expr) -> Expr:
        """The index of what is behind the surface over that of what is before it."""
        return _seen_from(index) if self.interface is Interface.ONCE else index

    def _eta_of_film(self, index: Expr) -> Expr:
        """The index of a film over the surface over that of what is before it."""
        return FILM_IOR * mix(1.0, lift(1.0) / index, BACKFACING) if self.interface is Interface.ONCE else FILM_IOR


_NOT_QUITE_ALL = 1.0 - 2.0**-20
_NO_STEP = 1e-6  # of the index, below which an interface is none


def _seen_from(index: Expr) -> Expr:
    """The index, or its inverse where the inner side is seen."""
    return mix(index, lift(1.0) / index, BACKFACING)


def _root(color: Expr) -> Expr:
    return combine(sqrt(color.x), sqrt(color.y), sqrt(color.z))


def refracted(direction: Expr, normal: Expr, eta: Expr) -> tuple[Expr, Expr]:
    """The direction in which an interface bends a ray, unit, and whether it does, 1 or 0.

    Where it does not, since all light is mirrored, the direction means nothing.

    Args:
        direction: of the ray, unit.
        normal: unit, on the side that the ray comes from.
        eta: the index of what is behind over that of what is before.
    """
    ratio = lift(1.0) / eta
    cosine = clamp(dot(direction, normal) * -1.0)
    squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine)
    bent = multiply_add(normal, ratio * cosine - sqrt(squared), direction * ratio)
    return bent, maximum(sign(squared), 0.0)


@cache
def seen_through(interface: Interface, ior: float | None) -> Formula:
    """The ray that is seen through a surface.

    A solid counts as an ellipsoid of its size: the normal alone says where on it a point lies, as u = A n / |A n| on
    the unit sphere with the half axes A, and the ray inside, A⁻¹ d there, leaves it at −2 u · A⁻¹d / |A⁻¹d|².

    Args:
        interface: how often light is bent.
        ior: index of refraction; None: the input "IOR".

    Returns:
        A formula with "Direction", unit, and for a solid "Offset": from the surface to where the ray leaves it, metres.
    """
    towards = INCOMING * -1.0
    index, title = (IOR, "varying IOR") if ior is None else (lift(ior), f"IOR {ior:.6g}")
    if interface is Interface.PANE:
        return Formula("Through a Pane", {"Direction": towards})
    if interface is Interface.ONCE:
        bent, passes = refracted(towards, NORMAL, _seen_from(index))
        # All of what is mirrored is no part of what passes: any direction does.
        return Formula(f"Refracted, {title}", {"Direction": Section("Refracted ray", mix(towards, bent, passes))})
    inside = Section("Inside", refracted(towards, NORMAL, index)[0])
    half = DIMENSIONS * 0.5
    near = Section("Ellipsoid", normalize(half * _along_axes(NORMAL)))
    way = Section("Ellipsoid", _along_axes(inside) / half)
    length = Section("Ellipsoid", dot(near, way) * -2.0 / dot(way, way))
    far = multiply_add(way, length, near) / half
    leaving = Section("Far side", normalize(AXIS_X * far.x + AXIS_Y * far.y + AXIS_Z * far.z) * -1.0)
    bent, passes = refracted(inside, leaving, lift(1.0) / index)
    direction = Section("Far side", mix(reflect(inside, leaving), bent, passes))
    return Formula(f"Through a Solid, {title}", {"Direction": direction, "Offset": inside * length})


def _along_axes(v: Expr) -> Expr:
    return combine(dot(AXIS_X, v), dot(AXIS_Y, v), dot(AXIS_Z, v))
