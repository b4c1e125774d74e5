"""The operators that add groups which show probes in shaders made by hand."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ...blender import marks
from ...blender.read.probes import bake_record, named_probes
from ...blender.shade.by_hand import group_for, mirrored_view_group
from ...blender.store.levels import bake_folder, ensure_levels
from ...core.cubemap import FACE_NAMES
from ...core.errors import PccError
from ...core.faces_needed import told_missing
from ...core.pictures import LADDER


class _NodeAdd:
    """Adds a group node to the shader that is open, or to the active material where no Shader Editor is."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        tree = _open_tree(context)
        why = None
        if tree is None:
            why = "Open a material's nodes in the Shader Editor, or give the active object a material with nodes"
        elif tree.library:
            why = f"'{tree.name}' is linked from '{tree.library.filepath}': make it local to add nodes"
        elif marks.role(tree):
            why = f"'{tree.name}' is a group of Parallax Probes, which is built anew by each bake: leave it first"
        if why:
            cls.poll_message_set(why)
        return why is None

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        space = context.space_data
        if space is None or space.type != "NODE_EDITOR":
            return self.execute(context)
        space.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        done = self.execute(context)
        if done == {"FINISHED"}:
            bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return done

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            group = self._group(context)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        tree = _open_tree(context)
        for other in tree.nodes:
            other.select = False
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree, node.width = group, 200.0
        node.location = getattr(context.space_data, "cursor_location", (0.0, 0.0))
        tree.nodes.active = node
        return {"FINISHED"}

    def _group(self, context: bpy.types.Context) -> bpy.types.ShaderNodeTree:
        raise NotImplementedError


class PCC_OT_node_add(_NodeAdd, bpy.types.Operator):
    """Add a node that shows a probe along any direction"""

    bl_idname = "pcc.node_add"
    bl_label = "Probe"

    probe: bpy.props.StringProperty(name="Probe", description="Its name")

    def _group(self, context: bpy.types.Context) -> bpy.types.ShaderNodeTree:
        [probe] = named_probes(context.scene, [self.probe])
        if bake_record(probe) is not None:
            ensure_levels(probe, LADDER, bake_folder(context.scene))
        group = group_for(probe)
        warn_of_missing_faces(self, [probe])
        return group


def warn_of_missing_faces(operator: bpy.types.Operator, probes: Iterable[bpy.types.Object]) -> None:
    """Report what some baked probes cannot show to who looks any way."""
    for probe in probes:
        record = bake_record(probe)
        lacking = record.lacks(FACE_NAMES) if record else ()
        if lacking:
            operator.report({"WARNING"}, told_missing(probe.name, lacking))


class PCC_OT_mirrored_view_add(_NodeAdd, bpy.types.Operator):
    """Add a node that mirrors the view in a normal, such as a normal map's: a direction to look a probe up along"""

    bl_idname = "pcc.mirrored_view_add"
    bl_label = "Mirrored View"

    def _group(self, context: bpy.types.Context) -> bpy.types.ShaderNodeTree:
        return mirrored_view_group()


def _open_tree(context: bpy.types.Context) -> bpy.types.ShaderNodeTree | None:
    space = context.space_data
    if space is not None and space.type == "NODE_EDITOR":
        return space.edit_tree if space.tree_type == "ShaderNodeTree" else None
    material = context.object.active_material if context.object else None
    return material.node_tree if material else None


CLASSES = (PCC_OT_node_add, PCC_OT_mirrored_view_add)
