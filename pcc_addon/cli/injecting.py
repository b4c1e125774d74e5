"""What an injection tells."""

from __future__ import annotations

import bpy

from ..blender.shade import injection
from .voice import Voice


def let_show(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, voice: Voice) -> int:
    """Let the materials of a scene show its baked probes; returns how much failed."""
    report = injection.inject(scene, view_layer)
    for material, probe in report.materials:
        voice.event("injected", f"material '{material}' shows '{probe}'", material=material, probe=probe)
    for note in report.notes:
        voice.event("note", note, note=note)
    return 0
