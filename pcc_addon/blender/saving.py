"""Saving the open file so that the one before survives whatever happens."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ..core.errors import PccError


def save_whole(path: Path) -> None:
    """Save the open file as `path`: written aside, read back, then moved into place.

    The file before becomes the usual backup where the user's preferences say so.

    Raises:
        PccError: it could not be written whole, as on a full disk; the file before is untouched.
    """
    aside = path.with_name(f".unfinished-{os.getpid()}-{path.name}")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(aside), copy=True)
        with bpy.data.libraries.load(str(aside)) as (_, _):  # Blender reports success where the disk was full
            pass
        if path.exists() and bpy.context.preferences.filepaths.save_version > 0:
            os.replace(path, f"{path}1")
        os.replace(aside, path)
    except (OSError, RuntimeError) as error:
        raise PccError(f"'{path}' cannot be saved ({_short(error)}); free space or choose another place") from error
    finally:
        aside.unlink(missing_ok=True)


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
