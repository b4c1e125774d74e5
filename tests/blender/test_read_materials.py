"""Materials as readings: what reaches an output, what is constant, what lights by itself, what stands in the way."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender.read.materials import read_material
from pcc_addon.blender.read.nodes import Scope, constant
from pcc_addon.core.readings import MaterialReading, SurfaceReading
from sample_blends.scenes import principled_node
from tests.blender.helpers import put_in
from tests.blender.materials import Material, glowing, image_texture, link, new, output_of, shiny, show
from tests.blender.receivers import (
    added,
    mixed,
    muted,
    nested,
    one_group_twice,
    one_shader_twice,
    outputs_of_each_engine,
)

pytestmark = pytest.mark.usefixtures("scene")


def paths(reading: MaterialReading) -> list[tuple[str, ...]]:
    return [surface.path for surface in reading.surfaces]


def only(material: Material) -> SurfaceReading:
    [surface] = read_material(material).surfaces
    return surface


def test_a_plain_material_has_one_surface_with_its_values() -> None:
    material = shiny()
    principled_node(material).distribution = "MULTI_GGX"
    surface = only(material)
    assert surface.path == ("Principled BSDF",) and surface.kind == "ShaderNodeBsdfPrincipled"
    assert surface.distribution == "MULTI_GGX"
    assert surface.color("Base Color") == pytest.approx((0.8, 0.4, 0.2)) and surface.scalar("Roughness") == 0.0
    assert surface.scalar("IOR") == 1.5 and surface.color("Specular Tint") == (1.0, 1.0, 1.0)
    reading = read_material(material)
    assert reading.name == "Shiny" and reading.obstacles == () and reading.shown == ()
    assert reading.textures == 0 and not reading.emits and reading.bends_normals
    material.cycles.use_bump_map_correction = False
    assert not read_material(material).bends_normals


def test_every_surface_is_found_once() -> None:
    assert paths(read_material(mixed())) == [("Principled BSDF",), ("Principled BSDF.001",)]
    assert paths(read_material(one_shader_twice())) == [("Principled BSDF",)]
    assert {s.kind for s in read_material(added()).surfaces} == {"ShaderNodeBsdfPrincipled", "ShaderNodeBsdfGlass"}


def test_a_muted_shader_and_what_hangs_on_a_muted_link_do_not_count() -> None:
    assert paths(read_material(muted())) == [("Principled BSDF",)]
    material = mixed()
    mix = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeMixShader")
    mix.inputs[1].links[0].is_muted = True
    assert paths(read_material(material)) == [("Principled BSDF.001",)]
    output_of(material).inputs["Surface"].links[0].is_muted = True
    assert paths(read_material(material)) == []


def test_a_muted_link_gives_no_value() -> None:
    material = shiny()
    link(material, image_texture(material).outputs["Alpha"], principled_node(material).inputs["Roughness"])
    assert only(material).value("Roughness") is None
    principled_node(material).inputs["Roughness"].links[0].is_muted = True
    assert only(material).value("Roughness") == 0.0


def test_a_value_node_is_constant_and_an_animated_one_is_not() -> None:
    material = shiny()
    node = new(material, "ShaderNodeValue")
    node.outputs[0].default_value = 0.375
    link(material, node.outputs[0], principled_node(material).inputs["Roughness"])
    assert only(material).scalar("Roughness") == 0.375
    node.outputs[0].keyframe_insert("default_value", frame=1)
    assert only(material).value("Roughness") is None


def test_an_animated_or_driven_input_varies_and_no_other() -> None:
    material = shiny()
    inputs = principled_node(material).inputs
    inputs["Roughness"].keyframe_insert("default_value", frame=1)
    inputs["Metallic"].driver_add("default_value").driver.expression = "0.5"
    surface = only(material)
    assert surface.value("Roughness") is None and surface.value("Metallic") is None
    assert surface.value("IOR") == 1.5


def test_values_come_through_groups() -> None:
    surface = only(nested())
    assert len(surface.path) == 3 and surface.path[-1] == "Principled BSDF"
    assert surface.scalar("Roughness") == 0.25 and surface.color("Base Color") == pytest.approx((0.2, 0.4, 0.6))
    assert [s.scalar("Roughness") for s in read_material(one_group_twice()).surfaces] == pytest.approx([0.25, 0.55])


def test_values_come_through_three_groups_and_out_of_the_output_in_force() -> None:
    material = nested()
    node = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeGroup")
    tree = bpy.data.node_groups.new("Outermost", "ShaderNodeTree")
    tree.interface.new_socket("Roughness", in_out="INPUT", socket_type="NodeSocketFloat")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    given, spare, sink = (tree.nodes.new(f"NodeGroup{kind}") for kind in ("Input", "Output", "Output"))
    group, emission = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeEmission")
    group.node_tree = node.node_tree
    tree.links.new(given.outputs[0], group.inputs["Roughness"])
    tree.links.new(emission.outputs[0], spare.inputs[0])
    tree.links.new(group.outputs[0], sink.inputs[0])
    sink.is_active_output = True
    node.node_tree = tree
    node.inputs["Roughness"].default_value = 0.375
    link(material, node.outputs[0], output_of(material).inputs["Surface"])
    surface = only(material)
    assert len(surface.path) == 4 and surface.scalar("Roughness") == 0.375
    spare.is_active_output = True
    assert read_material(material).surfaces == ()


def test_the_surfaces_of_both_engines_are_read() -> None:
    reading = read_material(outputs_of_each_engine())
    assert [surface.scalar("Metallic") for surface in reading.surfaces] == [0.0, 1.0]


def test_an_input_that_holds_no_number_has_no_value() -> None:
    material = shiny()
    material.node_tree.links.clear()
    assert constant(output_of(material).inputs["Surface"], Scope(material.node_tree)) is None


def emission(color: tuple[float, ...], strength: float) -> Material:
    material = added()
    node = new(material, "ShaderNodeEmission")
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = color, strength
    add = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeAddShader")
    link(material, node.outputs[0], add.inputs[1])
    return material


def test_what_shines_is_a_light_and_what_is_black_or_off_is_not() -> None:
    assert read_material(glowing()).emits
    assert read_material(emission((0.0, 0.0, 0.1, 1.0), 1.0)).emits
    assert not read_material(emission((0.0, 0.0, 0.0, 1.0), 1.0)).emits
    assert not read_material(emission((1.0, 1.0, 1.0, 1.0), 0.0)).emits
    material = shiny()
    principled_node(material).inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    assert not read_material(material).emits
    link(material, image_texture(material).outputs["Alpha"], principled_node(material).inputs["Emission Strength"])
    assert read_material(material).emits
    other = emission((0.0, 0.0, 0.0, 1.0), 1.0)
    node = next(n for n in other.node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
    link(other, image_texture(other).outputs["Color"], node.inputs["Color"])
    assert read_material(other).emits


def test_images_are_counted_once_and_in_groups_too() -> None:
    material = shiny()
    first, second = image_texture(material), image_texture(material)
    assert read_material(material).textures == 2
    second.image = first.image
    assert read_material(material).textures == 1
    second.image = None
    environment = new(material, "ShaderNodeTexEnvironment")
    environment.image = bpy.data.images.new("Sky", 4, 2)
    tree = bpy.data.node_groups.new("Inside", "ShaderNodeTree")
    tree.nodes.new("ShaderNodeTexImage").image = bpy.data.images.new("Inner", 4, 4)
    for _ in range(2):
        new(material, "ShaderNodeGroup").node_tree = tree
    assert read_material(material).textures == 3


def test_a_grease_pencil_material_is_left_alone() -> None:
    material = bpy.data.materials.new("Ink")
    bpy.data.materials.create_gpencil_data(material)
    assert read_material(material).obstacles == ("is a grease pencil material",)


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="every material is made of nodes")
def test_a_material_without_nodes_is_left_alone() -> None:
    material = shiny()
    material.use_nodes = False
    for plain in (material, bpy.data.materials.new("Plain")):
        assert read_material(plain).obstacles == ("uses no nodes: switch Use Nodes on",)


def test_shaders_that_feed_themselves_are_named() -> None:
    material = mixed()
    mix = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeMixShader")
    link(material, mix.outputs[0], mix.inputs[2])
    reading = read_material(material)
    assert reading.obstacles == (f"has shaders that feed themselves (at '{mix.name}'): cut the loop",)


@pytest.mark.parametrize(("count", "refused"), [(150, False), (250, True)])
def test_a_long_chain_of_shaders_is_refused_before_it_breaks_anything(count: int, refused: bool) -> None:
    material = shiny()
    last = principled_node(material).outputs[0]
    for _ in range(count):
        add = new(material, "ShaderNodeAddShader")
        link(material, last, add.inputs[0])
        last = add.outputs[0]
    link(material, last, output_of(material).inputs["Surface"])
    assert bool(read_material(material).obstacles) is refused


def test_a_group_without_output_or_tree_has_no_surface() -> None:
    material = shiny()
    node = new(material, "ShaderNodeGroup")
    tree = bpy.data.node_groups.new("Hollow", "ShaderNodeTree")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    node.node_tree = tree
    link(material, node.outputs[0], output_of(material).inputs["Surface"])
    assert read_material(material).surfaces == ()


def test_reading_an_injected_material_gives_what_it_was_and_which_probes_it_shows(probe) -> None:
    material = shiny()
    show(material)
    before = read_material(material)
    put_in()
    after = read_material(material)
    assert after.surfaces == before.surfaces and after.textures == before.textures and not after.emits
    assert before.shown == () and after.shown == (probe.pcc_probe.group.name,)
