"""What a survey saw, as points with the planes that they lie on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import equirect

FAR = 1e9  # metres: stands for the distance of nothing, so that sums and products stay finite
_FLAT = 1e-3  # how far from a plane neighbours may be, over their distance
_GRAZING = 0.05  # cosine below which a surface counts as seen at this one: its area would be anything


@dataclass(frozen=True, eq=False)
class Cloud:
    """What is seen from a point, a row for each direction.

    Attributes:
        point: (3,) float64, world space, metres: from where.
        ways: (n, 3) float64, unit directions, world space.
        distances: (n,) float64, metres; `FAR` where nothing is.
        solid_angles: (n,) float64, steradians; 4π in all.
        normals: (n, 3) float64, unit, world space, towards the point; 0 where what is seen is not flat.
        areas: (n,) float64, square metres of the flat surface that each direction stands for; 0 where it is not flat.
    """

    point: np.ndarray
    ways: np.ndarray
    distances: np.ndarray
    solid_angles: np.ndarray
    normals: np.ndarray
    areas: np.ndarray

    @property
    def seen(self) -> np.ndarray:
        """(n,) bool: where anything is."""
        return self.distances < FAR

    @property
    def positions(self) -> np.ndarray:
        """(n, 3) float64, metres from the point, along the world's axes."""
        return self.ways * self.distances[:, None]


def cloud_of(nearness: np.ndarray, point: np.ndarray) -> Cloud:
    """The cloud of a survey.

    On a plane the positions of a texel's four neighbours are in it: where they are, their differences span it. Near the
    poles neighbours in a row are as far apart as rows are.

    Args:
        nearness: (h, 2h) 1/metres along `equirect.directions`; 0 where nothing is.
        point: (3,), world space, metres: from where.
    """
    height, width = nearness.shape
    near = nearness.astype(np.float64)
    ways = equirect.directions(width, height)
    distances = np.where(near > 1.0 / FAR, 1.0 / np.maximum(near, 1.0 / FAR), FAR)
    positions = ways * distances[..., None]
    around = [positions[places] for places in _neighbours(height, width)]
    normals = np.cross(around[1] - around[0], around[3] - around[2])
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = normals / np.maximum(length, 1e-300)
    normals *= -np.sign((normals * ways).sum(-1, keepdims=True))
    off = np.max([np.abs(((q - positions) * normals).sum(-1)) for q in around], axis=0)
    whole = np.min([near[places] for places in _neighbours(height, width)], axis=0) > 0.0
    flat = whole & (near > 0.0) & (off <= _FLAT * distances) & (length[..., 0] > 0.0)
    normals[~flat] = 0.0
    solid_angles = np.repeat(equirect.solid_angles(width, height), width)
    facing = np.maximum(-(normals * ways).sum(-1).ravel(), _GRAZING)
    areas = np.where(flat.ravel(), solid_angles * distances.ravel() ** 2 / facing, 0.0)
    return Cloud(
        np.asarray(point, np.float64),
        ways.reshape(-1, 3),
        distances.ravel(),
        solid_angles,
        normals.reshape(-1, 3),
        areas,
    )


def _neighbours(height: int, width: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """(rows, columns) of the texels before and after in the row, below and above; beyond a pole half way around."""
    rows, columns = np.indices((height, width))
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)
    step = np.clip(np.rint(1.0 / np.cos(elevation)), 1, width // 4).astype(np.intp)[:, None]
    below, above = rows - 1, rows + 1
    past = (columns + width // 2) % width
    return [
        (rows, (columns - step) % width),
        (rows, (columns + step) % width),
        (np.maximum(below, 0), np.where(below < 0, past, columns)),
        (np.minimum(above, height - 1), np.where(above >= height, past, columns)),
    ]
