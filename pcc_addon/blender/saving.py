"""Saving the open file so that the one before survives whatever happens."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ..core.errors import PccError
from ..core.workplace import aside
from .store import leftovers


def save_whole(path: Path) -> None:
    """Save the open file as `path`: written aside, read back, then moved into place.

    The file before becomes the usual backup where the user's preferences say so. Pictures that no saved file shows any
    more are removed.

    Raises:
        PccError: it could not be written whole, as on a full disk; the file before is untouched.
    """
    unfinished = aside(path)
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(unfinished), copy=True)
        with bpy.data.libraries.load(str(unfinished)) as (_, _):  # Blender reports success where the disk was full
            pass
        if path.exists() and bpy.context.preferences.filepaths.save_version > 0:
            os.replace(path, f"{path}1")
        os.replace(unfinished, path)
    except (OSError, RuntimeError) as error:
        raise PccError(f"'{path}' cannot be saved ({_short(error)}); free space or choose another place") from error
    finally:
        unfinished.unlink(missing_ok=True)
    leftovers.after_save(path)


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
