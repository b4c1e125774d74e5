"""A picture whose poles differ as much as they can, and the nodes that read it."""

from __future__ import annotations

import bpy
import numpy as np

from pcc_addon.blender.shade import node_builder
from pcc_addon.core.effects.lookup import OFF_POLES


def halves(height: int, guarded: bool) -> bpy.types.ShaderNodeTree:
    """A group that looks a "Direction" up in a picture that is white above and black below.

    Args:
        height: of the picture, texels.
        guarded: whether lookups keep off the poles as a probe's group does it; the group then has a "Steepest" too.
    """
    pixels = np.zeros((height, 2 * height, 4), np.float32)
    pixels[height // 2 :] = 1.0
    picture = bpy.data.images.new("Halves", 2 * height, height, is_data=True)
    picture.pixels.foreach_set(pixels.ravel())
    inputs = {"Direction": "NodeSocketVector"} | ({"Steepest": "NodeSocketFloat"} if guarded else {})
    tree = bpy.data.node_groups.new("Look", "ShaderNodeTree")
    node_builder.declare_sockets(tree, "INPUT", inputs)
    node_builder.declare_sockets(tree, "OUTPUT", {"Color": "NodeSocketColor"})
    nodes, links = tree.nodes, tree.links
    source, texture, sink = (
        nodes.new(kind) for kind in ("NodeGroupInput", "ShaderNodeTexEnvironment", "NodeGroupOutput")
    )
    texture.image = picture
    direction = source.outputs["Direction"]
    if guarded:
        guard = bpy.data.node_groups.new("Guard", "ShaderNodeTree")
        node_builder.emit(guard, OFF_POLES.outputs)
        off = nodes.new("ShaderNodeGroup")
        off.node_tree = guard
        for name in inputs:
            links.new(source.outputs[name], off.inputs[name])
        direction = off.outputs["Direction"]
    links.new(direction, texture.inputs["Vector"])
    links.new(texture.outputs["Color"], sink.inputs["Color"])
    return tree
