"""Where to take the pictures: clear of furniture, and where much of the room is seen."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from .. import equirect
from ..probe import Box
from .cloud import Cloud
from .misfit import exits

CLEARANCE = 0.3  # metres from all surfaces, as far as the room is wide enough
_NARROW = 0.35  # of the least half extent: the clearance in narrow rooms
_ALONG = (7, 7, 5)  # places that are tried along the box's axes
_OCCLUDERS, _WALL_SAMPLES, _THING_SAMPLES = 12000, 24, 1500
_ROWS = 32  # of the picture of what is nearest in each direction
_BEHIND = 1.15  # times as far as the nearest in a direction: hidden by it
_MIDDLE = 0.03  # what the middle of the box is worth over its corner, where both see as much
NOTABLY = 0.03  # by how much more of the room must be seen to be worth another place


@dataclass(frozen=True, eq=False)
class _Scene:
    """What the choice is made from.

    Attributes:
        occluders: (m, 3) metres from the cloud's point: what may hide.
        samples, facing, areas: (n, 3) likewise, what is to be seen; (n, 3) unit, towards where; (n,) square metres.
    """

    occluders: np.ndarray
    samples: np.ndarray
    facing: np.ndarray
    areas: np.ndarray


def suggested(cloud: Cloud, box: Box) -> np.ndarray:
    """(3,) world space, metres: the capture point; that of the cloud where no other is notably better.

    Only places that the cloud shows to be free are tried. From each, what is seen of the box's walls and of the
    furniture is estimated with the cloud's points as what may hide it.
    """
    clearance = min(CLEARANCE, _NARROW * float(box.half_widths.min()))
    scene = _scene(cloud, box)
    free = [place for place in _places(cloud, box, clearance) if _is_clear(scene, place, clearance)]
    old = np.zeros(3)
    if not free:
        return cloud.point
    diagonal = float(np.linalg.norm(box.half_extents))
    middle = box.centre - cloud.point
    scores = [_seen_from(scene, place) - _MIDDLE * float(np.linalg.norm(place - middle)) / diagonal for place in free]
    best = int(np.argmax(scores))
    if _is_inside(cloud, box, old, clearance) and _is_clear(scene, old, clearance):
        own = _seen_from(scene, old) - _MIDDLE * float(np.linalg.norm(old - middle)) / diagonal
        if scores[best] <= own + NOTABLY:
            return cloud.point
    return cloud.point + free[best]


def seen_share(cloud: Cloud, box: Box) -> float:
    """How much of a box's surface is seen from a cloud's point, in place or beyond: 1 in an empty room."""
    leaves, which = exits(box, cloud)
    facing = np.abs((cloud.ways * (box.face_normals[which // 2])).sum(-1))
    areas = np.where(leaves > 0.0, cloud.solid_angles * leaves**2 / np.maximum(facing, 1e-3), 0.0)
    return float(areas[cloud.distances >= leaves - 0.02].sum() / max(areas.sum(), 1e-300))


def is_clear(cloud: Cloud, box: Box) -> bool:
    """Whether a cloud's point is in the box and away from all that it sees."""
    clearance = min(CLEARANCE, _NARROW * float(box.half_widths.min()))
    return _is_inside(cloud, box, np.zeros(3), clearance) and bool(cloud.distances.min() >= clearance)


def _places(cloud: Cloud, box: Box, clearance: float) -> list[np.ndarray]:
    """Places (3,) in the box that are seen to be free."""
    start = box.coordinates(cloud.point[None])[0]
    reach = box.half_widths - clearance
    lines = [np.linspace(-reach[k], reach[k], _ALONG[k]) for k in range(3)]
    at = np.array(list(product(*lines)))
    places = (at - start) @ np.linalg.inv(box.face_normals).T
    far = np.linalg.norm(places, axis=1)
    height = int(np.sqrt(len(cloud.distances) / 2))
    distances = cloud.distances.reshape(height, 2 * height)
    u, v = equirect.coordinates(places)
    rows = np.clip((v * height).astype(np.intp), 0, height - 1)
    columns = (u * 2 * height).astype(np.intp) % (2 * height)
    return [place for place, ahead, away in zip(places, distances[rows, columns], far, strict=True) if ahead > away]


def _scene(cloud: Cloud, box: Box) -> _Scene:
    seen = np.flatnonzero(cloud.seen)
    occluders = cloud.positions[seen[:: max(1, len(seen) // _OCCLUDERS)]]
    walls, facing, areas = _wall_samples(box)
    leaves, _ = exits(box, cloud)
    things = np.flatnonzero((cloud.areas > 0.0) & (cloud.distances < leaves - 0.05))
    step = max(1, len(things) // _THING_SAMPLES)
    chosen = things[::step]
    return _Scene(
        occluders,
        np.concatenate([walls - cloud.point, cloud.positions[chosen]]),
        np.concatenate([facing, cloud.normals[chosen]]),
        np.concatenate([areas, step * cloud.areas[chosen]]),
    )


def _wall_samples(box: Box) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 3) over the box's faces, world space; towards where they face; their square metres (n,)."""
    steps = (np.arange(_WALL_SAMPLES) + 0.5) / _WALL_SAMPLES * 2.0 - 1.0
    points, normals, areas = [], [], []
    half = box.half_extents
    for axis, end in product(range(3), (-1.0, 1.0)):
        others = [k for k in range(3) if k != axis]
        at = np.zeros((_WALL_SAMPLES, _WALL_SAMPLES, 3))
        at[..., axis], at[..., others[0]], at[..., others[1]] = end, steps[:, None], steps[None]
        points.append(box.centre + at.reshape(-1, 3) @ box.axes.T)
        normals.append(np.tile(-end * box.face_normals[axis], (_WALL_SAMPLES**2, 1)))
        areas.append(np.full(_WALL_SAMPLES**2, 4.0 * half[others[0]] * half[others[1]] / _WALL_SAMPLES**2))
    return np.concatenate(points), np.concatenate(normals), np.concatenate(areas)


def _is_inside(cloud: Cloud, box: Box, place: np.ndarray, clearance: float) -> bool:
    at = box.coordinates((cloud.point + place)[None])[0]
    return bool((np.abs(at) <= box.half_widths - clearance + 1e-9).all())


def _is_clear(scene: _Scene, place: np.ndarray, clearance: float) -> bool:
    return bool(((scene.occluders - place) ** 2).sum(-1).min() >= clearance**2)


def _seen_from(scene: _Scene, place: np.ndarray) -> float:
    """Share of the samples' area that is seen from a place: facing it, and behind nothing that is known."""
    to = scene.occluders - place
    nearest = np.full(2 * _ROWS * _ROWS, np.inf)
    np.minimum.at(nearest, _cells(to), np.linalg.norm(to, axis=1))
    to = scene.samples - place
    far = np.linalg.norm(to, axis=1)
    seen = ((to * scene.facing).sum(-1) < 0.0) & (far <= _BEHIND * nearest[_cells(to)])
    return float(scene.areas[seen].sum() / scene.areas.sum())


def _cells(to: np.ndarray) -> np.ndarray:
    u, v = equirect.coordinates(to)
    rows = np.clip((v * _ROWS).astype(np.intp), 0, _ROWS - 1)
    return rows * 2 * _ROWS + (u * 2 * _ROWS).astype(np.intp) % (2 * _ROWS)
