"""What the panels of a probe have in common: they are in its data tab, under the first one."""

from __future__ import annotations

import bpy


class OfProbe:
    """A base of panels beside `bpy.types.Panel`."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_parent_id = "PCC_PT_probe"


class OfBake(OfProbe):
    """The same of those that only probes with a bake of their own have."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.pcc_probe.source == "BAKE"
