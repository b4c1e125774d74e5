"""What a twin's nodes are fed by: the reflection, what is left beside it, the own lobe, several probes, layers."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender import marks
from pcc_addon.blender.read.materials import read_material
from pcc_addon.blender.shade import live
from pcc_addon.blender.shade.injection import remove
from pcc_addon.blender.shade.twin import (
    add_twins,
    capture_inputs,
    has_twins,
    is_torn,
    reflection_nodes,
    remove_twins,
    shown_probe_groups,
)
from pcc_addon.blender.shade.twin_order import TwinOrder
from pcc_addon.core.effects.lookup import LEAST_SPREAD, MOST_SPREAD
from pcc_addon.core.effects.roughness import neighbours
from pcc_addon.core.lookup_plan import Receivers
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.surface_plan import plan_surfaces
from sample_blends.scenes import Room, add_wall, principled, principled_node
from tests.blender.helpers import pretend_bake, put_in, small_probe
from tests.blender.materials import (
    Material,
    displaced_and_volumetric,
    half_see_through,
    image_texture,
    link,
    metallic,
    normal_mapped,
    see_through,
    shiny,
    show,
    textured,
    with_own_settings,
)
from tests.blender.receivers import coated, glossy, mixed, muted, nested, one_shader_twice, outputs_of_each_engine


def injected(material: Material) -> Material:
    show(material)
    put_in()
    return material


def rough() -> Material:
    material = shiny()
    principled_node(material).inputs["Roughness"].default_value = 0.3
    return material


def ours(material: Material, kind: str) -> list[bpy.types.Node]:
    return [node for node in material.node_tree.nodes if marks.role(node) and node.bl_idname == kind]


def called(material: Material, label: str) -> list[bpy.types.Node]:
    return [node for node in ours(material, "ShaderNodeGroup") if node.label.startswith(label)]


def fed(node: bpy.types.Node, name: str | int) -> tuple[bpy.types.Node, str]:
    """The node and the output that feed an input."""
    [found] = node.inputs[name].links
    return found.from_node, found.from_socket.name


def seen(material: Material) -> bpy.types.Node:
    """The node that the twin's output shows: the probes over the own lobe."""
    [output] = ours(material, "ShaderNodeOutputMaterial")
    return fed(output, "Surface")[0]


def test_a_twin_shows_what_is_left_and_the_reflection_but_behind_diffuse_surfaces_the_original(probe) -> None:
    material = injected(rough())
    original, top = principled_node(material), seen(material)
    assert top.bl_idname == "ShaderNodeMixShader"
    path, share = fed(top, 0)
    assert (path.bl_idname, share) == ("ShaderNodeLightPath", "Diffuse Depth")
    assert fed(top, 2)[0] == original
    both = fed(top, 1)[0]
    assert both.bl_idname == "ShaderNodeAddShader"
    base, glow = fed(both, 0)[0], fed(both, 1)[0]
    [lit] = called(material, "Reflectance")
    assert fed(glow, "Color") == (lit, "Reflection") and glow.inputs["Strength"].default_value == 1.0
    assert fed(base, "Base Color") == (lit, "Diffuse Color")
    assert base.inputs["Metallic"].default_value == base.inputs["Specular IOR Level"].default_value == 0.0
    assert base.inputs["Roughness"].default_value == pytest.approx(0.3)
    assert base.inputs["IOR"].default_value == original.inputs["IOR"].default_value
    assert lit.inputs["Roughness"].default_value == pytest.approx(0.3)
    assert reflection_nodes(material) == [glow]


def test_the_reflection_is_of_the_radiance_between_two_levels_of_the_probe(probe) -> None:
    material = injected(rough())
    [lit], [shown] = (
        called(material, "Reflectance"),
        [n for n in ours(material, "ShaderNodeGroup") if n.node_tree == probe.pcc_probe.group],
    )
    between, radiance = fed(lit, "Radiance")
    assert radiance == "Radiance" and between.inputs["Roughness"].default_value == pytest.approx(0.3)
    low, high = neighbours(LADDER, 0.3, 0.3)
    assert fed(between, "Level 0") == (shown, f"Level {low}") and fed(between, "Level 1") == (shown, f"Level {high}")
    assert f"{LADDER[low]:.3g} {LADDER[high]:.3g}" in between.label
    assert shown.node_tree == probe.pcc_probe.group and shown_probe_groups(material) == (probe.pcc_probe.group,)
    way, _ = fed(shown, "Direction")
    assert "Dominant Direction, IOR" in way.label and way.inputs["Roughness"].default_value == pytest.approx(0.3)
    for node, name in ((way, "Normal"), (way, "Incoming"), (lit, "Normal"), (lit, "Incoming")):
        geometry, output = fed(node, name)
        assert (geometry.bl_idname, output) == ("ShaderNodeNewGeometry", name)
    assert len(ours(material, "ShaderNodeNewGeometry")) == 1


def test_where_a_probe_hardens_rough_surfaces_read_more_levels_at_what_it_says(probe) -> None:
    rough_one = injected(rough())
    probe.pcc_probe.contact_hardening = True
    [lit] = called(rough_one, "Reflectance")
    between, _ = fed(lit, "Radiance")
    shown, spread = fed(between, "Spread")
    read = neighbours(LADDER, 0.3 * LEAST_SPREAD, 0.3 * MOST_SPREAD)
    assert marks.role(shown) == "probe" and spread == "Spread"
    assert [fed(between, f"Level {k}")[1] for k in range(len(read))] == [f"Level {level}" for level in read]
    probe.pcc_probe.contact_hardening = False
    [lit] = called(rough_one, "Reflectance")
    assert "Spread" not in fed(lit, "Radiance")[0].inputs


def test_a_mirror_reads_its_level_itself_however_near_things_are(probe) -> None:
    probe.pcc_probe.contact_hardening = True
    material = injected(shiny())
    [lit] = called(material, "Reflectance")
    node, output = fed(lit, "Radiance")
    assert marks.role(node) == "probe" and output == "Level 0"


def test_our_nodes_lie_below_the_original_and_none_is_selected(probe) -> None:
    material = shiny()
    principled_node(material).location = (120.0, -30.0)
    injected(material)
    added = [node for node in material.node_tree.nodes if marks.role(node) not in (None, "frame")]
    lowest = min(n.location.y - n.height for n in material.node_tree.nodes if not marks.role(n))
    assert added and not any(node.select for node in added)
    assert all(node.location.y < lowest for node in added)
    assert {node.parent.label for node in added} == {"PCC Parallax Probes"}


def test_the_output_is_named_in_force_and_takes_the_rest_along(probe) -> None:
    material = displaced_and_volumetric()
    own = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    both = material.node_tree.nodes.new("ShaderNodeAddShader")
    link(material, own.inputs["Volume"].links[0].from_socket, both.inputs[0])
    link(material, both.outputs[0], own.inputs["Volume"])
    injected(material)
    [output] = ours(material, "ShaderNodeOutputMaterial")
    assert output.is_active_output and output.label == "Material Output, Parallax Probe"
    assert fed(output, "Displacement")[0].bl_idname == "ShaderNodeDisplacement"
    assert fed(output, "Volume")[0] == both, "a volume is no surface and has no twin"


def test_textures_go_to_the_reflection_and_normals_to_the_lookup(probe) -> None:
    material = injected(textured())
    [lit], [texture] = called(material, "Reflectance"), [n for n in material.node_tree.nodes if n.type == "TEX_IMAGE"]
    assert fed(lit, "Base Color") == (texture, "Color") and fed(lit, "Metallic") == (texture, "Alpha")
    assert fed(lit, "Specular IOR Level") == (texture, "Alpha")
    base = next(n for n in ours(material, "ShaderNodeBsdfPrincipled"))
    assert not base.inputs["Metallic"].is_linked and not base.inputs["Specular IOR Level"].is_linked
    bumpy = injected(normal_mapped())
    [lit] = called(bumpy, "Reflectance")
    [shown] = [n for n in bumpy.node_tree.nodes if marks.role(n) == "probe"]
    [bent] = called(bumpy, "Valid Normal")
    for node in (bent, *ours(bumpy, "ShaderNodeBsdfPrincipled")):
        assert fed(node, "Normal")[0].bl_idname == "ShaderNodeNormalMap"
    mirror, _ = fed(shown, "Direction")
    assert fed(lit, "Normal")[0] == fed(mirror, "Normal")[0] == bent


def test_what_is_seen_through_reflects_less(probe) -> None:
    half, mapped = injected(half_see_through()), injected(see_through())
    assert [n.inputs["Strength"].default_value for n in ours(half, "ShaderNodeEmission")] == [0.5]
    [glow] = ours(mapped, "ShaderNodeEmission")
    assert fed(glow, "Strength")[1] == "Alpha"
    principled_node(half).inputs["Alpha"].default_value = 0.25
    live.copy_values(half.node_tree)
    assert [n.inputs["Strength"].default_value for n in ours(half, "ShaderNodeEmission")] == [0.25]


def test_where_the_roughness_varies_rough_places_keep_their_own_lobe(probe) -> None:
    material = shiny()
    link(material, image_texture(material).outputs["Alpha"], principled_node(material).inputs["Roughness"])
    injected(material)
    [own] = called(material, "Own Lobe")
    assert fed(seen(material), 0) == (own, "Share")
    assert own.inputs["Coverage"].default_value == 1.0 and not own.inputs["Coverage"].is_linked
    assert fed(own, "Roughness")[0].bl_idname == "ShaderNodeTexImage"
    assert fed(own, "Diffuse Depth")[1] == "Diffuse Depth"
    assert capture_inputs(material) == [own.inputs["Captured"]] and own.inputs["Captured"].default_value == 0.0
    assert "0.6" in own.node_tree.name


def test_a_surface_that_leaves_the_box_is_covered_by_the_probes_weight(probe) -> None:
    material = shiny()
    show(material).scale = (9.0, 9.0, 1.0)
    bpy.context.view_layer.update()
    put_in()
    [own] = called(material, "Own Lobe")
    node, output = fed(own, "Coverage")
    assert marks.role(node) == "probe" and output == "Weight"
    assert fed(seen(material), 0) == (own, "Share")


def test_two_probes_are_mixed_by_place_the_smaller_over_the_larger(probe) -> None:
    small = small_probe("Alcove", half_extents=(1.0, 1.0, 0.75))
    small.pcc_probe.falloff = 0.125
    pretend_bake(small)
    material = injected(shiny())
    large_node, small_node = (
        next(n for n in material.node_tree.nodes if marks.role(n) == "probe" and n.node_tree == p.pcc_probe.group)
        for p in (probe, small)
    )
    assert large_node.location.y - small_node.location.y > 200.0, "drawn one below the other"
    [step] = called(material, "Probe Over")
    assert fed(step, "Depth") == (small_node, "Depth") and not called(material, "Outside")
    assert step.inputs["Fade"].default_value == pytest.approx(0.125)
    for name, node in (("Coverage", large_node), ("Weight", small_node)):
        if "Weight" in node.outputs:
            assert fed(step, name) == (node, "Weight")
        else:
            assert step.inputs[name].default_value == 1.0 and not step.inputs[name].is_linked
    total = fed(seen(material), 1)[0]
    by_place = fed(total, 1)[0]
    assert fed(by_place, 0) == (step, "Share")
    for slot, node in ((1, large_node), (2, small_node)):
        lit = fed(fed(by_place, slot)[0], "Color")[0]
        assert fed(lit, "Radiance")[0] == node
    if called(material, "Own Lobe"):
        assert fed(called(material, "Own Lobe")[0], "Coverage") == (step, "Coverage")


def test_layers_dim_a_reflection_that_the_whole_surface_emits(probe) -> None:
    material = coated()
    principled_node(material).inputs["Emission Color"].default_value = (0.5, 0.25, 0.125, 1.0)
    injected(material)
    mix = fed(seen(material), 1)[0]
    assert mix.inputs[0].default_value == 1.0
    base, whole = fed(mix, 1)[0], fed(mix, 2)[0]
    assert base.inputs["Coat Weight"].default_value == 0.0 and whole.inputs["Coat Weight"].default_value == 0.5
    assert whole.inputs["Sheen Weight"].default_value == pytest.approx(0.3)
    add = fed(whole, "Emission Color")[0]
    assert add.operation == "MULTIPLY_ADD" and fed(add, 2)[1] == "Reflection"
    assert add.inputs[0].default_value[:] == (0.5, 0.25, 0.125) and add.inputs[1].default_value[:] == (0.0, 0.0, 0.0)
    principled_node(material).inputs["Emission Strength"].default_value = 3.0
    live.copy_values(material.node_tree)
    assert add.inputs[1].default_value[:] == (3.0, 3.0, 3.0) and whole.inputs["Emission Strength"].default_value == 1.0
    assert mix in reflection_nodes(material)


def test_a_lobe_without_base_is_the_reflection_alone(probe) -> None:
    material = injected(glossy())
    top = seen(material)
    assert fed(top, 2)[0].bl_idname == "ShaderNodeBsdfAnisotropic"
    shown = fed(top, 1)[0]
    assert shown.bl_idname == "ShaderNodeMixShader" and shown.inputs[0].default_value == 1.0
    captured, glow = fed(shown, 1)[0], fed(shown, 2)[0]
    assert (captured.bl_idname, glow.bl_idname) == ("ShaderNodeBsdfDiffuse", "ShaderNodeEmission")
    assert set(reflection_nodes(material)) == {shown, glow}, "muted, the matt surface is left"
    assert not ours(material, "ShaderNodeAddShader")


def test_glass_looks_along_two_rays_and_captures_see_it_whole(probe) -> None:
    material = injected(principled("Glass", Transmission_Weight=1.0, Roughness=0.0))
    top = seen(material)
    own, lit = fed(top, 1)[0], called(material, "Reflectance")[0]
    assert own == principled_node(material) and fed(top, 0)[1] == "Covered", "muted, the own lobe is left"
    seen_by = {fed(lit, name)[0]: name for name in ("Radiance", "Transmitted Radiance")}
    ways = {name: fed(node, "Direction")[0].label.partition(",")[0] for node, name in seen_by.items()}
    assert ways == {"Radiance": "Mirror", "Transmitted Radiance": "Refracted"}, "what wears it is a plane"
    [base] = ours(material, "ShaderNodeBsdfPrincipled")
    assert base.inputs["Transmission Weight"].default_value == 0.0


def choose_as_a_later_blender(node: bpy.types.Node, name: str) -> None:
    """Give a choice of a node a number that this Blender does not know, as in a file of a later one."""
    memory = (ctypes.c_ubyte * 256).from_address(node.as_pointer())  # of the node's own struct, which is larger
    seen = []
    for item in list(node.bl_rna.properties[name].enum_items)[:2]:
        setattr(node, name, item.identifier)
        seen.append(bytes(memory))
    [place] = [k for k, (a, b) in enumerate(zip(*seen, strict=True)) if a != b]
    memory[place] = 99


def test_a_choice_of_a_later_blender_is_left_to_this_one(probe) -> None:
    material = shiny()
    node = principled_node(material)
    choose_as_a_later_blender(node, "subsurface_method")
    assert node.subsurface_method == ""
    show(material)
    assert put_in().materials == ((material.name, probe.name),)
    assert node.subsurface_method == ""


@pytest.mark.parametrize("build", [shiny, metallic, glossy])
def test_without_probes_a_twin_is_what_captures_see(scene, build: Callable[[], Material]) -> None:
    material = build()
    plans = plan_surfaces(read_material(material), 0.6)
    add_twins(material, TwinOrder((), {plan.path: plan for plan in plans}))
    top = seen(material)
    assert fed(top, 0)[1] == "Diffuse Depth" and not marks.role(fed(top, 2)[0]), "walls get the lobe's light"
    captured = fed(top, 1)[0]
    if build is glossy:
        assert captured.bl_idname == "ShaderNodeBsdfDiffuse"
    else:
        assert captured.bl_idname == "ShaderNodeBsdfPrincipled" and fed(captured, "Base Color")[1] == "Diffuse Color"
    [lit] = called(material, "Reflectance") or [None]
    assert (lit is not None and "Captured" in lit.inputs) == (build is metallic)
    assert build is not metallic or lit.inputs["Captured"].default_value == 1.0
    assert not shown_probe_groups(material) and has_twins(material)
    assert material.cycles.emission_sampling != "NONE", "nothing glows"


def test_shaders_around_a_surface_are_copied_and_read_its_twin(probe) -> None:
    material = mixed()
    original = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeMixShader")
    original.inputs[0].default_value = 0.25
    injected(material)
    copy = seen(material)
    assert copy != original and copy.bl_idname == original.bl_idname and copy.inputs[0].default_value == 0.25
    for slot, name in ((1, "Principled BSDF"), (2, "Principled BSDF.001")):
        assert fed(fed(copy, slot)[0], 2)[0].name == name
    twice = injected(one_shader_twice())
    assert len(called(twice, "Reflectance")) == 1
    assert fed(seen(twice), 1)[0] == fed(seen(twice), 2)[0]


def test_an_empty_slot_beside_a_surface_stays_empty(probe) -> None:
    material = shiny()
    add = material.node_tree.nodes.new("ShaderNodeAddShader")
    link(material, principled_node(material).outputs[0], add.inputs[1])
    output = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    link(material, add.outputs[0], output.inputs["Surface"])
    injected(material)
    copy = seen(material)
    assert copy.bl_idname == "ShaderNodeAddShader" and copy != add
    assert not copy.inputs[0].is_linked and fed(copy, 1)[0].bl_idname == "ShaderNodeMixShader"


def test_a_muted_shader_stays_in_its_place(probe) -> None:
    material = injected(muted())
    off = material.node_tree.nodes["Principled BSDF.001"]
    assert fed(seen(material), 2)[0] == off and off.mute
    [lit] = called(material, "Reflectance")
    assert fed(lit, "Base Color")[0].bl_idname == "ShaderNodeBrightContrast"


def test_groups_are_copied_for_the_material_and_go_with_its_twins(probe) -> None:
    material = injected(nested())
    copies = {tree.name: tree for tree in bpy.data.node_groups if marks.role(tree) == "copy"}
    assert set(copies) == {f"PCC Inner, {material.name}", f"PCC Outer, {material.name}"}
    inner = copies[f"PCC Inner, {material.name}"]
    [lit] = [n for n in inner.nodes if n.label == "Reflectance"]
    assert fed(lit, "Base Color") == (next(n for n in inner.nodes if n.bl_idname == "NodeGroupInput"), "Color")
    assert shown_probe_groups(material) == (probe.pcc_probe.group,)
    outer = next(n for n in ours(material, "ShaderNodeGroup") if n.node_tree == copies[f"PCC Outer, {material.name}"])
    assert outer.inputs["Roughness"].default_value == 0.25
    assert not any(marks.role(n) for n in bpy.data.node_groups["Inner"].nodes)
    assert len(reflection_nodes(material)) == 1 and not is_torn(material)
    bpy.data.node_groups.remove(lit.node_tree)
    assert is_torn(material)
    assert remove() == [material.name]
    assert not [tree for tree in bpy.data.node_groups if marks.role(tree) == "copy"]


def test_removing_says_whether_there_was_something(probe) -> None:
    material = shiny()
    assert not has_twins(material) and remove_twins(material) is False and not is_torn(material)
    injected(material)
    assert has_twins(material) and remove_twins(material)
    assert not has_twins(material) and not remove_twins(material)
    assert not [node for node in material.node_tree.nodes if marks.role(node)]


def test_each_engine_gets_its_own_twin_and_gets_its_output_back(probe) -> None:
    material = injected(outputs_of_each_engine())
    twins = {node.target: node for node in ours(material, "ShaderNodeOutputMaterial")}
    assert set(twins) == {"CYCLES", "EEVEE"}
    own = [n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL" and not marks.role(n)]
    assert {n.target for n in own} == {"ALL"}
    assert material.node_tree.get_output_node("CYCLES") == twins["CYCLES"]
    assert remove_twins(material) and [n.target for n in own] == ["CYCLES", "EEVEE"]


@pytest.mark.parametrize("sampling", [None, "FRONT", "NONE"])
def test_lamp_sampling_comes_back_as_it_was(probe, sampling: str | None) -> None:
    material = shiny()
    if sampling:
        material.cycles.emission_sampling = sampling
    injected(material)
    assert material.cycles.emission_sampling == "NONE"
    remove_twins(material)
    assert material.cycles.is_property_set("emission_sampling") is (sampling is not None)
    assert material.cycles.emission_sampling == (sampling or "AUTO")


def test_a_material_that_shows_the_probe_already_keeps_its_nodes(probe) -> None:
    material = injected(rough())
    before = [node.as_pointer() for node in material.node_tree.nodes]
    put_in()
    assert [node.as_pointer() for node in material.node_tree.nodes] == before
    principled_node(material).inputs["Roughness"].default_value = 0.5
    put_in()
    [lit] = called(material, "Reflectance")
    assert lit.inputs["Roughness"].default_value == 0.5


def test_formula_groups_are_shared_and_go_when_nothing_uses_them(probe) -> None:
    injected(rough()), injected(rough())
    roles = [str(marks.role(tree)) for tree in bpy.data.node_groups]
    assert "None" not in roles and len(set(roles)) == len(roles)
    lights = {role for role in roles if role.startswith(("formula: Surface", "formula: Levels"))}
    assert lights
    remove()
    assert not lights & {marks.role(tree) for tree in bpy.data.node_groups}


def test_a_probe_that_fades_otherwise_fades_so_in_every_twin(probe) -> None:
    small = small_probe("Alcove", half_extents=(1.0, 1.0, 0.75))
    pretend_bake(small)
    material = injected(shiny())
    for falloff in (0.125, 0.5):
        small.pcc_probe.falloff = falloff
        put_in()
        [step] = called(material, "Probe Over")
        assert step.inputs["Fade"].default_value == pytest.approx(falloff)


def test_a_weight_that_a_probe_newly_gives_reaches_the_twins_that_show_it(probe) -> None:
    material = injected(shiny())
    assert not called(material, "Own Lobe")
    live.refresh_probe(probe, 0.6, Receivers())
    [own] = called(material, "Own Lobe")
    assert fed(own, "Coverage")[1] == "Weight"
    live.refresh_probe(probe, 0.6, Receivers(all_inside=True, seen_from_outside=False))
    assert not called(material, "Own Lobe")


def test_glass_reads_other_levels_once_its_roughness_calls_for_them_behind_it_alone(probe) -> None:
    """What is seen through glass is less blurred than its reflection, so the two change levels at other roughnesses."""
    material = injected(principled("Glass", Transmission_Weight=1.0, Roughness=0.5))
    lit = called(material, "Reflectance")[0]
    before = {name: fed(lit, name)[0].label for name in ("Radiance", "Transmitted Radiance")}
    principled_node(material).inputs["Roughness"].default_value = 0.59
    put_in()
    lit = called(material, "Reflectance")[0]
    after = {name: fed(lit, name)[0].label for name in before}
    [behind] = [n for n in called(material, "Levels") if n.label == after["Transmitted Radiance"]]
    narrowing = math.sqrt((1.0 - 1.0 / 1.5) / 2.0)  # Walter et al. 2007: of a mirror that spreads as one interface does
    low, high = neighbours(LADDER, 0.59 * narrowing, 0.59 * narrowing)
    assert f"{LADDER[low] / narrowing:.3g} {LADDER[high] / narrowing:.3g}" in behind.label
    assert after["Radiance"] == before["Radiance"] and after["Transmitted Radiance"] != before["Transmitted Radiance"]


def test_a_copied_node_has_the_settings_of_its_original(probe) -> None:
    material = injected(with_own_settings())
    [copy] = ours(material, "ShaderNodeBsdfPrincipled")
    assert (copy.distribution, copy.subsurface_method) == ("GGX", "RANDOM_WALK_SKIN")
    assert copy.name != principled_node(material).name and copy.label == ""


def axis_of(item: bpy.types.Object, socket: bpy.types.NodeSocket) -> np.ndarray:
    """What the nodes before an input make of an object: a vector of its own axes in the world's, of unit length."""
    [unit] = [link.from_node for link in socket.links]
    [turn] = [link.from_node for link in unit.inputs[0].links]
    assert unit.operation == "NORMALIZE"
    assert (turn.vector_type, turn.convert_from, turn.convert_to) == ("VECTOR", "OBJECT", "WORLD")
    return np.array((item.matrix_world.to_3x3() @ Vector(turn.inputs[0].default_value)).normalized())


def test_a_solid_of_glass_is_bent_through_along_its_own_axes_and_size(probe) -> None:
    material = principled("Glass", Transmission_Weight=1.0, Roughness=0.0)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.25, location=probe.location, rotation=(0.4, -0.7, 1.1))
    ball = bpy.context.object
    ball.scale = (1.0, 2.0, 0.5)
    ball.data.materials.append(material)
    bpy.context.view_layer.update()
    put_in()
    [way] = called(material, "Through a Solid")
    turned = ball.matrix_world.to_3x3().normalized()
    for k, name in enumerate("XYZ"):
        np.testing.assert_allclose(axis_of(ball, way.inputs[f"Axis {name}"]), turned.col[k], atol=1e-6)
    size, output = fed(way, "Dimensions")
    assert (size.attribute_type, output) == ("OBJECT", "Vector")
    np.testing.assert_allclose(getattr(ball, size.attribute_name), (0.5, 1.0, 0.25), rtol=1e-2)
    assert [fed(way, name)[1] for name in ("Normal", "Incoming")] == ["Normal", "Incoming"]


def test_how_far_the_nearest_room_is_is_found_out_once_for_all_that_ask(scene) -> None:
    floor = shiny()
    for k in range(4):
        room = small_probe(f"Room {k}", (5.0 * k, 0.0, 0.0), (2.0, 1.5, 1.0))
        pretend_bake(room)
    add_wall(Room((10.0, 1.5, 1.0), (7.5, 0.0, 0.0), 0.0), "-Z", floor)
    put_in()
    assert len(called(floor, "Probe Beside")) == 3
    depths = [fed(node, "Depth")[0] for node in called(floor, "Outside")]
    assert len(depths) == len(set(depths)) == 3, "the last room is before none"
    nearer = called(floor, "Nearer")
    assert len(nearer) == 2
    beside = called(floor, "Probe Beside")
    assert {fed(node, "Distance")[0] for node in beside} == {called(floor, "Outside")[0], *nearer}
