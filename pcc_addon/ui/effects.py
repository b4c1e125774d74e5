"""Which effects are on, why, and what an artist chooses instead: panels of probes and of materials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy

from ..blender import marks
from ..blender.read.probes import all_probes
from ..blender.shade.probe_group import probe_of
from ..blender.shade.twin import has_twins, shown_probe_groups
from ..core.decisions import OF_MATERIALS, OF_PROBES, Decision, Effect
from ..core.material_plan import MaterialPlan
from ..core.plan_report import price
from ..core.surface_plan import SurfacePlan
from ..core.words import named
from . import last_plan
from .sentences import room, say, width

ON, OFF = "CHECKMARK", "REMOVE"
_CHOICES, _MENU = 6.5, 2.7  # units of width that Auto, On and Off take beside each other, and as a menu

Said = tuple[str, Decision]
"""Of which surface something was decided, or "" where there is but one, and what."""


def draw_plan_button(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The button that plans, and what is to be said of the last plan."""
    last = last_plan.of(context.scene)
    column = layout.column(align=True)
    column.operator("pcc.plan", icon="FILE_REFRESH", text="Plan")
    if last is not None and last.late:
        say(column, context, "Planned before the last change")


def draw_effects(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    settings: bpy.types.PropertyGroup,
    effects: Sequence[Effect],
    decisions: Mapping[Effect, Sequence[Said]],
) -> None:
    """A row for each effect: whether it is on, the choice, and under it why and what that costs or saves.

    Effects of which nothing was decided are left out, unless that holds for all.
    """
    rows = [effect for effect in effects if effect in decisions or getattr(settings, effect.key) != "AUTO"]
    rows = rows if decisions else list(effects)
    widest = max(width(context, effect.label) for effect in rows)
    spread = widest <= room(context, 1.0 + _CHOICES)
    taken = _CHOICES if spread else _MENU
    for effect in rows:
        said = decisions.get(effect, ())
        column = layout.column(align=True)
        row = column.split(factor=room(context, taken) / room(context))
        say(row.column(align=True), context, effect.label, _icon(said), quiet=False, beside=taken)
        choice = row.row(align=True)
        if spread:
            choice.prop(settings, effect.key, expand=True)
        else:
            choice.prop(settings, effect.key, text="")
        for surface, decision in said:
            cost = price(decision)
            why = f"{decision.why}; {cost}" if cost else decision.why
            if surface:
                say(column, context, f"{surface}: {why}", ON if decision.on else OFF)
            else:
                say(column, context, why)


def _icon(said: Sequence[Said]) -> str:
    if not said:
        return "BLANK1"
    return ON if any(decision.on for _, decision in said) else OFF


class _Effects:
    """The effects of the active object, a probe."""

    bl_label = "Effects"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.pcc_probe.is_probe

    def draw(self, context: bpy.types.Context) -> None:
        draw_plan_button(self.layout, context)
        last = last_plan.of(context.scene)
        plan = last.plan.probe(context.object.name) if last is not None else None
        decided = {decision.effect: [("", decision)] for decision in plan.decisions} if plan is not None else {}
        draw_effects(self.layout, context, context.object.pcc_probe.effects, OF_PROBES, decided)


class PCC_PT_effects(_Effects, bpy.types.Panel):
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_parent_id = "PCC_PT_probe"


class PCC_PT_effects_of_active(_Effects, bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Probes"
    bl_label = "Effects of Active Probe"


class _OfMaterial:
    """The material that is chosen; the user's own where objects wear a copy of ours."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        material = context.material
        return material is not None and (bool(all_probes(context.scene)) or has_twins(material))

    def _planned(self, context: bpy.types.Context) -> MaterialPlan | None:
        last = last_plan.of(context.scene)
        name = marks.original(context.material).name_full
        return next((m for m in last.plan.materials if m.material == name), None) if last is not None else None


class PCC_PT_material(_OfMaterial, bpy.types.Panel):
    bl_label = "Parallax Probes"

    def draw(self, context: bpy.types.Context) -> None:
        layout, material = self.layout, context.material
        planned = self._planned(context)
        column = layout.column(align=True)
        _draw_shown(column, context, material, planned)
        if planned is not None:
            for reason in planned.reasons:
                say(column, context, reason)
            for surface in planned.surfaces:
                _draw_surface(layout.column(align=True), context, surface)
        elif last_plan.of(context.scene) is not None:
            say(column, context, "none of its objects is in a probe's influence")
        draw_plan_button(layout, context)


def _draw_shown(
    layout: bpy.types.UILayout, context: bpy.types.Context, material: bpy.types.Material, plan: MaterialPlan | None
) -> None:
    groups = shown_probe_groups(material) if material.node_tree else ()
    probes = [probe.name for probe in map(probe_of, groups) if probe is not None]
    say(layout, context, f"Shows {named(probes)}" if probes else "Shows no probe", ON if probes else OFF, quiet=False)
    if marks.is_copy(material):
        say(layout, context, f"a copy of '{marks.original(material).name}', which has the same settings")
    elif plan is not None and set(plan.division.kept) != set(probes):
        shown = named(sorted(plan.division.kept)) or "no probe"
        say(layout, context, f"Inject into Materials lets it show {shown}, once baked")


def _draw_surface(layout: bpy.types.UILayout, context: bpy.types.Context, surface: SurfacePlan) -> None:
    if surface.effects is None:
        say(layout, context, surface.name, OFF, quiet=False)
        say(layout, context, f"keeps its own lobe: {'; '.join(surface.reasons)}")
        if surface.roughness[0] > context.scene.pcc.roughness_limit:
            say(layout, context, f"'{Effect.OWN_LOBE.label}: Off' below would let it show a probe")
        return
    say(layout, context, surface.name, ON, quiet=False)
    say(layout, context, "; ".join(reason for reason in surface.reasons if reason != surface.effects.label))


class PCC_PT_material_effects(_OfMaterial, bpy.types.Panel):
    bl_label = "Effects"
    bl_parent_id = "PCC_PT_material"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        planned = self._planned(context)
        settings = marks.original(context.material).pcc.effects
        draw_effects(self.layout, context, settings, OF_MATERIALS, _decided(planned) if planned is not None else {})


def _decided(plan: MaterialPlan) -> dict[Effect, list[Said]]:
    """What was decided of a material and of its surfaces, by effect."""
    found: dict[Effect, list[Said]] = {decision.effect: [("", decision)] for decision in plan.decisions}
    several = len(plan.served) > 1
    for surface in plan.served.values():
        for decision in surface.decisions:
            found.setdefault(decision.effect, []).append((surface.name if several else "", decision))
    return found


CLASSES = (PCC_PT_effects, PCC_PT_effects_of_active, PCC_PT_material, PCC_PT_material_effects)
