"""Which probes a material shows, which of its surfaces do, and its effects."""

from __future__ import annotations

import bpy

from ...blender import marks
from ...blender.read.probes import all_probes
from ...blender.shade.probe_group import probe_of
from ...blender.shade.twin import has_twins, shown_probe_groups
from ...core.decisions import OF_MATERIALS, Effect
from ...core.material_plan import MaterialPlan
from ...core.surface_plan import SurfacePlan
from ...core.words import named
from ..kept import last_plan
from ..manual import Helped, Page
from ..sentences import say
from .effects import OFF, ON, Said, draw_effects, draw_plan_button


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


class PCC_PT_material(_OfMaterial, Helped, bpy.types.Panel):
    bl_label = "Parallax Probes"
    about = Page.MATERIALS, ""

    def draw(self, context: bpy.types.Context) -> None:
        layout, material = self.layout, context.material
        planned = self._planned(context)
        settings = marks.original(material).pcc
        column = layout.column()
        column.use_property_split = True
        column.prop(settings, "show_probes")
        row = column.row()
        row.active = settings.show_probes
        row.prop(settings, "probe", placeholder="Any")
        column = layout.column(align=True)
        _draw_shown(column, context, material, planned)
        if planned is not None:
            for reason in (*planned.choices, *planned.reasons):
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


CLASSES = (PCC_PT_material, PCC_PT_material_effects)
