"""Materials that show a picture along a direction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import bpy
import numpy as np

from benchmarks.picture_layouts.layouts import Layout
from pcc_addon.blender.shade import node_builder
from pcc_addon.core.expression import Expr
from sample_blends.scenes import emissive

FindDirection = Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]  # adds the nodes that give the direction


def image_of(picture: np.ndarray) -> bpy.types.Image:
    """A data image of (height, width, 3) in full float precision."""
    height, width = picture.shape[:2]
    image = bpy.data.images.new("picture", width, height, float_buffer=True, is_data=True)
    image.use_half_precision = False
    image.alpha_mode = "NONE"
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = picture
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


@dataclass(frozen=True)
class Lookup:
    """A material that shows a picture along a direction.

    Attributes:
        layout: how the picture is read.
        material: emits what the lookup finds.
        texture: its texture node.
        nodes: how many nodes turn the direction into a colour, the texture node included.
    """

    layout: Layout
    material: bpy.types.Material
    texture: bpy.types.Node
    nodes: int

    def show(self, image: bpy.types.Image, interpolation: str = "Linear") -> None:
        self.texture.image = image
        self.texture.interpolation = interpolation


def lookup_of(layout: Layout, find_direction: FindDirection) -> Lookup:
    """Build the material."""
    material, emission = emissive(layout.label)
    material.cycles.emission_sampling = "NONE"
    tree = material.node_tree
    texture = tree.nodes.new(layout.node_type)
    if layout.node_type == "ShaderNodeTexImage":
        texture.extension = "EXTEND"
    place, count = find_direction(tree), 1
    coordinates = layout.coordinates()
    if coordinates is not None:
        find = group_node(tree, layout.label, {"Coordinates": coordinates})
        for name, value in layout.constants().items():
            find.inputs[name].default_value = value
        tree.links.new(place, find.inputs["Direction"])
        place = find.outputs["Coordinates"]
        count += sum(not node.bl_idname.startswith("NodeGroup") for node in find.node_tree.nodes)
    tree.links.new(place, texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    return Lookup(layout, material, texture, count)


def group_node(tree: bpy.types.NodeTree, name: str, outputs: Mapping[str, Expr]) -> bpy.types.Node:
    """A new group that computes `outputs`, used once in `tree`."""
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    node_builder.emit(group, outputs)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    return node
