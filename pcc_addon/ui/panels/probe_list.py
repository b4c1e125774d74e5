"""All probes of a scene as a list: how their bakes stand, their names, their engines, and which are locked.

It lists the objects of the scene, of which it shows the probes, so there is no second list to be kept in step.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Sequence

import bpy

from ...blender.read.probes import is_own_probe
from ..kept import states
from ..sentences import say, unit

_ENGINE_FROM = 12.0  # units of width from which on there is room for the engine's name
_ENGINES = {"CYCLES": "Cycles", "EEVEE": "EEVEE"}


class PCC_UL_probes(bpy.types.UIList):
    """The probes of a scene."""

    by_state: bpy.props.BoolProperty(
        name="Sort by State", description="Those first that are faulty, stale or not baked", options=set()
    )

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: bpy.types.Scene,
        item: bpy.types.Object,
        icon: int,
        active_data: bpy.types.Scene,
        active_property: str,
    ) -> None:
        known = states.of(context.scene, item)
        row = layout.row(align=True)
        row.operator("pcc.state", text="", icon=known.icon, emboss=False).probe = item.name
        row.prop(item, "name", text="", emboss=False)
        if context.region.width > _ENGINE_FROM * unit(context):
            engine = row.row()
            engine.active, engine.alignment = False, "RIGHT"
            engine.label(text=source_of(item))
        settings = item.pcc_probe
        lock = "LOCKED" if settings.locked else "UNLOCKED"
        row.prop(settings, "locked", text="", icon=lock, emboss=False)

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        row = layout.row(align=True)
        row.prop(self, "filter_name", text="", icon="VIEWZOOM")
        row.prop(self, "use_filter_invert", text="", icon="ARROW_LEFTRIGHT")
        row.separator()
        row.prop(self, "by_state", text="", icon="SORTSIZE")
        row.prop(
            self, "use_filter_sort_reverse", text="", icon="SORT_DESC" if self.use_filter_sort_reverse else "SORT_ASC"
        )

    def filter_items(
        self, context: bpy.types.Context, data: bpy.types.Scene, property: str
    ) -> tuple[list[int], list[int]]:
        scene = data
        order = shown(scene, self.filter_name, self.use_filter_invert, self.by_state, self.use_filter_sort_reverse)
        flags, places = [0] * len(scene.objects), {index: place for place, index in enumerate(order)}
        for index in order:
            flags[index] = self.bitflag_filter_item
        rest = iter(range(len(order), len(flags)))
        return flags, [places[k] if k in places else next(rest) for k in range(len(flags))]


def shown(
    scene: bpy.types.Scene, pattern: str = "", others: bool = False, by_state: bool = False, backwards: bool = False
) -> list[int]:
    """The places among a scene's objects of the probes that a list shows, in its order.

    Args:
        scene: whose.
        pattern: part of a name, as wildcards have it; empty: all.
        others: whether those are shown whose names are not so.
        by_state: whether what needs care comes first; else, and among equals, they come by name.
        backwards: whether the order is turned round.
    """
    wanted = f"*{pattern.casefold()}*"
    found = [
        (k, item)
        for k, item in enumerate(scene.objects)
        if is_own_probe(item) and (not pattern or fnmatch.fnmatchcase(item.name.casefold(), wanted) != others)
    ]
    ranks = {state: rank for rank, state in enumerate(states.State)}

    def rank(each: tuple[int, bpy.types.Object]) -> tuple[int, str]:
        item = each[1]
        return ranks[states.of(scene, item).state] if by_state else 0, item.name.casefold()

    return [k for k, _ in sorted(found, key=rank, reverse=backwards)]


def source_of(probe: bpy.types.Object) -> str:
    """Where its pictures come from, in a word."""
    settings = probe.pcc_probe
    return _ENGINES[settings.engine] if settings.source == "BAKE" else settings.source.capitalize()


def _active(scene: bpy.types.Scene) -> int:
    """The place of the active object among a scene's objects, where that is a probe; else -1."""
    active = bpy.context.view_layer.objects.active
    index = scene.objects.find(active.name) if active is not None and is_own_probe(active) else -1
    return index if index >= 0 and scene.objects[index] == active else -1


def _activate(scene: bpy.types.Scene, index: int) -> None:
    """Select a probe alone; nothing happens where objects cannot be selected now."""
    layer, objects = bpy.context.view_layer, scene.objects
    if bpy.context.mode != "OBJECT" or not 0 <= index < len(objects) or objects[index].name not in layer.objects:
        return
    for item in list(layer.objects.selected):
        item.select_set(False, view_layer=layer)
    layer.objects.active = objects[index]
    objects[index].select_set(True, view_layer=layer)


def summary(scene: bpy.types.Scene, probes: Sequence[bpy.types.Object]) -> str:
    """How many probes stand how, such as "3 probes: 1 stale, 2 baked"."""
    found = [states.of(scene, probe).state for probe in probes]
    counts = [f"{found.count(state)} {state.label.lower()}" for state in states.State if state in found]
    return f"{len(probes)} probe{'s' if len(probes) > 1 else ''}: {', '.join(counts)}"


def draw_list(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The list, with what is done to its probes beside it."""
    row = layout.row()
    row.template_list("PCC_UL_probes", "", context.scene, "objects", context.scene, "pcc_active_probe", rows=4)
    column = row.column(align=True)
    column.operator("pcc.probe_add", icon="ADD", text="")
    column.separator()
    column.menu("PCC_MT_probes", icon="DOWNARROW_HLT", text="")
    if context.mode != "OBJECT":
        say(layout.column(align=True), context, "A click selects a probe in Object Mode only", "INFO")


class PCC_MT_probes(bpy.types.Menu):
    bl_label = "Probes"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("pcc.select", text="Select All Probes", icon="RESTRICT_SELECT_OFF").which = "ALL"
        layout.operator("pcc.select", text="Select Probes to Be Baked").which = "WAITING"
        layout.separator()
        layout.operator("pcc.copy_settings", icon="COPYDOWN")
        layout.operator("pcc.export", icon="EXPORT")
        layout.separator()
        layout.operator("pcc.lock", icon="LOCKED").locked = True
        layout.operator("pcc.lock", text="Unlock Selected Probes", icon="UNLOCKED").locked = False


def register() -> None:
    bpy.types.Scene.pcc_active_probe = bpy.props.IntProperty(
        name="Active Probe",
        description="Selects the probe",
        get=_active,
        set=_activate,
        options=set(),
    )


def unregister() -> None:
    del bpy.types.Scene.pcc_active_probe


CLASSES = (PCC_UL_probes, PCC_MT_probes)
