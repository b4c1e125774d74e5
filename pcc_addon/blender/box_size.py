"""The size of a probe's box in lengths, which is the scale of its object."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np


def size_of(settings: bpy.types.PropertyGroup) -> tuple[float, float, float]:
    """The lengths of the box's edges along its own axes, world space; constraints apart."""
    probe = settings.id_data
    x, y, z = 2.0 * probe.empty_display_size * _stretch(probe) * np.abs(probe.scale)
    return float(x), float(y), float(z)


def resize(settings: bpy.types.PropertyGroup, size: Sequence[float]) -> None:
    """Scale the object so that the box has such edges; what mirrors it still does, and what cannot be, stays."""
    probe = settings.id_data
    per_length = 2.0 * probe.empty_display_size * _stretch(probe)
    signs = np.where(np.array(probe.scale) < 0.0, -1.0, 1.0)
    possible = (np.array(size) > 0.0) & (per_length > 0.0)
    scale = np.divide(signs * size, per_length, out=np.array(probe.scale, np.float64), where=possible)
    probe.scale = scale.tolist()


def _stretch(probe: bpy.types.Object) -> np.ndarray:
    """(3,): how much longer parents and delta scales make each of the object's own axes."""
    turn = np.array(probe.matrix_basis.to_3x3().normalized())
    around = np.array((probe.parent.matrix_world @ probe.matrix_parent_inverse).to_3x3()) if probe.parent else np.eye(3)
    lengths = np.linalg.norm(around @ turn, axis=0)
    return np.where(lengths > 0.0, lengths, 1.0) * np.abs(probe.delta_scale)  # an axis of scale 0 has no direction
