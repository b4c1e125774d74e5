"""Small pictures of probes' bakes as icons: made once for each bake, never while something is drawn.

A timer makes them, in three steps each (the capture, the ball, the cross), so that nobody notices.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import bpy.utils.previews
import numpy as np

from ...blender import handlers
from ...blender.read.probes import bake_record
from ...blender.thumbnails import small_capture
from ...core.errors import PccError
from .redrawing import redraw

_ENDED = object()
_AGAIN = 0.5  # seconds until the next try where pictures cannot be read now


@dataclass(frozen=True)
class Icons:
    """What panels show of a bake.

    Attributes:
        ball, cross: icon values of a chrome ball and of the unfolded faces; None where the capture cannot be read.
    """

    ball: int | None
    cross: int | None


@dataclass(frozen=True)
class _Made:
    bake: str  # of which
    icons: Icons


_collection: bpy.utils.previews.ImagePreviewCollection | None = None
_made: dict[int, _Made] = {}  # by the probe's session uid
_wanted: dict[int, str] = {}  # likewise, of which bake
_going: Iterator[None] | None = None  # the steps of those that are being made


def of(probe: bpy.types.Object) -> Icons | None:
    """What to show of a probe's bake; None where it has none, or where that is not made yet, which is seen to."""
    bake, uid = _bake(probe), probe.session_uid
    known = _made.get(uid)
    if known is not None and known.bake == bake:
        return known.icons
    if bake:
        _wanted[uid] = bake
        if not bpy.app.timers.is_registered(make):
            bpy.app.timers.register(make, first_interval=0.0)
    return None


def make() -> float | None:
    """Take the next step; returns after how many seconds to go on, None where all is made."""
    global _going
    if handlers.is_paused():
        return _AGAIN
    if _going is None:
        _going = _next()
    if next(_going, _ENDED) is _ENDED:
        _going = None
    return 0.0 if _going is not None or _wanted else None


def _next() -> Iterator[None]:
    """Let go of what is not needed any more, and make what is wanted next."""
    probes = {probe.session_uid: probe for probe in bpy.data.objects if probe.session_uid in _wanted | _made}
    for uid in [uid for uid in _made if uid not in probes or not _bake(probes[uid])]:
        _drop(uid)
    while _wanted:
        uid, bake = _wanted.popitem()
        if uid in probes and _bake(probes[uid]) == bake:
            yield from _make(uid, bake, probes[uid])
            return


def _make(uid: int, bake: str, probe: bpy.types.Object) -> Iterator[None]:
    """No data block is held from one step to the next."""
    icons = Icons(None, None)
    _drop(uid)
    with contextlib.suppress(PccError):  # status tells
        capture = small_capture(probe)
        yield
        ball = _icon(f"{uid} ball", capture.ball)
        yield
        icons = Icons(ball, _icon(f"{uid} cross", capture.cross))
    _made[uid] = _Made(bake, icons)
    redraw()


def forget() -> None:
    """Forget all."""
    global _going
    _going = None
    _wanted.clear()
    _made.clear()
    _collection.clear()


def _bake(probe: bpy.types.Object) -> str:
    """What tells a bake from another; empty where there is none."""
    with contextlib.suppress(PccError):  # status tells
        record = bake_record(probe)
        if record is not None and record.levels:
            return f"{record.levels[0].file} {record.levels[0].digest} {record.faces}"
    return ""


def _icon(name: str, picture: np.ndarray) -> int:
    height, width = picture.shape[:2]
    preview = _collection.new(name)
    preview.image_size = (width, height)
    preview.image_pixels_float.foreach_set(picture.ravel())
    return preview.icon_id


def _drop(uid: int) -> None:
    _made.pop(uid, None)
    for name in [name for name in _collection if name.startswith(f"{uid} ")]:
        del _collection[name]


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    forget()


def register() -> None:
    global _collection
    _collection = bpy.utils.previews.new()
    bpy.app.handlers.load_pre.append(on_load)


def unregister() -> None:
    global _collection
    bpy.app.handlers.load_pre.remove(on_load)
    if bpy.app.timers.is_registered(make):
        bpy.app.timers.unregister(make)
    forget()
    bpy.utils.previews.remove(_collection)
    _collection = None
