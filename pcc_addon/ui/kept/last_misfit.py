"""The last misfits of each scene's probes, for panels and the viewport."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import bpy

from ...blender import handlers
from ...blender.accuracy.misfit_job import ProbeMisfit
from ...blender.listening import listen, stop_listening
from ...blender.read.probes import all_probes, probe_spec
from ...core.errors import PccError
from .redrawing import redraw


@dataclass(frozen=True, eq=False)
class LastMisfit:
    """What was found of a probe.

    Attributes:
        found: it.
        late: whether anything was moved, reshaped or deleted since.
    """

    found: ProbeMisfit
    late: bool = False


_found: dict[tuple[int, str], LastMisfit] = {}  # by the scene's session uid and the probe's name
_LOOKING_ON = {"CAMERA", "LIGHT", "SPEAKER"}  # what no survey sees


def of(scene: bpy.types.Scene, probe: bpy.types.Object) -> LastMisfit | None:
    """The last misfit of a probe, or None where none was asked for since the file was opened."""
    last = _found.get((scene.session_uid, probe.name))
    if last is None or last.late or last.found.misfit is None:
        return last
    before = last.found.misfit.spec
    try:
        now = replace(probe_spec(probe), resolution=before.resolution)
    except PccError:
        return replace(last, late=True)
    same = (now.box, tuple(now.capture_point), now.hidden) == (before.box, tuple(before.capture_point), before.hidden)
    return last if same else replace(last, late=True)


def all_of(scene: bpy.types.Scene) -> Iterator[ProbeMisfit]:
    """Those of the probes that are still in a scene."""
    for probe in all_probes(scene):
        last = _found.get((scene.session_uid, probe.name))
        if last is not None:
            yield last.found


def keep(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, found: ProbeMisfit) -> None:
    """Keep what was found of a probe; what the survey itself changed for a while does not make it late."""
    view_layer.update()
    _found[scene.session_uid, found.probe] = LastMisfit(found)
    redraw()


def forget() -> None:
    """Forget all."""
    _found.clear()


def _call_late(scene: bpy.types.Scene) -> None:
    for key, last in _found.items():
        if key[0] == scene.session_uid and not last.late:
            _found[key] = replace(last, late=True)


def _shapes_the_scene(update: bpy.types.DepsgraphUpdate) -> bool:
    if not (update.is_updated_geometry or update.is_updated_transform):
        return False
    return not isinstance(update.id, bpy.types.Object) or update.id.type not in _LOOKING_ON


@bpy.app.handlers.persistent
def on_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """What is moved, reshaped or deleted makes misfits late; colours and cameras do not."""
    if _found and not handlers.is_paused() and any(map(_shapes_the_scene, depsgraph.updates)):
        _call_late(scene)


@bpy.app.handlers.persistent
def on_time_travel(scene: bpy.types.Scene, *_: object) -> None:
    """What an undo or redo brings back may be anything."""
    _call_late(scene)


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    forget()


_HANDLERS = (
    ("depsgraph_update_post", on_update),
    ("undo_post", on_time_travel),
    ("redo_post", on_time_travel),
    ("load_pre", on_load),
)


def register() -> None:
    listen(_HANDLERS)


def unregister() -> None:
    stop_listening(_HANDLERS)
    forget()
