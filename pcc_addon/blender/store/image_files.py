"""Pictures that users give: any image format that Blender reads, as scene-linear radiance."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np

from ...core import layouts, radiance
from ...core.errors import BakeError, ProbeError
from ...core.picture_files import missing_faces
from ..overrides import temporary
from .pictures import read_pixels


def read_cubemap(files: Sequence[Path], resolution: int) -> tuple[np.ndarray, tuple[str, ...]]:
    """The equirectangular picture (2n, 4n, 3) float32 of one file in any layout, or of six faces in engines' order.

    Args:
        files: one, or six.
        resolution: n, pixels across a face.

    Returns:
        The picture, and a sentence for each file with pixels that no picture should hold, which are replaced.

    Raises:
        ProbeError: a file cannot be read, or has no layout that is known.
    """
    found, notes = [], []
    for file in files:
        pixels, note = radiance.clean_whole(file.name, read_linear(file))
        found.append(pixels)
        notes += [note] if note else []
    if len(files) == 6:
        faces = layouts.six_faces(found, [file.name for file in files])
        return layouts.from_faces(faces, resolution), tuple(notes)
    height, width = found[0].shape[:2]
    lacking = missing_faces(files[0])
    if width == height and lacking:
        raise ProbeError(
            f"picture '{files[0].name}': {width}×{height} pixels is one of six faces; beside it there is no "
            f"{', '.join(lacking)}"
        )
    layout = layouts.layout_of(files[0].name, width, height)
    return layouts.from_picture(found[0], layout, resolution), tuple(notes)


def read_linear(file: Path) -> np.ndarray:
    """(height, width, 3) float32 scene-linear, row 0 at the bottom; transparency is ignored.

    Blender makes pictures of more than 8 bits linear as it reads them; those of 8 bits are sRGB.

    Raises:
        ProbeError: Blender cannot read it as an image.
    """
    with ExitStack() as stack:
        try:
            image = temporary(stack, bpy.data.images, bpy.data.images.load(str(file)))
            image.alpha_mode = "NONE"
            pixels = read_pixels(image)
        except (RuntimeError, BakeError) as error:
            raise ProbeError(
                f"picture '{file}' cannot be read: it is damaged, or no image of one layer; give one that Blender opens"
            ) from error
        return pixels if image.is_float else radiance.linear_of_srgb(pixels)
