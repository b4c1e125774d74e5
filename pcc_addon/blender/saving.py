"""Saving the open file so that the one before survives whatever happens."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ..core.errors import PccError
from ..core.workplace import aside, discard, link, on_disk
from .store import leftovers

_OF_WINDOWS = {"screens", "workspaces", "version"}  # which need not be saved, and the file's version


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
        with bpy.data.libraries.load(str(unfinished)) as (held, _):  # Blender reports success where the disk was full
            lost = _lost(held)
        if lost:
            raise OSError(f"{lost} is not in what was written")
        on_disk(unfinished)
        if path.exists() and bpy.context.preferences.filepaths.save_version > 0:
            _keep_backup(path)
        os.replace(unfinished, path)
    except (OSError, RuntimeError) as error:
        raise PccError(f"'{path}' cannot be saved ({_short(error)}); free space or choose another place") from error
    finally:
        discard(unfinished)
    leftovers.after_save(path)


def _lost(held: object) -> str:
    """A data block that a saved file should hold and does not, as where one write failed and those after it did not.

    Args:
        held: the names in the file, by kind, as Blender lists them.
    """
    for kind in set(dir(held)) - _OF_WINDOWS:
        names = set(getattr(held, kind))
        for block in getattr(bpy.data, kind):
            if block.users and not block.library and not block.is_runtime_data and block.name not in names:
                return f"'{block.name}' of {kind}"
    return ""


def _keep_backup(path: Path) -> None:
    """Let the file be its backup as well, so that at no moment there is none of its name."""
    backup = aside(path)
    try:
        link(path, backup)
        os.replace(backup, f"{path}1")
    finally:
        discard(backup)


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
