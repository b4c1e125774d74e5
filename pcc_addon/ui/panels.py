"""Where the probe's settings and buttons are shown: the empty's data tab, the sidebar, the Add menu."""

from __future__ import annotations

import bpy

from ..blender.read.probes import all_probes, bake_record
from ..core.cubemap import FACE_NAMES
from ..core.errors import PccError
from ..core.presets import Preset
from . import last_plan
from .probe_panel import OfBake, OfProbe
from .sentences import say


class PCC_PT_probe(bpy.types.Panel):
    bl_label = "Parallax Probe"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.pcc_probe.is_probe

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        layout.prop(settings, "source")
        row = layout.row(align=True)
        for preset in Preset:
            row.operator("pcc.preset", text=preset.label).preset = preset.name
        column = layout.column()
        if settings.source == "IMAGE":
            row = column.row(align=True)
            row.prop(settings, "picture")
            row.operator("pcc.picture_choose", icon="FILE_IMAGE", text="")
        else:
            column.prop(settings, "engine")
        column.prop(settings, "resolution")
        column.prop(settings, "half_float")
        if settings.source != "IMAGE":
            column.prop(settings, "samples")
            if settings.engine == "CYCLES":
                column.prop(settings, "adaptive")
                column.prop(settings, "denoise")
        if settings.source == "BAKE":
            layout.prop(settings, "follow")
            layout.prop(settings, "capture_offset")
            column = layout.column(align=True)
            column.prop(settings, "clip_start")
            column.prop(settings, "clip_end", text="End")
        column = layout.column()
        column.prop(settings, "correction")
        box = column.column()
        box.active = settings.correction != "NONE"
        if settings.correction == "RELIEF":
            box.prop(settings, "relief_steps")
            box.prop(settings, "relief_refinements")
        box.prop(settings, "padding")
        box.prop(settings, "falloff")
        box.prop(settings, "outside")
        box.prop(settings, "contact_hardening")
        column = layout.column(align=True)
        column.operator("pcc.fit", icon="FULLSCREEN_EXIT")
        column.operator("pcc.bake", icon="RENDER_STILL", text="Bake Selected Probes").scope = "SELECTED"
        words = _words(last_plan.of(context.scene), context.object.name)
        if words:
            say(column, context, words[0].upper() + words[1:])
        lacking = _not_captured(context.object)
        if lacking:
            say(column, context, f"Not captured: {', '.join(lacking)}")


def _not_captured(probe: bpy.types.Object) -> tuple[str, ...]:
    """The faces that a bake left out, as nothing could mirror that way; guessed where that has changed since."""
    try:
        record = bake_record(probe)
    except PccError:  # status tells
        return ()
    return record.lacks(FACE_NAMES) if record else ()


class PCC_PT_influence(OfProbe, bpy.types.Panel):
    bl_label = "Influence"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        column = layout.column()
        column.prop(settings, "weight")
        column.prop(settings, "priority")
        column.prop(settings, "receivers")
        column.prop(settings, "excluded")
        box = layout.column()
        box.active = settings.correction != "NONE"
        box.prop(settings, "influence_low", text="Beyond −X, −Y, −Z")
        box.prop(settings, "influence_high", text="Beyond +X, +Y, +Z")
        box.prop(settings, "falloff_per_face")
        if settings.falloff_per_face:
            box.prop(settings, "falloff_low", text="Falloff −X, −Y, −Z")
            box.prop(settings, "falloff_high", text="Falloff +X, +Y, +Z")
        box.prop(settings, "normal_fade")


class PCC_PT_hidden(OfBake, bpy.types.Panel):
    bl_label = "Hidden from Capture"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        layout.prop(settings, "hidden_collection", text="Collection")
        for index, item in enumerate(settings.hidden_objects):
            row = layout.row(align=True)
            row.prop(item, "object", text="Object" if index == 0 else " ")
            row.operator("pcc.hidden_remove", icon="X", text="").index = index
        layout.operator("pcc.hidden_add", icon="ADD")


class PCC_PT_scene(bpy.types.Panel):
    bl_label = "Parallax Probes"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Probes"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        probes = all_probes(context.scene)
        if not probes:
            layout.label(text="No probes yet", icon="INFO")
            layout.operator("pcc.probe_add", icon="LIGHTPROBE_SPHERE", text="Add Parallax Probe")
            layout.operator("pcc.remove", icon="X")  # materials may show probes of other scenes
            return
        last = last_plan.of(context.scene)
        for probe in probes:
            column = layout.column(align=True)
            say(column, context, probe.name, _icon(last, probe), quiet=False)
            words = _words(last, probe.name)
            if words:
                say(column, context, words)
        if last is not None and last.late and (last.states or any(_words(last, probe.name) for probe in probes)):
            say(layout.column(align=True), context, "As it was before the last change")
        column = layout.column(align=True)
        column.operator("pcc.status", icon="FILE_REFRESH")
        column.operator("pcc.bake", icon="RENDER_STILL", text="Bake Stale").scope = "STALE"
        row = column.row(align=True)
        row.operator("pcc.bake", text="All").scope = "ALL"
        row.operator("pcc.bake", text="Selected").scope = "SELECTED"
        column.operator("pcc.bake_frames", icon="RENDER_ANIMATION")
        column = layout.column(align=True)
        column.operator("pcc.plan", icon="PRESET")
        row = column.row(align=True)
        row.operator("pcc.cost", icon="DRIVER_DISTANCE").quick = False
        row.operator("pcc.cost", text="Quick").quick = True
        column.operator("pcc.inject", icon="MATERIAL")
        column.operator("pcc.remove", icon="X")
        column = layout.column(align=True)
        column.operator("pcc.interior_add", icon="MOD_LATTICE")
        column.operator("pcc.interior_add_pictures", icon="IMAGE_DATA")
        layout.prop(context.scene.pcc, "roughness_limit")
        layout.prop(context.scene.pcc, "folder")


_STATES = {"baked": "CHECKMARK", "stale": "FILE_REFRESH", "unbaked": "RADIOBUT_OFF", "error": "ERROR"}


def _icon(last: last_plan.LastPlan | None, probe: bpy.types.Object) -> str:
    """How a probe's bake stands, as far as it was asked."""
    state = last.states.get(probe.name) if last is not None else None
    if state is None:
        return _STATES["baked" if probe.pcc_probe.bake_record else "unbaked"]
    return _STATES[state.state]


def _words(last: last_plan.LastPlan | None, name: str) -> str:
    """What is to be said of a probe: what was found of its bake, else whether it needs one, as far as that is known."""
    if last is None:
        return ""
    state, plan = last.states.get(name), last.plan.probe(name)
    if state is not None:
        return state.words
    return f"needs no bake: {plan.unneeded}" if plan is not None and plan.unneeded else ""


def draw_add_menu(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    self.layout.operator("pcc.probe_add", icon="LIGHTPROBE_SPHERE")


CLASSES = (PCC_PT_probe, PCC_PT_influence, PCC_PT_hidden, PCC_PT_scene)
