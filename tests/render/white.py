"""White furnaces: worlds of radiance 1, in which what is missing or too much shows."""

from __future__ import annotations

import bpy

from sample_blends.scenes import empty_scene
from tests.blender.helpers import small_probe


def white_scene() -> bpy.types.Scene:
    """A new file with a world of radiance 1."""
    scene = empty_scene()
    background = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    background.inputs["Strength"].default_value = 1.0
    return scene


def plane_under_a_white_sky() -> bpy.types.Scene:
    """The same with "Plane" at the middle of a big probe, "Sky", which does not see it."""
    scene = white_scene()
    bpy.ops.mesh.primitive_plane_add(size=100.0)
    probe = small_probe("Sky", (0.0, 0.0, 0.0), (60.0, 60.0, 60.0), capture_offset=(0.0, 0.0, 1.0))
    probe.pcc_probe.hidden_objects.add().object = bpy.data.objects["Plane"]
    return scene
