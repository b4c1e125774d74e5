"""What a surface's shader has computed so far; each effect takes one and gives one back."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..expression import Expr, lift, scalar, vector
from .lobe import Lobe

if TYPE_CHECKING:
    from .thin_film import ThinFilm

RADIANCE = vector("Radiance")  # along the reflected ray
BEHIND = vector("Transmitted Radiance")  # along the ray that is seen through the surface
BASE_COLOR = vector("Base Color")
METALLIC = scalar("Metallic")
ROUGHNESS = scalar("Roughness")
IOR = scalar("IOR")
SPECULAR_LEVEL = scalar("Specular IOR Level")
SPECULAR_TINT = vector("Specular Tint")
COLOR = vector("Color")
EDGE_TINT = vector("Edge Tint")
TRANSMISSION = scalar("Transmission Weight")
FILM_THICKNESS = scalar("Thin Film Thickness")  # nanometres
FILM_IOR = scalar("Thin Film IOR")
CAPTURED = scalar("Captured")  # 1 while probes are captured, else 0

MATT = 0.5
"""Albedo, over its colour, of the matt surface that captures see where there is a metal."""


@dataclass(frozen=True)
class Shading:
    """A surface halfway.

    Attributes:
        lobe: its specular lobe under the view's angle.
        reflectance: how much of the radiance it sends to the eye, a scalar or a colour.
        left: what is left for the diffuse part, a scalar.
        transmittance: how much of the radiance behind it passes to the eye, a scalar or a colour.
        keeps_energy: whether its lobes give back what scatters between microfacets.
        film: what lies over its facets, or None.
    """

    lobe: Lobe
    reflectance: Expr
    left: Expr
    transmittance: Expr = field(default_factory=lambda: lift(0.0))
    keeps_energy: bool = False
    film: ThinFilm | None = None
