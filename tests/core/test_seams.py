"""Edges and corners of the cube are filtered as smoothly as the faces' insides, at every roughness level.

The world is smooth and known: a sum of zonal functions about tilted axes, which a blur that depends on the angle only
turns into the same sum with each Legendre coefficient multiplied by the lobe's own (Funk and Hecke). So the truth of
every level is known without faces, pictures or filters. A lamp in it shines from an edge or a corner; turned by 45°
about the vertical the same world has its lamp inside a face at the same height.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.polynomial import legendre

from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACES, face_directions
from pcc_addon.core.prefilter import prefilter

from . import boxes
from .lobes import quadrature

RESOLUTION, OVERSCAN = 64, 8  # as a capture has them, at an eighth of the default size
DEGREES = 40
PLACES = {
    "the middle of an upright edge": (1.0, 1.0, 0.0),
    "low on an upright edge": (-1.0, 1.0, -0.7),
    "on the picture's last and first column": (-1.0, -1.0, 0.3),
    "the middle of an upper edge": (0.0, -1.0, 1.0),
    "aside on a lower edge": (1.0, 0.3, -1.0),
    "an upper corner": (1.0, 1.0, 1.0),
    "a lower corner": (-1.0, 1.0, -1.0),
}
EACH_PLACE = pytest.mark.parametrize("place", PLACES)
EACH_LEVEL = pytest.mark.parametrize("roughness", [0.0, 0.05, 0.1, 0.2, 0.3, 0.6, 1.0])


def coefficients(function: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """(DEGREES,) Legendre coefficients of a function of the cosine."""
    nodes, weights = legendre.leggauss(200)
    degrees = np.arange(DEGREES)
    return (degrees + 0.5) * (weights * function(nodes) @ legendre.legvander(nodes, DEGREES - 1))


@cache
def kept(roughness: float) -> np.ndarray:
    """(DEGREES,) what a blur leaves of each Legendre polynomial: its mean over the lobe."""
    if roughness == 0.0:
        return np.ones(DEGREES)
    angle, weight = quadrature(roughness)
    return weight @ legendre.legvander(np.cos(angle), DEGREES - 1) / weight.sum()


def radiance(place: str, directions: np.ndarray, roughness: float = 0.0) -> np.ndarray:
    """(..., 1): harmonics of degrees 0 to 4 and a lamp of some 20° at a place, blurred, from directions (..., 3)."""
    degrees = np.eye(DEGREES)
    towards = [np.array(PLACES[place]), *boxes.directions(5, np.random.default_rng(1))]
    terms = [coefficients(lambda cosine: np.exp(25.0 * (cosine - 1.0))), degrees[0], *(0.1 * degrees[1:5])]
    unit = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    cosines = [unit @ axis / np.linalg.norm(axis) for axis in towards]
    return sum(legendre.legval(x, c * kept(roughness)) for x, c in zip(cosines, terms, strict=True))[..., None]


@cache
def mirror_level(place: str, inside: bool) -> np.ndarray:
    """The picture that the product makes of six pictures of that world, or of the world turned by 45°."""
    turn = np.radians(45.0 if inside else 0.0)
    back = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    faces = [radiance(place, face_directions(face, RESOLUTION, OVERSCAN) @ back.T).astype(np.float32) for face in FACES]
    picture = equirect.from_faces(faces, OVERSCAN)
    eighth = picture.shape[1] // 8
    return np.roll(picture, eighth, axis=1) if inside else picture


@cache
def levels(place: str, roughness: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Around a place: the level with the lamp there, that with the lamp inside a face, turned back, and the truth."""
    at_place, inside = (prefilter(mirror_level(place, where), roughness)[..., 0] for where in (False, True))
    height, width = at_place.shape
    truth = radiance(place, equirect.directions(width, height), roughness)[..., 0]
    u, v = equirect.coordinates(np.array(PLACES[place]))
    column, row = round(u * width - 0.5), round(v * height - 0.5)
    around = height // 12  # 15°
    rows, columns = np.arange(row - around, row + around + 1), np.arange(column - around, column + around + 1) % width
    return tuple(picture[np.ix_(rows, columns)].astype(np.float64) for picture in (at_place, inside, truth))


def bends(picture: np.ndarray) -> list[np.ndarray]:
    """How first differences change from texel to texel: along rows, along columns and along the diagonals."""
    rising, falling = picture, picture[::-1]
    return [
        np.diff(picture, 2, axis=1),
        np.diff(picture, 2, axis=0),
        rising[2:, 2:] - 2.0 * rising[1:-1, 1:-1] + rising[:-2, :-2],
        falling[2:, 2:] - 2.0 * falling[1:-1, 1:-1] + falling[:-2, :-2],
    ]


@pytest.mark.sweep
@EACH_PLACE
@EACH_LEVEL
def test_a_lamp_at_an_edge_or_corner_is_as_true_as_inside_a_face(place: str, roughness: float) -> None:
    """The error is at most 1.3 times that inside a face, and never more than 0.1 % of the lamp."""
    at_place, inside, truth = levels(place, roughness)
    error, usual = np.abs(at_place - truth), np.abs(inside - truth)
    assert error.max() < 1.3 * usual.max()
    assert np.sqrt(np.square(error).mean()) < 1.3 * np.sqrt(np.square(usual).mean())
    assert error.max() < 1e-3


@EACH_PLACE
@EACH_LEVEL
def test_first_differences_jump_no_more_across_edges_and_corners_than_inside_a_face(
    place: str, roughness: float
) -> None:
    """Along paths of texels over the place, their change differs from the truth's at most twice as much."""
    at_place, inside, truth = (bends(picture) for picture in levels(place, roughness))
    for across, usual, true in zip(at_place, inside, truth, strict=True):
        assert np.abs(across - true).max() < 2.0 * np.abs(usual - true).max()
        assert np.abs(across - true).max() < 0.15 * np.abs(true).max()
