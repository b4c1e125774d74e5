"""Injecting into materials of many kinds, and taking it back: nothing of the user's changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import groups, twin
from pcc_addon.blender.injection import InjectionReport, inject, remove
from sample_blends.scenes import principled, principled_node
from tests.blender.helpers import ROOM, pretend_bake, small_probe
from tests.rna_dump import difference, dump

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
    for frame, value in ((1, 0.1), (10, 0.9)):
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


RECEIVERS: list[Callable[[], Material]] = [
    plain, with_own_settings, metallic, textured, normal_mapped, mixed, one_shader_twice, added, nested,
    one_group_twice, outputs_of_each_engine, an_output_for_cycles_beside_one_for_all, an_inactive_output,
    a_later_output_in_force, muted, rerouted_and_framed, glowing, see_through, half_see_through, animated, subsurface,
    displaced_and_volumetric, lamp_sampled,
]  # fmt: skip


def refused_input(name: str, value: float) -> Callable[[], Material]:
    def build() -> Material:
        material = shiny()
        principled_node(material).inputs[name].default_value = value
        return material

    return build


def refused_texture(name: str) -> Callable[[], Material]:
    def build() -> Material:
        material = shiny()
        link(material, image_texture(material).outputs["Alpha"], principled_node(material).inputs[name])
        return material

    return build


REFUSED = {
    "has a textured roughness": refused_texture("Roughness"),
    "has a varying IOR": refused_texture("IOR"),
    "transmits light": refused_input("Transmission Weight", 0.5),
    "has a coat": refused_input("Coat Weight", 0.5),
    "has sheen": refused_input("Sheen Weight", 0.5),
    "is anisotropic": refused_input("Anisotropic", 0.5),
    "has a thin film": refused_input("Thin Film Thickness", 300.0),
}


def show(material: Material, name: str = "Mesh") -> bpy.types.Object:
    """An object in the room that wears a material."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    item.location = ROOM.centre
    bpy.context.scene.collection.objects.link(item)
    return item


@pytest.fixture
def probe(scene) -> bpy.types.Object:
    probe = small_probe()
    pretend_bake(probe)
    return probe


def put_in() -> InjectionReport:
    return inject(bpy.context.scene, bpy.context.view_layer)


def of_the_user() -> dict[str, str]:
    """All materials, objects, textures and groups of the user's; and which node of each tree is active."""
    bpy.context.view_layer.update()
    ours = [tree for tree in bpy.data.node_groups if groups.role(tree)]
    ours += [image for image in bpy.data.images if image.name.startswith("PCC ")]
    kinds = ("materials", "objects", "meshes", "node_groups", "images", "actions", "texts")
    lines = {path: value for path, value in dump(kinds, ours).items() if "pcc_probe" not in path}
    lines["images.names"] = repr([i.name for i in bpy.data.images if i not in ours])
    belonging = ("None", "copy", "Surface")  # what goes with a material; lookups go with their probes
    lines["node_groups.names"] = repr(
        [t.name for t in bpy.data.node_groups if str(groups.role(t)).startswith(belonging)]
    )
    for tree in [m.node_tree for m in bpy.data.materials if m.node_tree] + list(bpy.data.node_groups):
        if tree not in ours:
            lines[f"active in {tree.name} of {tree.id_data.name}"] = str(getattr(tree.nodes.active, "name", None))
    return lines


def settled() -> dict[str, str]:
    """The same, read twice: some properties come into being when they are first read."""
    of_the_user()
    return of_the_user()


def material_lines(material: Material) -> dict[str, str]:
    goes_with_it = ("copy", "Surface")
    ours = [tree for tree in bpy.data.node_groups if not str(groups.role(tree)).startswith(goes_with_it)]
    others = [m for m in bpy.data.materials if m != material]
    dump(("materials",), others)  # some properties come into being when they are first read
    lines = dump(("materials", "node_groups"), [*others, *ours])
    lines["node_groups.names"] = repr([tree.name for tree in bpy.data.node_groups if tree not in ours])
    return lines


@pytest.mark.parametrize("build", RECEIVERS, ids=lambda f: f.__name__)
def test_removing_brings_back_exactly_what_was_there(probe, build) -> None:
    material = build()
    show(material)
    before = settled()
    assert put_in().materials == ((material.name, probe.name),)
    assert twin.shown_probe_group(material) == probe.pcc_probe.group
    assert remove() == [material.name]
    assert difference(before, of_the_user()) == []
    assert remove() == [], "removing twice finds nothing"
    assert difference(before, of_the_user()) == []


def test_the_comparison_sees_an_injection_and_a_lost_link(probe) -> None:
    material = textured()
    show(material)
    before = settled()
    put_in()
    assert any(line.startswith("materials[") for line in difference(before, of_the_user()))
    remove()
    material.node_tree.links.remove(principled_node(material).inputs["Metallic"].links[0])
    assert difference(before, of_the_user()) != []


@pytest.mark.parametrize("build", RECEIVERS, ids=lambda f: f.__name__)
def test_injecting_twice_is_injecting_once(probe, build) -> None:
    material = build()
    show(material)
    put_in()
    put_in()
    once = material_lines(material)
    put_in()
    assert difference(once, material_lines(material)) == []


@pytest.mark.parametrize("build", RECEIVERS, ids=lambda f: f.__name__)
def test_the_users_nodes_and_links_stay_while_a_probe_is_shown(probe, build) -> None:
    def own(tree: bpy.types.NodeTree) -> tuple[list[str], list[tuple[str, ...]]]:
        nodes = [node.name for node in tree.nodes if not groups.role(node)]
        ends = [
            (e.from_node.name, e.from_socket.identifier, e.to_node.name, e.to_socket.identifier) for e in tree.links
        ]
        return nodes, [end for end in ends if {end[0], end[2]} <= set(nodes)]

    material = build()
    show(material)
    before = own(material.node_tree)
    put_in()
    assert own(material.node_tree) == before
    for engine in ("CYCLES", "EEVEE"):
        assert groups.role(material.node_tree.get_output_node(engine)), f"{engine} shows no probe"


def test_each_engine_shows_the_twin_of_its_own_output(probe) -> None:
    material = outputs_of_each_engine()
    before = {engine: material.node_tree.get_output_node(engine).name for engine in ("CYCLES", "EEVEE")}
    show(material)
    put_in()
    for engine, original in before.items():
        assert material.node_tree.get_output_node(engine).name == f"PCC {original}"
    remove()
    assert {engine: material.node_tree.get_output_node(engine).name for engine in before} == before


def test_a_value_in_an_outer_group_chooses_the_level(probe) -> None:
    show(nested())
    put_in()
    assert sorted(round(level.roughness, 4) for level in probe.pcc_probe.levels) == [0.0, 0.25]


def test_two_uses_of_a_group_read_their_own_levels(probe) -> None:
    show(one_group_twice())
    put_in()
    assert twin.outputs_in_use(probe.pcc_probe.group) == {groups.level_output(r) for r in (0.25, 0.55)}


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="from 5.0 on every material is made of nodes")
def test_a_material_without_nodes_is_left_alone_and_named(probe) -> None:
    material = bpy.data.materials.new("No Nodes")
    show(material)
    check_refused(material, "uses no nodes")


@pytest.mark.parametrize("reason", REFUSED)
def test_a_material_that_cannot_be_handled_is_unchanged_and_named_with_the_reason(probe, reason) -> None:
    material = REFUSED[reason]()
    show(material)
    check_refused(material, reason)


def check_refused(material: Material, reason: str) -> None:
    before = settled()
    report = put_in()
    assert report.materials == ()
    [note] = report.notes
    assert note.startswith(f"material '{material.name}' {reason}") and note.endswith("left as it is")
    assert difference(before, of_the_user()) == []


def test_a_linked_material_is_unchanged_and_named(probe, tmp_path: Path) -> None:
    material = shiny("Library Shiny")
    path = tmp_path / "library.blend"
    bpy.data.libraries.write(str(path), {material})
    bpy.data.materials.remove(material)
    with bpy.data.libraries.load(str(path), link=True) as (_, target):
        target.materials = ["Library Shiny"]
    [linked] = target.materials
    show(linked)
    check_refused(linked, "is linked from")


def test_refused_materials_do_not_keep_others_from_showing_the_probe(probe) -> None:
    refused, material = REFUSED["has a coat"](), shiny("Good")
    show(refused), show(material)
    report = put_in()
    assert [name for name, _ in report.materials] == ["Good"] and len(report.notes) == 1


def test_a_material_that_reflects_nothing_is_no_concern(probe) -> None:
    show(principled("Matt", Specular_IOR_Level=0.0))
    report = put_in()
    assert report.materials == () and report.notes == ()


def test_a_material_of_several_objects_is_injected_once(probe) -> None:
    material = shiny()
    show(material, "First"), show(material, "Second")
    report = put_in()
    assert report.materials == ((material.name, probe.name),)
    assert len([n for n in material.node_tree.nodes if groups.role(n) == "probe"]) == 1


def test_materials_far_from_every_probe_are_left_alone(probe) -> None:
    material = shiny()
    show(material).location.x += 50.0
    before = material_lines(material)
    assert put_in().materials == ()
    assert difference(before, material_lines(material)) == []


def test_a_material_that_left_the_room_is_restored_by_the_next_injection(probe) -> None:
    material = shiny()
    item = show(material)
    before = settled()
    put_in()
    item.location.x += 50.0
    put_in()
    item.location.x -= 50.0
    assert twin.shown_probe_group(material) is None
    remove()
    assert [line for line in difference(before, of_the_user()) if line.startswith("materials[")] == []


def test_only_the_chosen_objects_materials_are_injected_and_removed(probe) -> None:
    first, second = shiny("First"), shiny("Second")
    one, two = show(first), show(second)
    inject(bpy.context.scene, bpy.context.view_layer, [one])
    assert twin.shown_probe_group(first) and not twin.shown_probe_group(second)
    put_in()
    assert remove([two]) == ["Second"]
    assert twin.shown_probe_group(first) and not twin.shown_probe_group(second)


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


def test_removing_keeps_what_the_user_changed_meanwhile(probe) -> None:
    material = shiny()
    show(material)
    put_in()
    principled_node(material).inputs["Roughness"].default_value = 0.5
    mine = new(material, "ShaderNodeValue")
    mine.name = "Mine"
    remove()
    assert principled_node(material).inputs["Roughness"].default_value == 0.5
    assert "Mine" in material.node_tree.nodes


def test_removing_copes_with_an_output_that_the_user_deleted(probe) -> None:
    material = shiny()
    show(material)
    put_in()
    material.node_tree.nodes.remove(output_of(material))
    remove()
    assert not [n for n in material.node_tree.nodes if groups.role(n)]


def test_a_copy_of_an_injected_material_is_restored_too(probe) -> None:
    material = nested()
    show(material)
    before = {n.name for n in material.node_tree.nodes}
    put_in()
    copy = material.copy()
    show(copy, "Copy")
    put_in()
    assert twin.shown_probe_group(material) and twin.shown_probe_group(copy)
    remove()
    for restored in (material, copy):
        assert {n.name for n in restored.node_tree.nodes} == before
        assert restored.node_tree.get_output_node("CYCLES") is not None
    assert [t.name for t in bpy.data.node_groups if groups.role(t) == "copy"] == []


def test_the_twin_copies_the_values_and_the_settings_of_a_surface(probe) -> None:
    material = subsurface()
    original = principled_node(material)
    original.subsurface_method = "RANDOM_WALK_SKIN"
    show(material)
    put_in()
    [copy] = [n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled" and groups.role(n)]
    assert copy.subsurface_method == "RANDOM_WALK_SKIN"
    assert copy.inputs["Subsurface Weight"].default_value == 0.5
    assert np.allclose(copy.inputs["Subsurface Radius"].default_value, (1.0, 0.2, 0.1))
    assert copy.inputs["Metallic"].default_value == 0.0 and copy.inputs["Specular IOR Level"].default_value == 0.0
