"""Lists of Blender's own handlers: what is called, and when."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import bpy

Listeners = Iterable[tuple[str, Callable[..., None]]]
"""Names of lists in `bpy.app.handlers`, and what is called."""


def listen(listeners: Listeners) -> None:
    for name, listener in listeners:
        getattr(bpy.app.handlers, name).append(listener)


def stop_listening(listeners: Listeners) -> None:
    for name, listener in listeners:
        getattr(bpy.app.handlers, name).remove(listener)
