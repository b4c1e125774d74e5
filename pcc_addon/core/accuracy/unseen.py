"""Which surfaces a probe's capture point does not see, so that no lookup can show them.

Points all over the surfaces are held against a survey. A point is seen if its side faces the capture point and one of
the four texels around its direction shows nothing before it, but for what half a texel makes along a surface of its
slope: where two surfaces meet a texel mixes both. The texel in which it lies must show nothing that is nearer by more
than six texels make, so that the borders of shadows lie where that texel changes. What lies less than half a texel's
width before a surface, 2 cm at 2.5 m in a survey of 128 texels, is not told from it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from .. import equirect
from ..probe import ProbeSpec
from .misfit import Viewers, at
from .sampling import Make, Place, Samples

SLACK = 0.05
"""Metres: a wall that a box drawn by hand misses by no more is still one of the room's."""

_MIXED, _NEAR = 0.5, 6.0  # texels
_MOST = 0.9  # of a distance
_STEEPEST = 0.1  # cosine: surfaces that are seen under a smaller angle are taken as if they were not
_GRAZING = 2e-3  # cosine: what is seen under a smaller angle is seen edge-on
_OTHERS = 512  # points that may face a side
_APART = 1e-3  # of the box's size: what is nearer to a side's plane does not face it
_VIEWERS = 16
_UPWARDS = 0.7  # z of a normal


class Part(Enum):
    """Where on an object an unseen surface is."""

    HIDDEN = "hidden"  # it faces the capture point, but something is before it
    UNDERSIDE = "underside"
    TOP = "top"
    BACK = "back"


@dataclass(frozen=True)
class UnseenPart:
    """One part of an object.

    Attributes:
        name: of the object.
        part: which.
        materials: names, by area.
        area: unseen, square metres.
        share: of the object's surface in the probe's influence, 0 … 1.
        facing: the objects that show the probe and that most of it faces, at most two; empty: none.
    """

    name: str
    part: Part
    materials: tuple[str, ...]
    area: float
    share: float
    facing: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Unseen:
    """What a capture point does not see.

    Attributes:
        parts: by area, the largest first.
        area: of all surfaces in the probe's influence that anything faces, square metres.
        idle: of those that nothing faces, square metres: undersides of what stands on the floor, outer sides of walls.
        points, normals: (k, 3) float64, world space: the samples of `parts`.
        sample_area: what each of them stands for, square metres.
    """

    parts: tuple[UnseenPart, ...]
    area: float
    idle: float
    points: np.ndarray
    normals: np.ndarray
    sample_area: float

    @property
    def unseen_area(self) -> float:
        """Square metres."""
        return sum(part.area for part in self.parts)


def influence_of(spec: ProbeSpec) -> Place:
    """Where surfaces are asked for: the probe's influence, and 5 cm more if its padding is less."""
    reach = np.maximum(spec.influence_reach, SLACK)
    ways = spec.box.face_normals
    middle = ways @ spec.box.centre
    offsets = np.concatenate([spec.box.half_widths + reach[1] + middle, spec.box.half_widths + reach[0] - middle])
    return Place(np.concatenate([ways, -ways]), offsets)


def viewers_of(samples: Samples, receivers: frozenset[str]) -> Viewers | None:
    """Sixteen points that show the probe, evenly among all; None where nothing does.

    Args:
        receivers: names of the materials that show it.
    """
    chosen = _evenly_among(np.flatnonzero(_shows(samples, receivers)), _VIEWERS)
    return Viewers(samples.points[chosen], samples.normals[chosen]) if len(chosen) else None


def facing_in(samples: Samples, spec: ProbeSpec) -> tuple[Samples, np.ndarray]:
    """The samples with a side each, on which others are, and whether any are there, (n,) bool.

    Sheets have two samples where anything faces either side. Of shells that is turned over which nothing faces, as a
    wall whose normals point out of the room.
    """
    others = samples.points[_evenly_among(np.arange(len(samples.points)), _OTHERS)]
    apart = _APART * float(spec.box.half_extents.max())
    front = _faced(samples.points, samples.normals, others, apart)
    back = _faced(samples.points, -samples.normals, others, apart)
    shell, sheet = samples.makes == Make.SHELL, samples.makes == Make.SHEET
    turned = (shell | sheet) & ~front & back
    normals = np.where(turned[:, None], -samples.normals, samples.normals)
    both = sheet & front & back
    index = np.concatenate([np.arange(len(normals)), np.flatnonzero(both)])
    normals = np.concatenate([normals, -samples.normals[both]])
    result = replace(
        samples,
        points=samples.points[index],
        normals=normals,
        owners=samples.owners[index],
        makes=samples.makes[index],
    )
    return result, (front | back & (shell | sheet))[index]


def seen(spec: ProbeSpec, nearness: np.ndarray, samples: Samples) -> np.ndarray:
    """(n,) bool: which samples the capture point sees.

    Args:
        nearness: a survey, (2m, 4m) 1/metres.
    """
    reach = samples.points - spec.capture_point
    distance = np.linalg.norm(reach, axis=-1)
    cosine = -(reach * samples.normals).sum(-1) / np.maximum(distance, 1e-12)
    rows, columns = nearness.shape
    u, v = equirect.coordinates(reach)
    low, left = (np.floor(c - 0.5).astype(np.intp) for c in (v * rows, u * columns))
    farthest = np.full(len(reach), np.inf)  # 1/metres, of the four texels around each
    for r in (low, low + 1):
        for c in (left, left + 1):
            farthest = np.minimum(farthest, nearness[np.clip(r, 0, rows - 1), c % columns])
    texel = 2.0 / (rows // 2)  # radians across one in the middle of a face, the widest
    slope = texel / np.maximum(cosine, _STEEPEST)  # of a distance: what a texel makes along the surface
    clear = farthest * distance * (1.0 - _MIXED * slope) <= 1.0
    near = at(nearness, reach) * distance * (1.0 - np.minimum(_NEAR * slope, _MOST)) <= 1.0
    return (cosine > _GRAZING) & clear & near


def unseen(spec: ProbeSpec, nearness: np.ndarray, samples: Samples, receivers: frozenset[str] = frozenset()) -> Unseen:
    """What a capture point does not see of some surfaces.

    Args:
        spec: the probe.
        nearness: its survey, (2n, 4n) 1/metres, 0 where nothing is.
        samples: of all surfaces in its influence that its capture shows.
        receivers: names of the materials that show it.
    """
    sides, faced = facing_in(samples, spec)
    hidden = ~seen(spec, nearness, sides)
    chosen = np.flatnonzero(hidden & faced)
    mirrors = _evenly_among(np.flatnonzero(_shows(sides, receivers) & faced), _OTHERS)
    parts = _parts(spec, sides, faced, chosen, mirrors)
    return Unseen(
        parts,
        area=float(faced.sum()) * samples.area,
        idle=float((hidden & ~faced).sum()) * samples.area,
        points=sides.points[chosen],
        normals=sides.normals[chosen],
        sample_area=samples.area,
    )


def _parts(
    spec: ProbeSpec, sides: Samples, faced: np.ndarray, chosen: np.ndarray, mirrors: np.ndarray
) -> tuple[UnseenPart, ...]:
    objects = sorted({name for name, _ in sides.names})
    number = np.array([objects.index(name) for name, _ in sides.names], np.intp)
    whose = number[sides.owners] if len(number) else sides.owners
    whole = np.bincount(whose[faced], minlength=len(objects))
    normals = sides.normals[chosen]
    away = ((sides.points[chosen] - spec.capture_point) * normals).sum(-1) >= 0.0
    steep = normals[:, 2]
    kinds = np.select([~away, steep < -_UPWARDS, steep > _UPWARDS], [0, 1, 2], 3)
    apart = _APART * float(spec.box.half_extents.max())
    found = []
    for k, name in enumerate(objects):
        for kind, part in enumerate((Part.HIDDEN, Part.UNDERSIDE, Part.TOP, Part.BACK)):
            mine = chosen[(whose[chosen] == k) & (kinds == kind)]
            if len(mine):
                worn = np.bincount(sides.owners[mine], minlength=len(sides.names))
                materials = [sides.names[j][1] for j in np.argsort(-worn, kind="stable") if worn[j]]
                facing = _facing(sides, mine, mirrors, apart)
                share = len(mine) / int(whole[k])
                found.append(UnseenPart(name, part, tuple(materials), len(mine) * sides.area, share, facing))
    return tuple(sorted(found, key=lambda part: (-part.area, part.name, part.part.value)))


def _facing(sides: Samples, mine: np.ndarray, mirrors: np.ndarray, apart: float) -> tuple[str, ...]:
    """The objects that show the probe and that at least half of some samples face, the two that most do."""
    few = _evenly_among(mine, _OTHERS)
    between = sides.points[mirrors][None] - sides.points[few][:, None]
    met = (np.einsum("nmk,nk->nm", between, sides.normals[few]) > apart) & (
        np.einsum("nmk,mk->nm", between, sides.normals[mirrors]) < -apart
    )
    owners = np.array([sides.names[k][0] for k in sides.owners[mirrors]])
    counts = {str(name): int(met[:, owners == name].any(1).sum()) for name in np.unique(owners)}
    best = sorted((name for name, n in counts.items() if 2 * n >= len(few)), key=lambda name: (-counts[name], name))
    return tuple(best[:2])


def _faced(points: np.ndarray, normals: np.ndarray, others: np.ndarray, apart: float) -> np.ndarray:
    """(n,) bool: whether any other point lies on the side that a normal says."""
    heights = (points * normals).sum(-1)
    result = np.zeros(len(points), bool)
    for start in range(0, len(points), 4096):
        rows = slice(start, start + 4096)
        result[rows] = (normals[rows] @ others.T > heights[rows, None] + apart).any(-1)
    return result


def _shows(samples: Samples, receivers: frozenset[str]) -> np.ndarray:
    """(n,) bool: which samples are of some materials."""
    wanted = np.array([material in receivers for _, material in samples.names], bool)
    return wanted[samples.owners] if len(wanted) else np.zeros(len(samples.points), bool)


def _evenly_among(indices: np.ndarray, count: int) -> np.ndarray:
    """At most so many of some indices, evenly among them."""
    if len(indices) <= count:
        return indices
    return indices[((np.arange(count) + 0.5) * len(indices) / count).astype(np.intp)]
