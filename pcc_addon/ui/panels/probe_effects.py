"""The effects of a probe, in its data tab and in the sidebar."""

from __future__ import annotations

import bpy

from ...core.decisions import OF_PROBES
from ..kept import last_plan
from .effects import draw_effects, draw_plan_button
from .scene import InSidebar


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


class PCC_PT_effects_of_active(InSidebar, _Effects, bpy.types.Panel):
    bl_label = "Effects of Active Probe"


CLASSES = (PCC_PT_effects, PCC_PT_effects_of_active)
