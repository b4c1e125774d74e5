"""A probe's last bake, small enough to be looked at in a panel."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..core.errors import BakeError
from ..core.thumbnails import chrome_ball, reduced, unfolded
from .read.probes import bake_record
from .store.pictures import read_file, read_pixels

_ROWS = 256  # of the picture that they are made of
_BALL, _FACE = 192, 64  # pixels across


@dataclass(frozen=True, eq=False)
class SmallCapture:
    """A bake's capture, small.

    Attributes:
        picture: (h, 2h, 3) float32 linear, equirectangular, row 0 at the bottom.
        faces: those that were captured, by name.
    """

    picture: np.ndarray
    faces: tuple[str, ...]

    @property
    def ball(self) -> np.ndarray:
        """(n, n, 4) float32: as a chrome ball, sRGB with alpha, row 0 at the bottom."""
        return chrome_ball(self.picture, _BALL)

    @property
    def cross(self) -> np.ndarray:
        """(3m, 4m, 4) float32: as six unfolded faces, likewise."""
        return unfolded(self.picture, _FACE, self.faces)


def small_capture(probe: bpy.types.Object) -> SmallCapture:
    """What a probe's bake shows; of a sequence, its first picture.

    Raises:
        BakeError: there is none, or it cannot be read.
    """
    record = bake_record(probe)
    level = next((level for level in probe.pcc_probe.levels if level.roughness == 0.0), None)
    if record is None or level is None or level.image is None:
        raise BakeError(f"probe '{probe.name}' has no picture to show; bake it")
    return SmallCapture(reduced(_pixels(level.image), _ROWS), record.faces)


def _pixels(image: bpy.types.Image) -> np.ndarray:
    if image.source == "SEQUENCE":
        path = Path(bpy.path.abspath(image.filepath))
        if not path.is_file():
            raise BakeError(f"picture '{path}' is missing; bake its probe again")
        return read_file(path)
    was_read = image.has_data
    try:
        return read_pixels(image)
    finally:
        if not was_read:
            image.buffers_free()  # shaders keep what they need, and this may be half a gigabyte
