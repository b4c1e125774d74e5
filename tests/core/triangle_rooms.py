"""Rooms of triangles that are surveyed exactly, without a renderer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pcc_addon.core import equirect
from pcc_addon.core.accuracy.sampling import Triangles, make_of
from pcc_addon.core.cubemap import FACES, OVERSCAN, face_directions
from pcc_addon.core.probe import Box, ProbeSpec

RESOLUTION = 64
_SIDES = (  # corners of a cube's sides, by `numpy.ndindex`, counter-clockwise as seen from outside
    (0, 1, 3, 2),
    (4, 6, 7, 5),
    (0, 4, 5, 1),
    (2, 3, 7, 6),
    (0, 2, 6, 4),
    (1, 5, 7, 3),
)


def spec_of(matrix: np.ndarray, resolution: int = RESOLUTION, **settings: object) -> ProbeSpec:
    """A probe with a (4, 4) box-to-world matrix."""
    return ProbeSpec("Probe", Box.from_matrix("Probe", matrix), resolution=resolution, **settings)


def cuboid(centre: Sequence[float], half: Sequence[float], turn: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Corners (12, 3, 3) and vertices (12, 3) of a closed box, its sides out; turned about z."""
    c, s = np.cos(turn), np.sin(turn)
    signs = 2.0 * np.array(list(np.ndindex(2, 2, 2)), np.float64) - 1.0
    places = np.asarray(centre) + (signs * half) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    vertices = np.array([(a, b, c) for a, b, c, d in _SIDES] + [(a, c, d) for a, b, c, d in _SIDES])
    return places[vertices], vertices


def rectangle(centre: Sequence[float], u: Sequence[float], v: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Corners (2, 3, 3) and vertices (2, 3) of a flat sheet; its normal is along u × v, half edges."""
    c, u, v = (np.asarray(k, np.float64) for k in (centre, u, v))
    places = np.array([c - u - v, c + u - v, c + u + v, c - u + v])
    vertices = np.array([(0, 1, 2), (0, 2, 3)])
    return places[vertices], vertices


def scene(eye: np.ndarray, **meshes: tuple[np.ndarray, np.ndarray]) -> Triangles:
    """Meshes by name; the material has the name in lower case."""
    corners, owners, makes = [], [], []
    for k, (triangles, vertices) in enumerate(meshes.values()):
        make, over = make_of(triangles, vertices, eye)
        corners.append(triangles[:, ::-1] if over else triangles)
        owners.append(np.full(len(triangles), k))
        makes.append(np.full(len(triangles), make))
    names = tuple((name, name.lower()) for name in meshes)
    return Triangles(np.concatenate(corners), np.concatenate(owners), np.concatenate(makes), names)


def surveyed(spec: ProbeSpec, triangles: Triangles) -> np.ndarray:
    """(2n, 4n) float32 1/metres as a renderer would give them, by way of six faces; both sides of surfaces count."""
    faces = []
    for face in FACES:
        rays = face_directions(face, spec.resolution, OVERSCAN)
        rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
        faces.append(_nearest(spec.capture_point, rays, triangles.corners)[..., None].astype(np.float32))
    return equirect.from_faces(faces, OVERSCAN)[..., 0]


def _nearest(origin: np.ndarray, rays: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """1/metres along unit rays (…, 3), 0 where nothing is: T. Möller and B. Trumbore, 1997."""
    result = np.zeros(rays.shape[:-1])
    for a, b, c in corners:
        e, f = b - a, c - a
        p = np.cross(rays, f)
        det = p @ e
        good = np.abs(det) > 1e-12
        inverse = 1.0 / np.where(good, det, 1.0)
        s = origin - a
        u = (p @ s) * inverse
        q = np.cross(s, e)
        v = (rays @ q) * inverse
        t = (q @ f) * inverse
        hit = good & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (t > 1e-9)
        result = np.where(hit, np.maximum(result, 1.0 / np.where(hit, t, 1.0)), result)
    return result
