"""The last plan of each scene, for panels: they are drawn many times a second, and a plan may take seconds."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import bpy

from ..blender import handlers, properties
from ..blender.planning import plan_scene
from ..blender.status import ProbeStatus, planned_statuses
from ..core.decisions import Effect
from ..core.plan import Plan
from .redrawing import redraw

AT_ONCE = 1.0  # seconds: what takes no longer is planned anew after each choice, without being asked


@dataclass(frozen=True)
class LastPlan:
    """What was planned.

    Attributes:
        plan: it.
        seconds: how long planning took.
        states: by name what was found of the probes' bakes; empty where that was not asked.
        late: whether the scene was changed since.
    """

    plan: Plan
    seconds: float = 0.0
    states: Mapping[str, ProbeStatus] = field(default_factory=dict)
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
    plan, found = planned_statuses(scene, view_layer)
    view_layer.update()  # sequences were gone through
    _keep(scene, plan, {status.probe: status for status in found})
    return found


def forget() -> None:
    """Forget all plans."""
    _plans.clear()


def _keep(
    scene: bpy.types.Scene,
    plan: Plan,
    states: Mapping[str, ProbeStatus] | None = None,
    seconds: float | None = None,
) -> None:
    before = of(scene)
    if seconds is None:
        seconds = before.seconds if before is not None else 0.0
    _plans[scene.session_uid] = LastPlan(plan, seconds, states or {})
    redraw()


def _call_late(scene: bpy.types.Scene) -> None:
    last = of(scene)
    if last is not None and not last.late:
        _plans[scene.session_uid] = replace(last, late=True)
        redraw()


@bpy.app.handlers.persistent
def on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """A change that a plan may depend on makes it late; another selection does not."""
    last = of(scene)
    if last is None or last.late or handlers.is_paused():
        return
    changed = (u.is_updated_geometry or u.is_updated_transform or u.is_updated_shading for u in depsgraph.updates)
    if any(changed):  # whatever is deleted changes its collection
        _call_late(scene)


@bpy.app.handlers.persistent
def on_time_travel(scene: bpy.types.Scene, *_: object) -> None:
    """What an undo or redo brings back may be anything."""
    _call_late(scene)


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    forget()


def on_choice(owner: bpy.types.ID, effect: Effect) -> None:
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
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)
    properties.effect_listeners.append(on_choice)


def unregister() -> None:
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    properties.effect_listeners.remove(on_choice)
    if bpy.app.timers.is_registered(plan_again):
        bpy.app.timers.unregister(plan_again)
    forget()
