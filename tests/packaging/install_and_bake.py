"""Run in a process of its own: install a zip as a user would, and bake a probe with it. Prints OK."""

from __future__ import annotations

import os
import sys

os.environ["BLENDER_USER_RESOURCES"] = sys.argv[2]  # a fresh user; read when bpy is imported

import bpy

bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
assert "bl_ext.user_default.parallax_probes" in {a.module for a in bpy.context.preferences.addons}
bpy.ops.pcc.probe_add(
    name="Room", location=(0, 0, 1), rotation=(0, 0, 0.3), half_extents=(3, 3, 2), capture_offset=(0, 0, 0)
)
probe = bpy.data.objects["Room"]
probe.pcc_probe.resolution, probe.pcc_probe.samples = 16, 1
assert bpy.ops.pcc.bake(scope="STALE") == {"FINISHED"}
assert bpy.ops.pcc.inject() == {"FINISHED"}
assert probe.pcc_probe.levels[0].image.size[0] == 64
if hasattr(bpy.types, "EXPORT_SCENE_OT_gltf"):
    path = os.path.join(sys.argv[2], "room.glb")
    bpy.ops.export_scene.gltf(filepath=path)
    with open(path, "rb") as file:
        assert b'"PCC_parallax_probe"' in file.read(), "Blender's glTF exporter does not find the add-on"
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.parallax_probes")
assert not hasattr(bpy.types.Object, "pcc_probe")
print("OK")
