"""Every kind of material that shows a probe; here those of several shaders, groups or outputs."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from sample_blends.scenes import principled_node
from tests.blender.materials import OF_ONE_SURFACE, Material, image_texture, link, new, output_of, shiny, textured


def mixed() -> Material:
    material = shiny()
    mix, other = new(material, "ShaderNodeMixShader"), new(material, "ShaderNodeBsdfPrincipled")
    other.inputs["Roughness"].default_value = 0.5
    link(material, principled_node(material).outputs[0], mix.inputs[1])
    link(material, other.outputs[0], mix.inputs[2])
    link(material, mix.outputs[0], output_of(material).inputs["Surface"])
    return material


def one_shader_twice() -> Material:
    material = shiny()
    mix = new(material, "ShaderNodeMixShader")
    for slot in (1, 2):
        link(material, principled_node(material).outputs[0], mix.inputs[slot])
    link(material, mix.outputs[0], output_of(material).inputs["Surface"])
    return material


def added() -> Material:
    material = shiny()
    add, glass = new(material, "ShaderNodeAddShader"), new(material, "ShaderNodeBsdfGlass")
    link(material, principled_node(material).outputs[0], add.inputs[0])
    link(material, glass.outputs[0], add.inputs[1])
    link(material, add.outputs[0], output_of(material).inputs["Surface"])
    return material


def nested() -> Material:
    """A Principled two groups deep, whose roughness is an input of the outer group."""
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    outer = bpy.data.node_groups.new("Outer", "ShaderNodeTree")
    for tree in (inner, outer):
        tree.interface.new_socket("Color", in_out="INPUT", socket_type="NodeSocketColor")
        tree.interface.new_socket("Roughness", in_out="INPUT", socket_type="NodeSocketFloat")
        tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
        if tree is inner:
            work = tree.nodes.new("ShaderNodeBsdfPrincipled")
            tree.links.new(source.outputs["Color"], work.inputs["Base Color"])
        else:
            work = tree.nodes.new("ShaderNodeGroup")
            work.node_tree = inner
            tree.links.new(source.outputs["Color"], work.inputs["Color"])
        tree.links.new(source.outputs["Roughness"], work.inputs["Roughness"])
        tree.links.new(work.outputs[0], sink.inputs["Shader"])
    material = shiny()
    material.node_tree.nodes.remove(principled_node(material))
    node = new(material, "ShaderNodeGroup")
    node.node_tree = outer
    node.inputs["Color"].default_value = (0.2, 0.4, 0.6, 1.0)
    node.inputs["Roughness"].default_value = 0.25
    link(material, node.outputs[0], output_of(material).inputs["Surface"])
    return material


def one_group_twice() -> Material:
    material = nested()
    first = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeGroup")
    second, mix = new(material, "ShaderNodeGroup"), new(material, "ShaderNodeMixShader")
    second.node_tree = first.node_tree
    second.inputs["Roughness"].default_value = 0.55
    for slot, node in enumerate((first, second), 1):
        link(material, node.outputs[0], mix.inputs[slot])
    link(material, mix.outputs[0], output_of(material).inputs["Surface"])
    return material


def outputs_of_each_engine() -> Material:
    material = shiny()
    output_of(material).target = "CYCLES"
    second, other = new(material, "ShaderNodeOutputMaterial"), new(material, "ShaderNodeBsdfPrincipled")
    second.target = "EEVEE"
    other.inputs["Metallic"].default_value = 1.0
    link(material, other.outputs[0], second.inputs["Surface"])
    second.is_active_output = True
    return material


def an_output_for_cycles_beside_one_for_all() -> Material:
    material = shiny()
    second, other = new(material, "ShaderNodeOutputMaterial"), new(material, "ShaderNodeBsdfPrincipled")
    second.target = "CYCLES"
    link(material, other.outputs[0], second.inputs["Surface"])
    assert output_of(material).is_active_output and material.node_tree.get_output_node("CYCLES") == second
    return material


def an_inactive_output() -> Material:
    material = shiny()
    spare, emission = new(material, "ShaderNodeOutputMaterial"), new(material, "ShaderNodeEmission")
    link(material, emission.outputs[0], spare.inputs["Surface"])
    spare.is_active_output = False
    output_of(material).is_active_output = True
    return material


def a_later_output_in_force() -> Material:
    material = an_inactive_output()
    first = output_of(material)
    spare = [n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial"][1]
    link(material, principled_node(material).outputs[0], spare.inputs["Surface"])
    spare.is_active_output = True
    assert not first.is_active_output
    return material


def muted() -> Material:
    material = mixed()
    bright, texture = new(material, "ShaderNodeBrightContrast"), image_texture(material)
    link(material, texture.outputs["Color"], bright.inputs["Color"])
    link(material, bright.outputs["Color"], principled_node(material).inputs["Base Color"])
    bright.mute = True
    material.node_tree.nodes["Principled BSDF.001"].mute = True
    return material


def coated() -> Material:
    material = textured()
    inputs = principled_node(material).inputs
    inputs["Coat Weight"].default_value, inputs["Sheen Weight"].default_value = 0.5, 0.3
    inputs["Emission Strength"].default_value = 0.0
    return material


def glossy() -> Material:
    material = shiny()
    node = new(material, "ShaderNodeBsdfAnisotropic")
    link(material, node.outputs[0], output_of(material).inputs["Surface"])
    return material


def metallic_bsdf() -> Material:
    material = shiny()
    node = new(material, "ShaderNodeBsdfMetallic")
    node.fresnel_type = "F82"
    link(material, node.outputs[0], output_of(material).inputs["Surface"])
    return material


RECEIVERS: list[Callable[[], Material]] = [
    *OF_ONE_SURFACE, mixed, one_shader_twice, added, nested, one_group_twice, outputs_of_each_engine,
    an_output_for_cycles_beside_one_for_all, an_inactive_output, a_later_output_in_force, muted,
    coated, glossy, metallic_bsdf,
]  # fmt: skip
