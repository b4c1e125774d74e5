"""Cases: what one evaluation of the lookup is given, as the float32 numbers that a shader sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pcc_addon.core.effects.records import Correction

from .columns import Columns
from .digits import Numbers, float64, unit


@dataclass(frozen=True)
class Cases(Columns):
    """n evaluations of the lookup; all arrays are float32, in world space and metres.

    Attributes:
        position, incoming, normal: (n, 3) the shaded point, the unit vector to the eye, the shading normal.
        centre: (n, 3) the box's centre.
        face_normals: (n, 3, 3) a row for each pair of faces.
        half_widths: (n, 3) from the centre to each pair of faces.
        turn_mirror: (n, 3) where the correction is `TURNED_BOX`, the normal of the mirror that stands for the
            rotation; the face normals then follow from it and are not read.
        capture_point: (n, 3).
    """

    correction: Correction
    position: np.ndarray
    incoming: np.ndarray
    normal: np.ndarray
    centre: np.ndarray
    face_normals: np.ndarray
    half_widths: np.ndarray
    turn_mirror: np.ndarray
    capture_point: np.ndarray

    def inputs(self) -> dict[str, np.ndarray]:
        """By the names of the lookup's inputs."""
        return {
            "Position": self.position,
            "Incoming": self.incoming,
            "Normal": self.normal,
            "Box Centre": self.centre,
            **{f"Face Normal {axis}": self.face_normals[:, k] for k, axis in enumerate("XYZ")},
            "Half Widths": self.half_widths,
            "Turn Mirror": self.turn_mirror,
            "Capture Point": self.capture_point,
        }

    def exact_face_normals(self, numbers: Numbers = float64) -> np.ndarray:
        """(n, 3, 3): the normals that the given numbers mean."""
        if self.correction is not Correction.TURNED_BOX:
            return numbers(self.face_normals)
        mirror = unit(numbers(self.turn_mirror))
        return np.eye(3) - 2.0 * mirror[:, :, None] * mirror[:, None, :]
