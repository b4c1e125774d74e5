"""What a reflection shader is asked to do. Groups are built from these records and from nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Correction(str, Enum):
    """How the lookup direction is found."""

    NONE = "NONE"  # the reflection vector itself: the classic cubemap (S1)
    ALIGNED_BOX = "ALIGNED_BOX"  # box faces along the world axes (S7)
    TURNED_BOX = "TURNED_BOX"  # turned about the vertical only
    ORIENTED_BOX = "ORIENTED_BOX"  # any box: rotated, mirrored, sheared (S2, S12)


class Outside(str, Enum):
    """What a surface outside the influence volume shows."""

    UNCORRECTED = "UNCORRECTED"  # fades to the classic lookup
    BLACK = "BLACK"  # fades to black (S3)


@dataclass(frozen=True)
class LookupEffects:
    """The effects of one direction lookup; equal records share one node group.

    Attributes:
        correction: how the direction is found.
        outside: what a surface outside the influence volume shows, or None where no surface lies outside, so that
            nothing need be tested or faded.
        offset: whether the capture point is apart from the box's centre (S5).
    """

    correction: Correction = Correction.ORIENTED_BOX
    outside: Outside | None = Outside.UNCORRECTED
    offset: bool = True

    @property
    def label(self) -> str:
        """A short name, unique for the record, for the node group's title."""
        words = [self.correction.value.lower().replace("_", " ")]
        if self.correction is not Correction.NONE:
            words.append(f"outside {self.outside.value.lower()}" if self.outside else "inside")
            words.append("offset" if self.offset else "centred")
        return ", ".join(words)


@dataclass(frozen=True)
class DielectricLobe:
    """The specular layer over a Principled BSDF's diffuse base.

    Attributes:
        ior: index of refraction of the material; gives the reflectance at normal incidence.
        eta: the index whose Fresnel curve the lobe follows, after the specular level.
        f0: the reflectance at normal incidence where it is the same grey all over the surface; None where the
            specular level or tint vary or have a colour.
    """

    ior: float
    eta: float
    f0: float | None


@dataclass(frozen=True)
class SurfaceEffects:
    """The effects of one Principled surface's specular lobe; equal records share one node group.

    Attributes:
        roughness: the lobe's constant roughness, 0 … 1 (alpha = roughness²).
        dielectric: the dielectric lobe, or None where there is none: a pure metal, or no specular reflection
            beside the metal's.
        metal: whether a metallic lobe is called for.
        tinted: whether the specular tint is not white all over.
        multiscatter: whether the lobe keeps the energy of multiple scattering.
    """

    roughness: float
    dielectric: DielectricLobe | None
    metal: bool
    multiscatter: bool
    tinted: bool = False

    @property
    def label(self) -> str:
        """A short name, unique for the record, for the node group's title."""
        words = [f"roughness {self.roughness:.6g}"]
        if self.dielectric:
            words.append(f"IOR {self.dielectric.ior:.6g}")
            if self.dielectric.eta != self.dielectric.ior:
                words.append(f"as {self.dielectric.eta:.6g}")
            words.append("varying F0" if self.dielectric.f0 is None else f"F0 {self.dielectric.f0:.6g}")
        if self.metal:
            words.append("tinted metal" if self.tinted else "metal")
        if self.multiscatter and self.roughness > 0:
            words.append("multiscatter")
        return ", ".join(words)
