"""EEVEE where no lamp shines: quick in software too."""

from __future__ import annotations

import bpy


def without_shadows(scene: bpy.types.Scene) -> None:
    """Leave out the shadow maps, and make little of the world's light on surfaces.

    Nothing that only emits, or only shows a probe, is changed by either, and they are nine tenths of the processor's
    work for a small picture. Blender's own settings have tests of their own: marks, lamps, a picture with and without.
    """
    scene.eevee.use_shadows = False
    if scene.world:
        scene.world.probe_resolution = "128"
