"""How near things are: a scene in which every surface glows by the reciprocal of its distance from the camera.

The reciprocal, since it is 0 where nothing is, and since on a plane it is a linear function of the unit direction, so
that what is read between two texels of a wall lies on the wall.
"""

from __future__ import annotations

from contextlib import ExitStack

import bpy

from ..overrides import override, temporary
from ..read.scene import rendered_objects

_ALPHA = 0.5  # as renderers decide what is there in their depth passes


def show_nearness(stack: ExitStack, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
    """Let surfaces glow by 1/metres from the camera until `stack` closes, and nothing else."""
    material = temporary(stack, bpy.data.materials, _glowing_by_nearness())
    override(stack, view_layer, "material_override", material)
    override(stack, scene, "world", None)
    for item in rendered_objects(scene, view_layer):
        if item.type == "LIGHT" or is_seen_through(item):
            override(stack, item, "hide_render", True)
    for name, value in (
        ("sample_clamp_direct", 0.0),
        ("sample_clamp_indirect", 0.0),
        ("pixel_filter_type", "GAUSSIAN"),
        ("filter_width", 0.01),  # through the centre of each pixel
        ("use_light_tree", False),
    ):
        override(stack, scene.cycles, name, value)


def _glowing_by_nearness() -> bpy.types.Material:
    material = bpy.data.materials.new("pcc nearness")
    if material.node_tree is None:
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    camera, divide, glow, output = (
        tree.nodes.new(kind)
        for kind in ("ShaderNodeCameraData", "ShaderNodeMath", "ShaderNodeEmission", "ShaderNodeOutputMaterial")
    )
    divide.operation = "DIVIDE"
    divide.inputs[0].default_value = 1.0
    tree.links.new(camera.outputs["View Distance"], divide.inputs[1])
    tree.links.new(divide.outputs[0], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    return material


def is_seen_through(item: bpy.types.Object) -> bool:
    """Whether what one sees of an object is what is behind it: panes of glass, and volumes."""
    materials = [slot.material for slot in item.material_slots if slot.material is not None]
    return bool(materials) and all(_is_clear(material) for material in materials)


def _is_clear(material: bpy.types.Material) -> bool:
    output = material.node_tree.get_output_node("CYCLES") if material.node_tree else None
    if output is None:
        return False
    links = output.inputs["Surface"].links
    if not links:
        return True
    node = links[0].from_node
    if node.bl_idname == "ShaderNodeBsdfPrincipled":
        clear, solid = node.inputs["Transmission Weight"], node.inputs["Alpha"]
        transmits = not clear.links and clear.default_value > _ALPHA
        return transmits or (not solid.links and solid.default_value < _ALPHA)
    return node.bl_idname in {"ShaderNodeBsdfTransparent", "ShaderNodeBsdfGlass", "ShaderNodeBsdfRefraction"}
