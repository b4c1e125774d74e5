"""Boxes and directions to test with."""

from __future__ import annotations

import numpy as np

KINDS = ("unrotated", "rotated", "mirrored", "sheared")


def rotation(rng: np.random.Generator) -> np.ndarray:
    """A random (3, 3) matrix with orthonormal columns and determinant +1."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def matrix(kind: str, rng: np.random.Generator, centre: tuple[float, float, float] = (3.0, -2.0, 1.5)) -> np.ndarray:
    """A (4, 4) box-to-world matrix with half extents between 0.5 and 4 m (longer where sheared)."""
    m = np.eye(4)
    m[:3, :3] = np.diag(rng.uniform(0.5, 4.0, 3))
    if kind == "sheared":
        m[:3, :3] = (np.eye(3) + np.triu(rng.uniform(-0.8, 0.8, (3, 3)), 1)) @ m[:3, :3]
    if kind != "unrotated":
        m[:3, :3] = rotation(rng) @ m[:3, :3]
    if kind == "mirrored":
        m[:3, 0] *= -1.0
    m[:3, 3] = centre
    return m


def unit(v: np.ndarray) -> np.ndarray:
    """Vectors (…, 3) of length 1; the zero vector stays zero."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.divide(v, length, out=np.zeros_like(v), where=length > 0)


def directions(count: int, rng: np.random.Generator) -> np.ndarray:
    """(count, 3) unit vectors, uniform on the sphere."""
    return unit(rng.normal(size=(count, 3)))


def inside(m: np.ndarray, count: int, rng: np.random.Generator, reach: float = 0.999) -> np.ndarray:
    """(count, 3) world-space points within `reach` of the box's half edges."""
    return m[:3, 3] + rng.uniform(-reach, reach, (count, 3)) @ m[:3, :3].T
