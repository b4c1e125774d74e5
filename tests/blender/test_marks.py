"""Marks tell what is ours from what is the user's, in files of version 1 too, and notes come back as written."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.marks import Before, OriginalOutput
from sample_blends.scenes import principled_node
from tests.blender.materials import new, output_of, shiny

pytestmark = pytest.mark.usefixtures("scene")


def group(name: str) -> bpy.types.ShaderNodeTree:
    return bpy.data.node_groups.new(name, "ShaderNodeTree")


def test_a_mark_is_ours_whatever_the_item_is_called_and_nothing_else_is() -> None:
    material = shiny()
    for item in (group("Mine"), principled_node(material)):
        assert marks.role(item) is None
        for foreign in (3, ["probe"], "probe"):
            item["parallax_probes"] = foreign
            assert marks.role(item) is None
        marks.tag(item, "copy of one")
        assert marks.role(item) == "copy of one"


@pytest.mark.parametrize("value", [7, 0.5, "text", [0.0, 0.5], ["a", "b"], {"of": "Node", "list": [1, 2]}], ids=str)
def test_a_note_comes_back_as_it_was_written_until_it_is_forgotten(value: object) -> None:
    item = group("Group")
    marks.note(item, "one", value)
    marks.note(item, "other", 1)
    found = marks.noted(item, "one", "default")
    assert found == value and type(found) is type(value)
    marks.forget(item, "one")
    assert marks.noted(item, "one", "default") == "default" and marks.noted(item, "one") is None
    marks.forget(item, "one")
    assert marks.noted(item, "other") == 1 and marks.role(item) is None


def test_what_an_injection_changed_is_remembered_until_it_is_forgotten() -> None:
    material = shiny()
    outputs = (OriginalOutput("Output", 0, "ALL", False), OriginalOutput("Other", 1, "EEVEE", True))
    assert marks.noted_before(material) is None
    for before in (Before(outputs, None), Before(outputs[1:], ""), Before((), "FRONT")):
        marks.note_before(material, before)
        assert marks.noted_before(material) == before
    marks.forget_before(material)
    assert marks.noted_before(material) is None


OLD_ROLES = ["probe", "copy", "Lookup, box", "Surface, metal", "Off Poles"]


@pytest.mark.parametrize("role", OLD_ROLES)
def test_a_group_of_version_1_is_ours_by_its_mark_and_its_name(role: str) -> None:
    tree = group(f"PCC {role}")
    assert marks.role(tree) is None
    tree["pcc"] = role
    assert marks.role(tree) == role
    tree.name = role
    assert marks.role(tree) is None, "somebody else's property"
    tree.name, tree["pcc"] = f"PCC {role}", "another tool's"
    assert marks.role(tree) is None
    tree["pcc"] = 1
    assert marks.role(tree) is None


def test_only_trees_of_version_1_are_ours_and_no_other_data() -> None:
    material = shiny("PCC Material")
    material["pcc"] = "probe"
    assert marks.role(material) is None


def injected_by_version_1(material: bpy.types.Material, **notes: object) -> bpy.types.Node:
    """Give a material the output of a twin as the first version marked it."""
    twin = new(material, "ShaderNodeOutputMaterial")
    for key, value in {"pcc": "twin", "pcc_twin_of": "Material Output", **notes}.items():
        twin[key] = value
    return twin


@pytest.mark.parametrize("role", ["twin", "probe", "glow"])
def test_a_node_of_version_1_is_ours_where_a_twin_is(role: str) -> None:
    material = shiny()
    node = new(material, "ShaderNodeEmission")
    node["pcc"] = role
    assert marks.role(node) is None, "no twin is there"
    twin = injected_by_version_1(material)
    assert marks.role(node) == role and marks.role(twin) == "twin"
    node["pcc"] = "another tool's"
    assert marks.role(node) is None and marks.role(output_of(material)) is None
    node["pcc"] = role
    del twin["pcc_twin_of"]
    assert marks.role(node) is None


def test_a_node_in_a_group_that_version_1_copied_is_ours() -> None:
    tree = group("PCC Wood")
    node = tree.nodes.new("ShaderNodeEmission")
    node["pcc"] = "glow"
    assert marks.role(node) is None
    tree["pcc"] = "copy"
    assert marks.role(node) == "glow"
    tree.name = "Wood"
    assert marks.role(node) is None


def test_what_version_1_changed_is_read_from_its_twins() -> None:
    material = shiny()
    first = injected_by_version_1(material)
    first.target = "CYCLES"
    assert marks.noted_before(material) == Before((OriginalOutput("Material Output", 0, "CYCLES", True),), None)
    notes = {"pcc_twin_of": "Other", "pcc_target": "EEVEE", "pcc_active": False, "pcc_emission_sampling": "FRONT"}
    injected_by_version_1(material, **notes)
    outputs = (OriginalOutput("Material Output", 0, "CYCLES", True), OriginalOutput("Other", 0, "EEVEE", False))
    assert marks.noted_before(material) == Before(outputs, "FRONT")


def test_a_material_without_nodes_was_never_changed() -> None:
    """It has no node tree before Blender 5.0."""
    assert marks.noted_before(bpy.data.materials.new("Plain")) is None
