"""Which probes a button is for."""

from __future__ import annotations

import bpy

from ...blender.read.probes import all_probes


def chosen_probes(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The scene's own probes that are selected, by name; where none is, the active one."""
    probes = all_probes(context.scene)
    selected = [probe for probe in probes if probe.select_get(view_layer=context.view_layer)]
    return selected or [probe for probe in probes if probe == context.view_layer.objects.active]
