"""Checks bakes by itself while nobody does anything, where that takes no time.

A check reads all objects and materials. It is made once the scene has been left alone for a moment, by a timer: never
while panels are drawn, in a modal tool, in another mode than Object Mode, while something is rendered or played.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import bpy

from ...blender import handlers
from ...blender.listening import listen, stop_listening
from ...blender.read.frames import frames_of
from ...blender.read.probes import all_probes
from ...blender.writing import APART
from . import last_plan, states
from .changes import may_matter

QUIET = 0.8
"""Seconds without a change after which bakes are checked."""

UNNOTICED = 0.5
"""Seconds that a check may take which nobody asked for."""

MOST_POLYGONS, MOST_OBJECTS = 500_000, 2_000
"""Scenes with more are not checked unasked as long as nobody knows how long that takes."""

_changed = 0.0  # when something was changed last, by the monotonic clock


def expect() -> None:
    """Something was changed: check once nothing is going on any more."""
    global _changed
    _changed = time.monotonic()
    if not bpy.app.background and not bpy.app.timers.is_registered(check_when_idle):
        bpy.app.timers.register(check_when_idle, first_interval=QUIET, persistent=True)


def check_when_idle() -> float | None:
    """Check the scenes that are open; returns after how many seconds to try again, None where that is done."""
    left = _changed + QUIET - time.monotonic()
    if left > 0.0 or _is_busy():
        return max(left, 0.1)
    for scene, view_layer in _open_scenes():
        if states.all_late(scene) and checks_quickly(scene):
            last_plan.check(scene, view_layer)
    return None


def checks_quickly(scene: bpy.types.Scene) -> bool:
    """Whether a scene has probes and can be checked without anybody noticing, as far as that is known."""
    probes = all_probes(scene)
    if not probes or any(frames_of(probe) for probe in probes):  # their frames are gone through
        return False
    took = states.seconds(scene)
    if took is not None:
        return took <= UNNOTICED
    if len(scene.objects) > MOST_OBJECTS:
        return False
    meshes = {item.data for item in scene.objects if item.type == "MESH"}
    return sum(len(mesh.polygons) for mesh in meshes) <= MOST_POLYGONS


def _open_scenes() -> Iterator[tuple[bpy.types.Scene, bpy.types.ViewLayer]]:
    seen = set()
    for window in bpy.context.window_manager.windows:
        if window.scene not in seen:
            seen.add(window.scene)
            yield window.scene, window.view_layer


def _is_busy() -> bool:
    windows = bpy.context.window_manager.windows
    modal = (operator.bl_idname for window in windows for operator in window.modal_operators)
    active = [window.view_layer.objects.active for window in windows]
    return (
        handlers.is_paused()
        or any(name not in APART for name in modal)
        or any(item is not None and item.mode != "OBJECT" for item in active)
        or any(window.screen.is_animation_playing for window in windows)
        or bpy.app.is_job_running("RENDER")
    )


@bpy.app.handlers.persistent
def on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if not handlers.is_paused() and may_matter(depsgraph):
        expect()


@bpy.app.handlers.persistent
def on_other(*_: object) -> None:
    """Undo, redo, another file."""
    expect()


_HANDLERS = (
    ("depsgraph_update_post", on_update),
    ("undo_post", on_other),
    ("redo_post", on_other),
    ("load_post", on_other),
)


def register() -> None:
    listen(_HANDLERS)
    expect()  # a file may be open


def unregister() -> None:
    stop_listening(_HANDLERS)
    if bpy.app.timers.is_registered(check_when_idle):
        bpy.app.timers.unregister(check_when_idle)
