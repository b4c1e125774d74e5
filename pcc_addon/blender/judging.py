"""What viewports show to judge probes by: lookups without parallax, or materials without probes.

A few switches in the open file say so, and only while somebody looks: what is saved, rendered, baked or measured is
always corrected, and so is what is opened. Undo brings the switches back as they were then; they are set anew.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from enum import Enum

import bpy

from .listening import listen, stop_listening
from .shade import groups, twin


class View(str, Enum):
    """What is shown of probes."""

    CORRECTED = "CORRECTED"  # as files and renders have it
    UNCORRECTED = "UNCORRECTED"  # the classic lookup
    OFF = "OFF"  # the materials' own reflections


_view = View.CORRECTED
_held: set[object] = set()  # for what all is corrected at present, whatever is to be shown
_SAVE, _RENDER = "save", "render"


def view() -> View:
    """What viewports are to show."""
    return _view


def show(wanted: View) -> None:
    """Let viewports show something else; EEVEE compiles its shaders anew, nothing else takes time."""
    global _view
    _view = wanted
    _set()


@contextlib.contextmanager
def corrected() -> Iterator[None]:
    """All is as files and renders have it meanwhile."""
    reason = object()
    _hold(reason)
    try:
        yield
    finally:
        _let_go(reason)


def _hold(reason: object) -> None:
    before = _shown()
    _held.add(reason)
    if before is not _shown():
        _set()


def _let_go(reason: object) -> None:
    before = _shown()
    _held.discard(reason)
    if before is not _shown():
        _set()


def _shown() -> View:
    return View.CORRECTED if _held else _view


def _set() -> None:
    """Set every switch that is not as it is to be."""
    shown = _shown()
    for node in groups.parallax_nodes():
        if node.mute != (shown is View.UNCORRECTED):
            node.mute = shown is View.UNCORRECTED
    for material in bpy.data.materials:
        twin.let_stand_in(material, shown is not View.OFF)


@bpy.app.handlers.persistent
def on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """What is injected or built anew meanwhile is shown in the same way."""
    if _view is View.CORRECTED or _held:
        return
    if any(isinstance(update.id, bpy.types.ShaderNodeTree) for update in depsgraph.updates):
        _set()


@bpy.app.handlers.persistent
def on_undo(*_: object) -> None:
    _set()


@bpy.app.handlers.persistent
def before_save(*_: object) -> None:
    _hold(_SAVE)


@bpy.app.handlers.persistent
def after_save(*_: object) -> None:
    _let_go(_SAVE)


@bpy.app.handlers.persistent
def before_render(*_: object) -> None:
    """Before its renderer reads the scene; it may be that this is another thread than the window's."""
    if bpy.app.timers.is_registered(_after_render):  # of the render before
        bpy.app.timers.unregister(_after_render)
    _hold(_RENDER)


@bpy.app.handlers.persistent
def after_render(*_: object) -> None:
    if bpy.app.background:
        _after_render()
    else:  # in the window's own thread
        bpy.app.timers.register(_after_render)


def _after_render() -> None:
    _let_go(_RENDER)


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    """The file may be what was left of a session that ended in the middle of it."""
    global _view
    _view = View.CORRECTED
    _held.clear()
    _set()


_HANDLERS = (
    ("depsgraph_update_post", on_update),
    ("undo_post", on_undo),
    ("redo_post", on_undo),
    ("save_pre", before_save),
    ("save_post", after_save),
    ("save_post_fail", after_save),
    ("render_init", before_render),
    ("render_complete", after_render),
    ("render_cancel", after_render),
    ("load_post", on_load),
)


def register() -> None:
    listen(_HANDLERS)


def unregister() -> None:
    stop_listening(_HANDLERS)
    if bpy.app.timers.is_registered(_after_render):
        bpy.app.timers.unregister(_after_render)
    _held.clear()
    show(View.CORRECTED)
