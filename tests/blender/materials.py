"""Materials of one Principled BSDF, what helps to build others, and an object to wear them."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from sample_blends.scenes import principled, principled_node
from tests.blender.helpers import ROOM

Material = bpy.types.Material


def shiny(name: str = "Shiny") -> Material:
    return principled(name, Base_Color=(0.8, 0.4, 0.2, 1.0), Roughness=0.0)


def link(material: Material, source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
    material.node_tree.links.new(source, target)


def new(material: Material, kind: str) -> bpy.types.Node:
    return material.node_tree.nodes.new(kind)


def output_of(material: Material) -> bpy.types.Node:
    return next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")


def image_texture(material: Material) -> bpy.types.Node:
    node = new(material, "ShaderNodeTexImage")
    node.image = bpy.data.images.new("Texture", 4, 4)
    return node


def show(material: Material, name: str = "Mesh") -> bpy.types.Object:
    """An object in the room that wears a material."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    item.location = ROOM.centre
    bpy.context.scene.collection.objects.link(item)
    return item


# Each function below makes one kind of material that shows a probe.


def plain() -> Material:
    return shiny()


def with_own_settings() -> Material:
    material = shiny()
    node = principled_node(material)
    node.distribution, node.subsurface_method = "GGX", "RANDOM_WALK_SKIN"
    node.inputs["Specular Tint"].default_value = (1.0, 0.5, 0.25, 1.0)
    material["note"], node["note"] = {"list": [1, 2], "text": "mine"}, [0.5, 1.5]
    material.node_tree.nodes.active = node
    material.displacement_method = "BOTH"
    return material


def metallic() -> Material:
    material = shiny()
    principled_node(material).inputs["Metallic"].default_value = 1.0
    return material


def textured() -> Material:
    material = shiny()
    texture, inputs = image_texture(material), principled_node(material).inputs
    link(material, texture.outputs["Color"], inputs["Base Color"])
    link(material, texture.outputs["Alpha"], inputs["Metallic"])
    link(material, texture.outputs["Alpha"], inputs["Specular IOR Level"])
    material.node_tree.nodes.active = texture
    return material


def normal_mapped() -> Material:
    material = shiny()
    texture, normal_map = image_texture(material), new(material, "ShaderNodeNormalMap")
    link(material, texture.outputs["Color"], normal_map.inputs["Color"])
    link(material, normal_map.outputs["Normal"], principled_node(material).inputs["Normal"])
    return material


def rerouted_and_framed() -> Material:
    material = textured()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    frame, reroutes = new(material, "NodeFrame"), [new(material, "NodeReroute") for _ in range(3)]
    frame.label = "Mine"
    surface = principled_node(material)
    texture = next(n for n in nodes if n.bl_idname == "ShaderNodeTexImage")
    links.new(texture.outputs["Color"], reroutes[0].inputs[0])
    links.new(reroutes[0].outputs[0], reroutes[1].inputs[0])
    links.new(reroutes[1].outputs[0], surface.inputs["Base Color"])
    links.new(surface.outputs[0], reroutes[2].inputs[0])
    links.new(reroutes[2].outputs[0], output_of(material).inputs["Surface"])
    for node in (surface, texture, reroutes[0]):
        node.parent = frame
    surface.location = (120.0, -30.0)
    return material


def glowing() -> Material:
    material = shiny()
    principled_node(material).inputs["Emission Color"].default_value = (1.0, 0.5, 0.0, 1.0)
    principled_node(material).inputs["Emission Strength"].default_value = 2.0
    return material


def see_through() -> Material:
    material = textured()
    texture = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeTexImage")
    link(material, texture.outputs["Alpha"], principled_node(material).inputs["Alpha"])
    return material


def half_see_through() -> Material:
    material = shiny()
    principled_node(material).inputs["Alpha"].default_value = 0.5
    return material


def animated() -> Material:
    material = shiny()
    node = principled_node(material)
    driver = node.inputs["Base Color"].driver_add("default_value", 0).driver
    driver.expression = "0.25 + 0.5"
    node.inputs["Specular IOR Level"].default_value = 0.25
    color = node.inputs["Base Color"]
    for frame, value in ((10, 0.9), (1, 0.1)):  # a value without its keyframe is lost when Blender evaluates the curve
        color.default_value[1] = value
        color.keyframe_insert("default_value", index=1, frame=frame)
    return material


def subsurface() -> Material:
    material = shiny()
    principled_node(material).inputs["Subsurface Weight"].default_value = 0.5
    principled_node(material).inputs["Subsurface Radius"].default_value = (1.0, 0.2, 0.1)
    return material


def displaced_and_volumetric() -> Material:
    material = shiny()
    displacement, volume = new(material, "ShaderNodeDisplacement"), new(material, "ShaderNodeVolumeScatter")
    link(material, displacement.outputs[0], output_of(material).inputs["Displacement"])
    link(material, volume.outputs[0], output_of(material).inputs["Volume"])
    return material


def lamp_sampled() -> Material:
    material = shiny()
    material.cycles.emission_sampling = "FRONT"
    return material


OF_ONE_SURFACE: list[Callable[[], Material]] = [
    plain, with_own_settings, metallic, textured, normal_mapped, rerouted_and_framed, glowing, see_through,
    half_see_through, animated, subsurface, displaced_and_volumetric, lamp_sampled,
]  # fmt: skip
