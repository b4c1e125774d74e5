"""Which materials show a probe, and what their twins do: levels, engines, values, and when they are lamps."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.shade.injection import inject, remove
from pcc_addon.core.effects.roughness import neighbours
from pcc_addon.core.pictures import LADDER
from sample_blends.scenes import principled_node
from tests.blender.helpers import put_in, shown_group
from tests.blender.materials import glowing, image_texture, link, new, shiny, show, subsurface
from tests.blender.receivers import RECEIVERS, added, nested, one_group_twice, outputs_of_each_engine
from tests.blender.snapshots import material_lines
from tests.rna_dump import difference


def test_each_engine_shows_the_twin_of_its_own_output(probe) -> None:
    material = outputs_of_each_engine()
    before = {engine: material.node_tree.get_output_node(engine).name for engine in ("CYCLES", "EEVEE")}
    show(material)
    put_in()
    for engine, original in before.items():
        assert material.node_tree.get_output_node(engine).label == f"{original}, Parallax Probe"
    remove()
    assert {engine: material.node_tree.get_output_node(engine).name for engine in before} == before


def levels_read(material: bpy.types.Material) -> set[str]:
    """The outputs of probe groups that a material's twins read."""
    nodes = list(probe_nodes(material.node_tree))
    return {s.name for node in nodes for s in node.outputs if s.is_linked}


def probe_nodes(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    for node in tree.nodes:
        if marks.role(node) == "probe":
            yield node
        elif marks.role(node) and node.bl_idname == "ShaderNodeGroup" and marks.role(node.node_tree) == "copy":
            yield from probe_nodes(node.node_tree)


def test_a_bake_and_an_injection_make_the_whole_ladder(probe) -> None:
    show(shiny())
    put_in()
    assert [level.roughness for level in probe.pcc_probe.levels] == pytest.approx(LADDER)


def test_a_value_in_an_outer_group_chooses_its_two_levels(probe) -> None:
    material = nested()  # roughness 0.25
    show(material)
    put_in()
    assert levels_read(material) == {f"Level {k}" for k in neighbours(LADDER, 0.25, 0.25)}


def test_two_uses_of_a_group_read_their_own_levels(probe) -> None:
    material = one_group_twice()
    show(material)
    put_in()
    wanted = [*neighbours(LADDER, 0.25, 0.25), *neighbours(LADDER, 0.55, 0.55)]
    assert levels_read(material) == {f"Level {k}" for k in wanted}


def test_a_textured_roughness_reads_every_level(probe) -> None:
    material = shiny()
    link(material, image_texture(material).outputs["Alpha"], principled_node(material).inputs["Roughness"])
    show(material)
    assert put_in().materials == ((material.name, probe.name),)
    assert levels_read(material) == {f"Level {k}" for k in range(len(LADDER))}


def test_a_material_of_several_objects_is_injected_once(probe) -> None:
    material = shiny()
    show(material, "First"), show(material, "Second")
    report = put_in()
    assert report.materials == ((material.name, probe.name),)
    assert len([n for n in material.node_tree.nodes if marks.role(n) == "probe"]) == 1


def test_materials_far_from_every_probe_are_left_alone(probe) -> None:
    material = shiny()
    show(material).location.x += 50.0
    before = material_lines(material)
    assert put_in().materials == ()
    assert difference(before, material_lines(material)) == []


def test_only_the_chosen_objects_materials_are_injected_and_removed(probe) -> None:
    first, second = shiny("First"), shiny("Second")
    one, two = show(first), show(second)
    inject(bpy.context.scene, bpy.context.view_layer, [one])
    assert shown_group(first) and not shown_group(second)
    put_in()
    assert remove([two]) == ["Second"]
    assert shown_group(first) and not shown_group(second)


@pytest.mark.parametrize("build", [f for f in RECEIVERS if f is not glowing], ids=lambda f: f.__name__)
def test_the_reflection_is_not_sampled_as_a_lamp(probe, build) -> None:
    material = build()
    show(material)
    put_in()
    assert material.cycles.emission_sampling == "NONE"


@pytest.mark.parametrize("own_light", ["Emission Strength", "an Emission node", "inside a group"])
def test_a_material_with_its_own_light_stays_a_lamp(probe, own_light) -> None:
    if own_light == "Emission Strength":
        material = glowing()
    else:
        material = added()
        emission = new(material, "ShaderNodeEmission")
        add = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeAddShader")
        glow = emission
        if own_light == "inside a group":
            tree = bpy.data.node_groups.new("Glow", "ShaderNodeTree")
            tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
            inner, sink = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("NodeGroupOutput")
            tree.links.new(inner.outputs[0], sink.inputs[0])
            material.node_tree.nodes.remove(emission)
            glow = new(material, "ShaderNodeGroup")
            glow.node_tree = tree
        link(material, glow.outputs[0], add.inputs[1])
    show(material)
    before = material.cycles.emission_sampling
    put_in()
    assert material.cycles.emission_sampling == before


def test_the_twin_copies_the_values_and_the_settings_of_a_surface(probe) -> None:
    material = subsurface()
    original = principled_node(material)
    original.subsurface_method = "RANDOM_WALK_SKIN"
    show(material)
    put_in()
    [copy] = [n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled" and marks.role(n)]
    assert copy.subsurface_method == "RANDOM_WALK_SKIN"
    assert copy.inputs["Subsurface Weight"].default_value == 0.5
    assert np.allclose(copy.inputs["Subsurface Radius"].default_value, (1.0, 0.2, 0.1))
    assert copy.inputs["Metallic"].default_value == 0.0 and copy.inputs["Specular IOR Level"].default_value == 0.0
