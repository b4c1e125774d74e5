"""Which way a room may be turned: candidates, from the normals of what is seen."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from .cloud import Cloud

_UPRIGHT = 0.1  # a normal with a smaller component along the vertical is a wall's
_BINS, _WIDE = 360, 4  # of a quarter turn; how many of them are one peak
_PEAKS, _LEAST = 4, 0.2  # how many turns are tried, and how strong they must be over the strongest
_WINDOWS = (4.0, 1.5, 0.5)  # degrees: around a turn, of the normals that refine it
_UNSURE = 0.5  # where a second naming of axes fits so nearly as well as the first, both are tried


def own_axes(axes: np.ndarray) -> np.ndarray:
    """(3, 3) orthonormal columns nearest to the columns of (3, 3) `axes`, as long as they are; mirrored as they are."""
    left, _, right = np.linalg.svd(axes / np.linalg.norm(axes, axis=0))
    return left @ right


def upright_frames(cloud: Cloud, start: np.ndarray, up: np.ndarray) -> list[np.ndarray]:
    """Frames (3, 3), columns: axes, one of them `up`, the others as many walls face; the likeliest first.

    Args:
        start: (3, 3) columns: the axes that were drawn; new ones are named after those that are nearest.
        up: (3,) unit.
    """
    first = start[:, np.argmin(np.abs(up @ start))]
    first = first - up * (first @ up)
    first = first / np.linalg.norm(first)
    second = np.cross(up, first)
    wall = (cloud.areas > 0.0) & (np.abs(cloud.normals @ up) < _UPRIGHT)
    normals, weights = cloud.normals[wall], cloud.areas[wall]
    angles = np.degrees(np.arctan2(normals @ second, normals @ first)) % 90.0
    frames = []
    for turn in _peaks(angles, weights):
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        frames += named_after(np.stack([c * first + s * second, c * second - s * first, up], 1), start)
    return frames or named_after(np.stack([first, second, up], 1), start)


def leaning_frame(cloud: Cloud, frame: np.ndarray) -> np.ndarray:
    """The frame (3, 3) near another that normals of any tilt call for: each pulls at the axis that it is nearest to."""
    for degrees in (12.0, 6.0, 2.0, 1.0):
        along = cloud.normals @ frame
        axis = np.abs(along).argmax(-1)
        cosine = np.take_along_axis(along, axis[:, None], 1)[:, 0]
        near = np.abs(cosine) > np.cos(np.radians(degrees))
        signed = cloud.normals * np.sign(cosine)[:, None]
        pulls = [(signed[k] * cloud.areas[k, None]).sum(0) for k in (near & (axis == a) for a in range(3))]
        # Equal say for each axis that anything is seen of: a long wall shall not outweigh the floor.
        sums = np.stack(
            [p / np.linalg.norm(p) if np.linalg.norm(p) > 0.0 else frame[:, a] for a, p in enumerate(pulls)], 1
        )
        left, _, right = np.linalg.svd(sums)
        frame = left @ right
    return frame


def named_after(frame: np.ndarray, start: np.ndarray) -> list[np.ndarray]:
    """The same axes in the order and with the signs of those of `start` that they are nearest to.

    Two, where half way between.
    """
    likeness = frame.T @ start
    orders = sorted(permutations(range(3)), key=lambda order: -sum(abs(likeness[order[k], k]) for k in range(3)))
    scores = [sum(abs(likeness[order[k], k]) for k in range(3)) for order in orders]
    found = []
    for order, score in zip(orders, scores, strict=True):
        along = likeness[list(order), range(3)]
        named = frame[:, list(order)] * np.where(along >= 0.0, 1.0, -1.0)
        if np.linalg.det(named) * np.linalg.det(start) < 0.0:  # half way between: the least certain sign is the other
            named[:, np.abs(along).argmin()] *= -1.0
        if score >= scores[0] - _UNSURE:
            found.append(named)
    return found[:2]


def _peaks(angles: np.ndarray, weights: np.ndarray) -> list[float]:
    """Degrees, 0 … 90, at which most weight is, the heaviest first."""
    if not len(angles):
        return []
    counts = np.bincount((angles * (_BINS / 90.0)).astype(np.intp) % _BINS, weights, _BINS)
    smooth = np.sum([np.roll(counts, k) * (_WIDE + 1 - abs(k)) for k in range(-_WIDE, _WIDE + 1)], axis=0)
    local = (smooth >= np.roll(smooth, 1)) & (smooth > np.roll(smooth, -1)) & (smooth >= _LEAST * smooth.max())
    order = sorted(np.flatnonzero(local), key=lambda k: (-smooth[k], k))[:_PEAKS]
    return [_refined((k + 0.5) * 90.0 / _BINS, angles, weights) for k in order]


def _refined(turn: float, angles: np.ndarray, weights: np.ndarray) -> float:
    for window in _WINDOWS:
        off = (angles - turn + 45.0) % 90.0 - 45.0
        near = np.abs(off) < window
        if weights[near].sum() > 0.0:
            turn += float((off[near] * weights[near]).sum() / weights[near].sum())
    return turn
