"""The pictures of a misfit as files."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from ..errors import PccError
from ..sidecar import file_stem
from ..workplace import aside
from .misfit import Misfit
from .misfit_pictures import all_around, cross, unseen_around
from .png import png_of_bytes
from .unseen import Unseen


def write_pictures(found: Misfit, hidden: Unseen, folder: Path) -> list[Path]:
    """Write a probe's pictures into a folder, which is made where it is not there; returns their paths.

    These are the misfit all around and on the six faces, and what is not seen.

    Raises:
        PccError: one cannot be written; a file that was there before is as it was.
    """
    stem = file_stem(found.spec.name, found.spec.name)
    pictures = {"misfit": all_around(found), "faces": cross(found), "unseen": unseen_around(found, hidden)}
    paths = []
    for kind, picture in pictures.items():
        paths.append(folder / f"{stem}.{kind}.png")
        _write(paths[-1], png_of_bytes(picture))
    return paths


def _write(path: Path, content: bytes) -> None:
    part = aside(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(content)
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise PccError(
            f"'{path}' cannot be written ({error.strerror}); free space, or choose another folder"
        ) from error
