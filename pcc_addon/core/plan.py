"""What is decided from readings, and why: bake, injection, status, panels and reports obey it."""

from __future__ import annotations

from dataclasses import dataclass

from .effects.records import LookupEffects, SurfaceEffects
from .pictures import PictureKey


@dataclass(frozen=True)
class SurfacePlan:
    """One surface of a material.

    Attributes:
        path: as in its reading.
        effects: what its shader computes, or None where it keeps its own lobe.
        reasons: why, in words; all of them.
    """

    path: tuple[str, ...]
    effects: SurfaceEffects | None
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class MaterialPlan:
    """One material.

    Attributes:
        material: its name.
        probes: those that it shows, the one with most of its objects first; empty: it is left as it is.
        objects: (object, probe): which of them each of its objects shows.
        surfaces: one for each of its surfaces.
        reasons: why these probes, or why none, in words.
    """

    material: str
    probes: tuple[str, ...]
    objects: tuple[tuple[str, str], ...]
    surfaces: tuple[SurfacePlan, ...]
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class ProbePlan:
    """One probe.

    Attributes:
        probe: its name.
        lookup: what its lookup computes.
        pictures: those that it needs, sharpest first.
        reasons: why, in words.
    """

    probe: str
    lookup: LookupEffects
    pictures: tuple[PictureKey, ...]
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    """What a scene calls for.

    Attributes:
        probes, materials: by name; faulty probes are missing and named in the notes.
        notes: sentences on what was left alone, each naming the object, what is wrong and what to do.
    """

    probes: tuple[ProbePlan, ...]
    materials: tuple[MaterialPlan, ...]
    notes: tuple[str, ...] = ()
