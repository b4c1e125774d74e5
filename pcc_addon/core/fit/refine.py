"""The walls of a room to a fraction of a millimetre, from all that lies on them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from .cloud import Cloud
from .walls import Room, facing

_WIDTHS = (0.03, 0.015, 0.008, 0.004, 0.002, 0.002)  # metres around a wall, of what pulls at it, from step to step
_SHARP = 0.005  # metres: the first for walls that are sharp
_SPREAD = 4.0  # times the median distance of what lies on an uneven wall
_ONES = 0.005  # metres: what is so near to a wall is its own
_SNAP = 1e-4  # metres at a corner: a turn that moves it by less than this is none


def refined(cloud: Cloud, room: Room, leaning: bool) -> Room:
    """The room whose walls are nearest to what lies on them: robust least squares over turn and places at once.

    Each step solves for a small turn ω and the six distances c with Tukey's weights; on a wall (end, axis) with
    s = ±1 the residual is s a·x − c and its derivative by ω is s (a × x).

    Args:
        leaning: whether all three turns are sought, else only that about the vertical.
    """
    walls = [wall for wall in product(range(2), range(3)) if room.found[wall]]
    if not walls:
        return room
    for width in _WIDTHS:
        room = _step(cloud, room, walls, width, leaning)
    return _snapped(room)


def _step(cloud: Cloud, room: Room, walls: list[tuple[int, int]], width: float, leaning: bool) -> Room:
    axes = room.axes
    normals, positions = cloud.normals @ axes, cloud.positions
    matrix, vector = np.zeros((9, 9)), np.zeros(9)
    turns = np.eye(3) if leaning else axes[:, [room.upright]]
    for k, (end, axis) in enumerate(walls):
        sign = 1.0 if end else -1.0
        chosen = np.flatnonzero((cloud.areas > 0.0) & facing(normals, (end, axis)))
        chosen = chosen[_on_face(positions[chosen] @ axes, room, axis)]
        points = positions[chosen]
        off = sign * (points @ axes[:, axis] - room.ends[end, axis])
        widest = _SHARP if room.sharp[end, axis] else _WIDTHS[0]
        near = np.abs(off) < widest
        if not near.any():
            continue
        spread = _SPREAD * float(np.median(np.abs(off[near])))
        reach = min(max(width, spread), widest)
        weights = np.where(np.abs(off) < reach, (1.0 - (off / reach) ** 2) ** 2, 0.0) * cloud.areas[chosen]
        rows = np.zeros((len(points), 9))
        rows[:, : turns.shape[1]] = sign * np.cross(axes[:, axis], points) @ turns
        rows[:, 3 + k] = -1.0
        matrix += rows.T @ (rows * weights[:, None])
        vector -= rows.T @ (off * weights)
    solution = np.linalg.lstsq(matrix, vector, rcond=1e-12)[0]
    turn = turns @ solution[: turns.shape[1]]
    ends = room.ends.copy()
    for k, wall in enumerate(walls):
        ends[wall] += solution[3 + k] * (1.0 if wall[0] else -1.0)
    return replace(room, axes=_rotation(turn) @ axes, ends=ends)


def _on_face(positions: np.ndarray, room: Room, axis: int) -> np.ndarray:
    """(n,) bool: which positions (n, 3), along the axes, are within the other walls."""
    others = [k for k in range(3) if k != axis]
    where = positions[:, others]
    inwards = np.concatenate([where - room.ends[0, others], room.ends[1, others] - where], axis=1)
    nearest: np.ndarray = inwards.min(axis=1)
    return nearest >= -_ONES


def _rotation(turn: np.ndarray) -> np.ndarray:
    """(3, 3): Rodrigues' formula for a vector along the axis, radians long."""
    angle = float(np.linalg.norm(turn))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = turn / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)


def _snapped(room: Room) -> Room:
    """Axes that are the world's but for a tenth of a millimetre are the world's: shaders then spare the turn."""
    nearest = np.zeros((3, 3))
    order = np.abs(room.axes).argmax(0)
    nearest[order, range(3)] = np.sign(room.axes[order, range(3)])
    off = np.linalg.norm(room.axes - nearest, axis=0).max() * np.abs(room.ends).max()
    return replace(room, axes=nearest) if len(set(order)) == 3 and off < _SNAP else room


def area_on_walls(cloud: Cloud, room: Room) -> float:
    """Square metres of what is seen that lie on walls that were found."""
    normals, positions = cloud.normals @ room.axes, cloud.positions @ room.axes
    total = 0.0
    for end, axis in product(range(2), range(3)):
        if room.found[end, axis]:
            on = np.abs(positions[:, axis] - room.ends[end, axis]) < _ONES
            on &= facing(normals, (end, axis)) & _on_face(positions, room, axis)
            total += float(cloud.areas[on].sum())
    return total
