"""What is added to Blender's own menus."""

from __future__ import annotations

import bpy

from ..blender.read.probes import all_probes


class PCC_MT_node_add(bpy.types.Menu):
    bl_label = "Parallax Probes"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_REGION_WIN"  # the node then follows the pointer
        baked = [probe for probe in all_probes(context.scene) if probe.pcc_probe.bake_record]
        for probe in baked:
            layout.operator(
                "pcc.node_add", text=probe.name, icon="LIGHTPROBE_SPHERE", translate=False
            ).probe = probe.name
        if not baked:
            layout.label(text="No probe is baked yet", icon="INFO")
        layout.separator()
        layout.operator("pcc.mirrored_view_add")


def draw_probes(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    self.layout.operator("pcc.probe_add", icon="LIGHTPROBE_SPHERE")


def draw_windows(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    self.layout.operator("pcc.interior_add", icon="MOD_LATTICE")
    self.layout.operator("pcc.interior_add_pictures", icon="IMAGE_DATA")


def draw_nodes(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    self.layout.menu("PCC_MT_node_add", icon="LIGHTPROBE_SPHERE")


def draw_copying(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    if context.object is not None and context.object.pcc_probe.is_probe:
        self.layout.separator()
        self.layout.operator("pcc.copy_settings", text="Copy Probe Settings...")


def draw_export(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    self.layout.operator("pcc.export", text="Parallax Probes")


_MENUS = (
    ("TOPBAR_MT_file_export", draw_export),
    ("VIEW3D_MT_lightprobe_add", draw_probes),
    ("VIEW3D_MT_lightprobe_add", draw_windows),
    ("VIEW3D_MT_make_links", draw_copying),
    ("NODE_MT_shader_node_add_all", draw_nodes),
)


def register() -> None:
    for name, draw in _MENUS:
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    for name, draw in reversed(_MENUS):
        getattr(bpy.types, name).remove(draw)


CLASSES = (PCC_MT_node_add,)
