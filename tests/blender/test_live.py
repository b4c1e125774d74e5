"""Edits of an injected material, of its groups and of probes show at once."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.core.effects.roughness import neighbours
from pcc_addon.core.pictures import LADDER
from sample_blends.scenes import principled_node
from tests.blender.helpers import pretend_bake, put_in, save, shown_group, small_probe
from tests.blender.materials import image_texture, link, output_of, shiny, show
from tests.blender.receivers import nested
from tests.blender.test_twin_shown import levels_read


def update() -> None:
    bpy.context.view_layer.update()


def surface_group_node(material: bpy.types.Material) -> bpy.types.Node:
    return next(n for n in material.node_tree.nodes if n.label == "Reflectance")


@pytest.fixture
def material(probe) -> bpy.types.Material:
    """A metal of roughness 0.3 that shows the probe."""
    material = shiny()
    principled_node(material).inputs["Roughness"].default_value = 0.3
    principled_node(material).inputs["Metallic"].default_value = 0.5
    show(material)
    put_in()
    update()
    return material


def test_a_new_colour_reaches_the_twin_without_building_anew(material) -> None:
    node = surface_group_node(material)
    principled_node(material).inputs["Base Color"].default_value = (0.1, 0.2, 0.3, 1.0)
    principled_node(material).inputs["Metallic"].default_value = 0.75
    update()
    assert surface_group_node(material) == node
    assert node.inputs["Base Color"].default_value[:] == pytest.approx((0.1, 0.2, 0.3))
    assert node.inputs["Metallic"].default_value == pytest.approx(0.75)


def test_a_roughness_beyond_the_next_level_reads_other_levels(material) -> None:
    for roughness in (0.31, 0.5, 0.0):
        principled_node(material).inputs["Roughness"].default_value = roughness
        update()
        assert levels_read(material) == {f"Level {k}" for k in neighbours(LADDER, roughness, roughness)}


def test_a_new_link_reaches_the_twin(material) -> None:
    texture = image_texture(material)
    link(material, texture.outputs["Color"], principled_node(material).inputs["Base Color"])
    update()
    assert surface_group_node(material).inputs["Base Color"].links[0].from_node == texture


def test_an_edit_inside_a_group_reaches_the_twin(probe) -> None:
    material = nested()
    show(material)
    put_in()
    inner = next(n for n in bpy.data.node_groups["Inner"].nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    inner.inputs["Metallic"].default_value = 1.0
    update()
    copy = next(t for t in bpy.data.node_groups if t.name.startswith("PCC Inner") and t.users)
    assert any("metal alone" in n.node_tree.name for n in copy.nodes if n.bl_idname == "ShaderNodeGroup")


def test_a_colour_ramp_inside_a_group_reaches_the_twin(probe) -> None:
    material = nested()
    tree = bpy.data.node_groups["Inner"]
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    surface = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    tree.links.new(ramp.outputs["Color"], surface.inputs["Base Color"])
    show(material)
    put_in()
    ramp.color_ramp.elements[0].color = (1.0, 0.0, 0.0, 1.0)
    update()
    copy = next(t for t in bpy.data.node_groups if t.name.startswith("PCC Inner") and t.users)
    [copied] = [n for n in copy.nodes if n.bl_idname == "ShaderNodeValToRGB"]
    assert copied.color_ramp.elements[0].color[:] == (1.0, 0.0, 0.0, 1.0)


def test_a_surface_that_cannot_be_served_for_a_while_shows_the_probe_again(material, probe) -> None:
    roughness = principled_node(material).inputs["Roughness"]
    before = roughness.default_value
    roughness.default_value = 0.9
    update()
    assert levels_read(material) == set()
    assert not material.node_tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node.label
    roughness.default_value = before
    update()
    assert levels_read(material) and shown_group(material) == probe.pcc_probe.group


def test_undo_and_redo_bring_the_twin_along(material) -> None:
    bpy.ops.ed.undo_push(message="before")
    name = material.name
    principled_node(material).inputs["Base Color"].default_value = (1.0, 0.0, 0.0, 1.0)
    bpy.ops.ed.undo_push(message="red")
    principled_node(bpy.data.materials[name]).inputs["Base Color"].default_value = (0.0, 0.0, 1.0, 1.0)
    bpy.ops.ed.undo_push(message="blue")

    def shown() -> tuple[float, ...]:
        update()
        return tuple(surface_group_node(bpy.data.materials[name]).inputs["Base Color"].default_value)

    bpy.ops.ed.undo()
    assert shown() == (1.0, 0.0, 0.0)
    bpy.ops.ed.redo()
    assert shown() == (0.0, 0.0, 1.0)


def test_what_was_edited_without_the_add_on_shows_when_the_file_is_opened(material, tmp_path) -> None:
    name = material.name
    surface_group_node(material).inputs["Base Color"].default_value = (0.9, 0.9, 0.9)  # as if the twin had missed it
    save(tmp_path / "edited.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "edited.blend"))
    material = bpy.data.materials[name]
    expected = principled_node(material).inputs["Base Color"].default_value[:3]
    assert surface_group_node(material).inputs["Base Color"].default_value[:] == pytest.approx(expected)


def test_deleting_the_probe_gives_the_material_its_own_reflection_back(material, probe) -> None:
    bpy.data.objects.remove(probe)
    update()
    assert not [n for n in material.node_tree.nodes if marks.role(n)]
    assert output_of(material).is_active_output


def test_a_copied_probe_gets_a_group_of_its_own(material, probe) -> None:
    copy = probe.copy()
    bpy.context.scene.collection.objects.link(copy)
    copy.location.x += 0.5
    update()
    assert copy.pcc_probe.group not in (None, probe.pcc_probe.group)
    assert shown_group(material) == probe.pcc_probe.group


def test_a_material_without_twins_is_not_touched(probe) -> None:
    material = shiny("Other")
    show(material)
    principled_node(material).inputs["Roughness"].default_value = 0.2
    update()
    assert not [n for n in material.node_tree.nodes if marks.role(n)]


def test_two_rooms_share_a_material_and_each_object_shows_its_own_probe(probe) -> None:
    other = small_probe("Other", location=(13.0, -2.0, 1.0))
    pretend_bake(other)
    material = shiny("Shared")
    show(material, "Here"), show(material, "There")
    bpy.data.objects["There"].location.x += 10.0
    update()
    report = put_in()
    assert set(report.materials) == {("Shared", "Probe"), ("Shared", "Other")}
    from pcc_addon.blender.planning import plan_scene

    [plan] = plan_scene(bpy.context.scene, bpy.context.view_layer).materials
    assert set(plan.objects) == {("Here", "Probe"), ("There", "Other")}


def test_a_turned_room_beside_another_keeps_its_things(probe) -> None:
    """An object belongs where its own bounds are, not where the box around them in world axes reaches."""
    from pcc_addon.blender.planning import plan_scene

    parent = bpy.data.objects.new("House", None)
    bpy.context.scene.collection.objects.link(parent)
    bpy.data.objects.remove(probe)
    for name, x in (("Left", -2.06), ("Right", 2.06)):
        small_probe(name, location=(x, 0.0, 0.0), half_extents=(2.0, 2.0, 1.0)).parent = parent
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(x + i, j, k) for i in (-2, 2) for j in (-2, 2) for k in (-1, 1)], [], [(0, 1, 3, 2)])
        mesh.materials.append(shiny(f"{name} Walls"))
        item = bpy.data.objects.new(f"{name} Walls", mesh)
        item.parent = parent
        bpy.context.scene.collection.objects.link(item)
    parent.rotation_euler.z = 0.6
    update()
    plans = plan_scene(bpy.context.scene, bpy.context.view_layer).materials
    assert {plan.material: plan.probes for plan in plans} == {"Left Walls": ("Left",), "Right Walls": ("Right",)}
