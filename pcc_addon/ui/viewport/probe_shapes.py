"""What the viewport shows of a probe, as plain lines: its box, its influence and falloff, its capture point."""

from __future__ import annotations

from itertools import product

import numpy as np

from ...core.probe import ProbeSpec

_DASHES = 24  # along an edge of the border where the probe has faded
_MARK = 0.06  # of the least half width: how large the capture point is drawn
_SAME = 1e-4  # metres between borders that are one
_CORNERS = np.array(list(product((0, 1), repeat=3)))
_EDGES = np.array([(a, b) for a in range(8) for b in range(a) if np.abs(_CORNERS[a] - _CORNERS[b]).sum() == 1])

Lines = np.ndarray
"""(2n, 3) float32, world space, metres: the ends of n lines."""


def box(spec: ProbeSpec) -> Lines:
    """The edges of the box."""
    return _edges(_corners(spec, np.zeros((2, 3))))


def influence(spec: ProbeSpec) -> Lines:
    """The border up to which the probe is shown in full; nothing where that is the box, or the box's padding."""
    reach = np.array([spec.influence.low, spec.influence.high])
    if not spec.corrected or np.abs(reach).max() < _SAME:
        return _none()
    return _edges(_corners(spec, spec.influence_reach))


def falloff(spec: ProbeSpec) -> Lines:
    """The border where it has faded, in dashes, and from each corner the way that it fades on."""
    if not spec.corrected:
        return _none()
    full, faded = _corners(spec, spec.influence_reach), _corners(spec, spec.fading_reach)
    if np.abs(faded - full).max() < _SAME:
        return _none()
    ends = faded[_EDGES]
    steps = (np.arange(_DASHES) + np.array([[0.25], [0.75]])).T.ravel() / _DASHES
    dashes = ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * steps[None, :, None]
    return _lines(np.concatenate([dashes.reshape(-1, 3), np.stack([full, faded], 1).reshape(-1, 3)]))


def capture_point(spec: ProbeSpec) -> Lines:
    """A small octahedron along the box's axes, and a line to what it follows."""
    point = spec.capture_point
    tips = spec.box.face_normals * (_MARK * float(spec.box.half_widths.min()))
    ends = [
        (point + one * tips[a], point + other * tips[b])
        for a, b in ((0, 1), (1, 2), (2, 0))
        for one, other in product((-1.0, 1.0), repeat=2)
    ]
    if spec.followed is not None:
        ends.append((point, np.array(spec.followed)))
    return _lines(np.array(ends).reshape(-1, 3))


def _corners(spec: ProbeSpec, reach: np.ndarray) -> np.ndarray:
    """(8, 3) world space: of the box with its low and high faces moved outwards by (2, 3) metres."""
    low, high = -spec.box.half_widths - reach[0], spec.box.half_widths + reach[1]
    return spec.box.centre + np.where(_CORNERS == 1, high, low) @ np.linalg.inv(spec.box.face_normals).T


def _edges(corners: np.ndarray) -> Lines:
    return _lines(corners[_EDGES].reshape(-1, 3))


def _lines(ends: np.ndarray) -> Lines:
    return np.ascontiguousarray(ends, np.float32)


def _none() -> Lines:
    return np.zeros((0, 3), np.float32)
