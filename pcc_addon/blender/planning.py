"""The plan of a scene: read, then decided."""

from __future__ import annotations

import bpy

from ..core.plan import Plan, make_plan
from .read.scene import read_scene


def plan_scene(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Plan:
    """What a scene requires of its probes and materials."""
    return make_plan(read_scene(scene, view_layer))
