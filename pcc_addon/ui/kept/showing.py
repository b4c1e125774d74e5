"""Lets materials show probes, and the viewport what renders show; panels are told of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ...blender.planning import PlannedScene, read_and_plan
from ...blender.shade import injection
from ...blender.shade.injection import InjectionReport
from ...blender.shade.preparing import Preparation
from ...blender.stepping import Steps, at_once
from ...core.accuracy.labels import counted
from . import idle, last_plan, states

_FLAT = {"SOLID", "WIREFRAME"}  # shadings without materials
_NO_MATERIALS = "BLENDER_WORKBENCH"  # the engine whose renders have none


def inject(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    objects: Sequence[bpy.types.Object] | None = None,
    planned: PlannedScene | None = None,
) -> InjectionReport:
    """`injection.inject`, and its plan is the last one.

    Raises:
        PccError: no probe of the scene can be shown.
    """
    return at_once(injecting(scene, view_layer, objects, planned))


def injecting(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    objects: Sequence[bpy.types.Object] | None = None,
    planned: PlannedScene | None = None,
) -> Steps[InjectionReport]:
    """`inject`, a little between two yields; errors are those of `injection.injecting`."""
    report = yield from injection.injecting(scene, view_layer, objects, planned)
    if objects is None:
        states.injected(scene)
    last_plan.keep(scene, view_layer, report.plan)
    return report


def in_words(report: InjectionReport) -> str:
    """In how many materials probes show."""
    shown = counted(len({material for material, _ in report.materials}), "material")
    left = "; what is left alone, and why, is under Materials in the sidebar" if report.notes else ""
    return f"Probes show in {shown}{left}"


def show_rendered(scene: bpy.types.Scene) -> None:
    """Let the largest 3D view of each window that shows a scene show it rendered, where it has no materials yet."""
    kind = "MATERIAL" if scene.render.engine == _NO_MATERIALS else "RENDERED"
    for window in bpy.context.window_manager.windows:
        areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
        if window.scene != scene or not areas:
            continue
        shading = max(areas, key=lambda area: area.width * area.height).spaces.active.shading
        if shading.type in _FLAT:
            shading.type = kind


def _holds(planned: PlannedScene, scene: bpy.types.Scene) -> bool:
    """Whether a scene is as it was when it was planned; that a name has changed is no update of a scene."""
    last = last_plan.of(scene)
    same = last is not None and last.plan is planned.plan and not last.late
    return same and planned.names_are_known(scene)


@dataclass(frozen=True)
class Showing:
    """Shows the probes of a scene that may be edited, undone or deleted meanwhile.

    Attributes:
        scene_uid: its session uid.
        layer: the name of its view layer that counts.
    """

    scene_uid: int
    layer: str

    @classmethod
    def of(cls, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Showing:
        return cls(scene.session_uid, view_layer.name)

    def preparation(self) -> Preparation | None:
        """Makes ready what materials will call; None where the scene is gone."""
        scene = self._scene()
        if scene is None:
            return None
        known = last_plan.of(scene)  # a late one is nearly right, and a new one takes as long as reading the scene
        return Preparation(known.plan if known else last_plan.make(scene, self._view_layer(scene)))

    def plan(self) -> PlannedScene | None:
        """What materials are to show; None where the scene is gone."""
        scene = self._scene()
        if scene is None:
            return None
        planned = read_and_plan(scene, self._view_layer(scene))
        last_plan.keep(scene, self._view_layer(scene), planned.plan)
        return planned

    def in_materials(self) -> str:
        """Let materials show all that is baked; returns that in words, which are empty where the scene is gone.

        Raises:
            PccError: no probe of the scene can be shown.
        """
        return at_once(self.steps())

    def steps(self, planned: PlannedScene | None = None) -> Steps[str]:
        """`in_materials`, a little between two yields; an undo must not come between.

        Args:
            planned: from `plan`, and obeyed where nothing has changed since; None: the scene is planned now.

        Raises:
            PccError: no probe of the scene can be shown.
            ReferenceError: what was about to change was removed meanwhile.
        """
        scene = self._scene()
        if scene is None:
            return ""
        if planned is not None and not _holds(planned, scene):
            planned = None
        report = yield from injecting(scene, self._view_layer(scene), planned=planned)
        states.call_late(scene)  # of what has just been baked, also where handlers are paused meanwhile
        idle.expect()
        return in_words(report)

    def in_viewport(self) -> None:
        """Let viewports that have no materials show what renders show."""
        scene = self._scene()
        if scene is not None:
            show_rendered(scene)

    def _view_layer(self, scene: bpy.types.Scene) -> bpy.types.ViewLayer:
        return scene.view_layers.get(self.layer) or scene.view_layers[0]

    def _scene(self) -> bpy.types.Scene | None:
        return next((scene for scene in bpy.data.scenes if scene.session_uid == self.scene_uid), None)
