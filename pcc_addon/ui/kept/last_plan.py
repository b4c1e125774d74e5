"""The last plan of each scene, for panels: they are drawn many times a second, and a plan may take seconds."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy

from ...blender import handlers, properties
from ...blender.listening import listen, stop_listening
from ...blender.planning import plan_scene
from ...blender.status import ProbeStatus, planned_statuses
from ...core.decisions import Effect
from ...core.plan import Plan
from . import states
from .changes import may_matter
from .redrawing import redraw

AT_ONCE = 1.0  # seconds: what takes no longer is planned anew after each choice, without being asked


@dataclass(frozen=True)
class LastPlan:
    """What was planned.

    Attributes:
        plan: it.
        seconds: how long planning took.
        late: whether the scene was changed since.
    """

    plan: Plan
    seconds: float = 0.0
    late: bool = False


_plans: dict[int, LastPlan] = {}  # by session uid


def of(scene: bpy.types.Scene) -> LastPlan | None:
    """The last plan of a scene, or None where none was made since the file was opened."""
    return _plans.get(scene.session_uid)


def keep(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, plan: Plan) -> None:
    """Keep a plan that was made and obeyed; what obeying it changed does not make it late."""
    view_layer.update()
    _keep(scene, plan)


def make(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Plan:
    """Plan a scene and keep that."""
    view_layer.update()
    started = time.monotonic()
    plan = plan_scene(scene, view_layer)
    _keep(scene, plan, seconds=time.monotonic() - started)
    return plan


def check(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Sequence[ProbeStatus]:
    """How a scene's probes stand, which is kept with their plan."""
    view_layer.update()
    started = time.monotonic()
    plan, found = planned_statuses(scene, view_layer)
    took = time.monotonic() - started
    view_layer.update()  # sequences were gone through
    states.keep(scene, found, took)
    _keep(scene, plan)
    return found


def forget() -> None:
    """Forget all plans."""
    _plans.clear()
    states.forget()


def _keep(scene: bpy.types.Scene, plan: Plan, seconds: float | None = None) -> None:
    before = of(scene)
    if seconds is None:
        seconds = before.seconds if before is not None else 0.0
    _plans[scene.session_uid] = LastPlan(plan, seconds)
    redraw()


def _call_late(scene: bpy.types.Scene) -> None:
    states.call_late(scene)
    last = of(scene)
    if last is not None and not last.late:
        _plans[scene.session_uid] = replace(last, late=True)
        redraw()


@bpy.app.handlers.persistent
def on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """A change that a plan may depend on makes it late; another selection does not."""
    last = of(scene)
    if last is None or (last.late and states.all_late(scene)) or handlers.is_paused():
        return
    if may_matter(depsgraph):
        _call_late(scene)


@bpy.app.handlers.persistent
def on_time_travel(scene: bpy.types.Scene, *_: object) -> None:
    """What an undo or redo brings back may be anything."""
    _call_late(scene)


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    forget()


def on_choice(owner: bpy.types.ID, effect: Effect | None) -> None:
    """Plan anew as soon as the choice is made, where that takes no time."""
    scene = bpy.context.scene
    last = of(scene)
    if last is None:
        return
    _call_late(scene)
    if last.seconds <= AT_ONCE and not bpy.app.timers.is_registered(plan_again):
        bpy.app.timers.register(plan_again, first_interval=0.0)


def plan_again() -> float | None:
    """Plan the open scene; returns after how many seconds to try again where it cannot be read now."""
    if handlers.is_paused():
        return 0.5
    if of(bpy.context.scene) is not None:
        make(bpy.context.scene, bpy.context.view_layer)
    return None


_HANDLERS = (
    ("depsgraph_update_post", on_update),
    ("undo_post", on_time_travel),
    ("redo_post", on_time_travel),
    ("load_pre", on_load),
)


def register() -> None:
    listen(_HANDLERS)
    properties.effect_listeners.append(on_choice)


def unregister() -> None:
    stop_listening(_HANDLERS)
    properties.effect_listeners.remove(on_choice)
    if bpy.app.timers.is_registered(plan_again):
        bpy.app.timers.unregister(plan_again)
    forget()
