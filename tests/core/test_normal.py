"""Perturbed normals: those whose reflection leaves the surface stay, the others are bent as little as it takes."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.normal import VALID_NORMAL

from .boxes import directions, unit

COUNT = 4000


@pytest.fixture(scope="module")
def cases() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(n, 3) each: true normals, eyes above the surface, shading normals up to a right angle from the true ones."""
    rng = np.random.default_rng(7)
    true, eye, lean = (directions(COUNT, rng) for _ in range(3))
    eye *= np.sign((eye * true).sum(-1, keepdims=True))
    return true, eye, unit(true + lean * rng.uniform(0.0, 0.99, (COUNT, 1)))


def bent(true: np.ndarray, eye: np.ndarray, normal: np.ndarray, dtype: type = np.float64) -> np.ndarray:
    return evaluate(VALID_NORMAL.outputs, {"True Normal": true, "Incoming": eye, "Normal": normal}, dtype)["Normal"]


def heights(true: np.ndarray, eye: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far reflected unit rays rise over the surface, and how far they must."""
    ray = 2.0 * (normal * eye).sum(-1, keepdims=True) * normal - eye
    return (ray * true).sum(-1), np.minimum(0.9 * (eye * true).sum(-1), 0.01)


def test_every_reflection_leaves_the_surface(cases) -> None:
    true, eye, normal = cases
    found = bent(true, eye, normal)
    np.testing.assert_allclose(np.linalg.norm(found, axis=-1), 1.0, atol=1e-9)
    rises, least = heights(true, eye, found)
    assert (rises >= least - 1e-9).all()


def test_only_what_would_go_below_is_bent_and_no_farther_than_it_takes(cases) -> None:
    true, eye, normal = cases
    found = bent(true, eye, normal)
    below = np.subtract(*heights(true, eye, normal)) < 0.0
    assert 0.02 < below.mean() < 0.9
    np.testing.assert_allclose(found[~below], normal[~below], atol=1e-15)
    rises, least = heights(true, eye, found)
    np.testing.assert_allclose(rises[below], least[below], atol=1e-9)
    across = np.cross(true, normal)
    np.testing.assert_allclose((found * across).sum(-1), 0.0, atol=1e-12)
    assert ((found * true).sum(-1)[below] >= (normal * true).sum(-1)[below] - 1e-12).all(), "towards the true normal"


def test_single_precision_is_enough(cases) -> None:
    true, eye, normal = cases
    sure = np.abs(np.subtract(*heights(true, eye, normal))) > 1e-5
    found = bent(true, eye, normal, np.float32)
    assert np.isfinite(found).all()
    rises, least = heights(true, eye, found.astype(np.float64))
    assert (rises >= least - 2e-3)[sure].all()


def test_a_surface_without_lean_is_left_alone() -> None:
    rng = np.random.default_rng(8)
    true, eye = directions(100, rng), directions(100, rng)
    eye *= np.sign((eye * true).sum(-1, keepdims=True))
    np.testing.assert_array_equal(bent(true, eye, true), true)
