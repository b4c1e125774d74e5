"""The last measurement of costs of the open file, as it was written beside it."""

from __future__ import annotations

import contextlib
from pathlib import Path

import bpy

from ...blender.accuracy.applying import results_folder
from ...core.accuracy import files
from ...core.accuracy.advice import Advice, advice
from ...core.accuracy.records import CostReport
from ...core.errors import PccError

_known: dict[Path, tuple[float, CostReport, Advice]] = {}  # by folder, with the time of the file that was read


def folder() -> Path | None:
    """Where its results are, or None where it is not saved."""
    return results_folder(Path(bpy.data.filepath)) if bpy.data.filepath else None


def of_file() -> tuple[CostReport, Advice] | None:
    """What was found of the open file, read again when it has changed; None where that is nothing."""
    place = folder()
    try:
        time = (place / files.JSON_NAME).stat().st_mtime if place is not None else None
    except OSError:
        return None
    if time is None:
        return None
    if place not in _known or _known[place][0] != time:
        _known.pop(place, None)
        with contextlib.suppress(PccError):  # a damaged file; the next measurement writes another
            report = files.read(place)
            if report is not None:
                _known[place] = (time, report, advice(report))
    return _known[place][1:] if place in _known else None
