"""What the pictures show: two radiances that are known in every direction, and pictures filled with them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.picture_layouts.layouts import GUTTER, Layout
from pcc_addon.blender.bake.capture import OVERSCAN
from pcc_addon.core.cubemap import FACES, face_directions
from sample_blends.scenes import EMISSIVE_COLORS, EMISSIVE_ROOM

OVERSAMPLING = 4  # points across a texel, and across a pixel of a capture, whose mean is its value
AT_ONCE = 32  # rows of texels; more need more memory

Radiance = Callable[[np.ndarray], np.ndarray]  # world directions (..., 3), any length, to (..., 3) float32


def smooth(directions: np.ndarray) -> np.ndarray:
    """A radiance without edges: a wave for each channel, 0.5 … 1.5."""
    unit = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    waves = np.array([[6.0, 1.0, -2.0], [-1.0, 5.0, 3.0], [2.0, -3.0, 5.0]])
    return (1.0 + 0.5 * np.sin(unit @ waves.T + np.array([0.3, 1.1, 2.0]))).astype(np.float32)


def room(directions: np.ndarray) -> np.ndarray:
    """The emissive room seen from its centre: squares with hard edges. Its mirror floor is shown as dark as possible,
    with squares too."""
    half = np.array(EMISSIVE_ROOM.half_extents)
    local = np.asarray(directions, np.float64) @ np.array(EMISSIVE_ROOM.matrix.to_3x3())
    distance = half / np.maximum(np.abs(local), 1e-12)
    axis = distance.argmin(-1)
    hit = local * np.take_along_axis(distance, axis[..., None], -1)
    positive = np.take_along_axis(local, axis[..., None], -1)[..., 0] > 0
    result = np.empty(hit.shape, np.float32)
    for k, (name, right, up) in enumerate(_wall_frames()):
        here = (axis == k // 2) & (positive == (k % 2 == 0))
        bright, dark = EMISSIVE_COLORS.get(name, ((0.5, 0.5, 0.5), (0.1, 0.1, 0.1)))
        squares = sum(np.floor(hit[here] @ across + np.abs(across @ half)).astype(int) for across in (right, up))
        result[here] = np.where(squares[:, None] % 2 == 1, np.float32(bright), np.float32(dark))
    return result


def _wall_frames() -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Name, right and up of the walls +X −X +Y −Y +Z −Z, as `scenes.add_wall` lays their UVs."""
    frames = []
    for k in range(6):
        normal = np.zeros(3)
        normal[k // 2] = -1.0 if k % 2 == 0 else 1.0
        up = np.array([0.0, 0.0, 1.0]) if k // 2 != 2 else np.array([0.0, 1.0, 0.0])
        frames.append(("+-"[k % 2] + "XYZ"[k // 2], np.cross(up, normal), up))
    return frames


def fill(layout: Layout, radiance: Radiance) -> np.ndarray:
    """The picture (height, width, 3) float32 whose texels hold the mean of `radiance` over their area."""
    width, height = layout.size
    k = OVERSAMPLING
    blocks = []
    for start in range(0, height, AT_ONCE):
        stop = min(start + AT_ONCE, height)
        values = radiance(layout.directions(k, slice(k * start, k * stop)))
        blocks.append(values.reshape(stop - start, k, width, k, 3).mean((1, 3), dtype=np.float64))
    return np.concatenate(blocks).astype(np.float32)


def captured_faces(resolution: int) -> list[np.ndarray]:
    """What six cameras with a pixel-wide box filter see of the room, with the bake's overscan."""
    k, size = OVERSAMPLING, resolution + 2 * OVERSCAN
    faces = []
    for face in FACES:
        directions = face_directions(face, k * resolution, k * OVERSCAN)
        blocks = np.split(directions, range(AT_ONCE * k, size * k, AT_ONCE * k))
        faces.append(np.concatenate([room(block).reshape(-1, k, size, k, 3).mean((1, 3)) for block in blocks]))
    return faces


def atlas_of(faces: Sequence[np.ndarray]) -> np.ndarray:
    """The atlas of faces with the bake's overscan, not resampled."""
    cut = OVERSCAN - GUTTER
    cells = [face[cut : face.shape[0] - cut, cut : face.shape[1] - cut] for face in faces]
    return two_rows(cells)


def two_rows(cells: Sequence[np.ndarray]) -> np.ndarray:
    """Six arrays (n, n, ...) in one: a column for each axis, the positive face below the negative one."""
    return np.concatenate([np.concatenate(cells[0::2], 1), np.concatenate(cells[1::2], 1)])
