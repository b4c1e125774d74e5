"""Whether an object shows probes, and which its materials show on it."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ...blender import marks
from ...blender.read.probes import all_probes
from ...blender.read.scene import SURFACES
from ...blender.shade.probe_group import probe_of
from ...blender.shade.twin import has_twins, shown_probe_groups
from ...core.plan import Plan
from ...core.words import named
from ..kept import last_plan
from ..manual import Helped, Page
from ..sentences import say
from .effects import OFF, ON, draw_plan_button


class PCC_PT_object(Helped, bpy.types.Panel):
    bl_label = "Parallax Probes"
    about = Page.MATERIALS, "choosing"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        item = context.object
        return item is not None and item.type in SURFACES and (bool(all_probes(context.scene)) or _shows_any(item))

    def draw(self, context: bpy.types.Context) -> None:
        layout, item = self.layout, context.object
        column = layout.column()
        column.use_property_split = True
        column.prop(item.pcc, "show_probes")
        last = last_plan.of(context.scene)
        worn = dict.fromkeys(slot.material for slot in item.material_slots if slot.material)
        if not worn:
            say(layout.column(align=True), context, "it has no material that could show a probe")
        for material in worn:
            column = layout.column(align=True)
            probes = _shown_on(item, material, last.plan if last is not None else None)
            say(column, context, marks.original(material).name, ON if probes else OFF, quiet=False)
            say(column, context, f"shows {named(probes)}" if probes else "shows no probe here")
            for why in _why_not(item, material, last.plan) if last is not None and not probes else ():
                say(column, context, why)
        draw_plan_button(layout, context)


def _shows_any(item: bpy.types.Object) -> bool:
    return any(slot.material is not None and has_twins(slot.material) for slot in item.material_slots)


def _shown_on(item: bpy.types.Object, material: bpy.types.Material, plan: Plan | None) -> list[str]:
    """The probes that a material shows now; of these those that the object is in, where that is known."""
    groups = shown_probe_groups(material) if material.node_tree else ()
    probes = [probe.name for probe in map(probe_of, groups) if probe is not None]
    if plan is None or marks.is_foreign(material):
        return probes
    reached = {probe for each in plan.materials for name, probe in each.objects if name == item.name_full}
    return [probe for probe in probes if probe in reached]


def _why_not(item: bpy.types.Object, material: bpy.types.Material, plan: Plan) -> Iterator[str]:
    """Why an object's material shows no probe on it."""
    name = marks.original(material).name_full
    planned = next((each for each in plan.materials if each.material == name), None)
    if not item.pcc.show_probes:
        yield "this object's Show Probes is off"
    elif planned is None:
        yield "it is in no probe's influence"
    elif not planned.probes:
        yield from (*planned.choices, *planned.reasons)
        yield from (f"{surface.name}: {'; '.join(surface.reasons)}" for surface in planned.surfaces)
    elif any(other == item.name_full for other, _ in planned.objects):
        yield "Inject into Materials lets it show one, once baked"
    else:
        yield f"it is not in the influence of {named(planned.probes)}"


CLASSES = (PCC_PT_object,)
