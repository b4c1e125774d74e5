"""Materials that cannot show a probe: left exactly as they are, and named with the reason."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.shade.injection import remove
from sample_blends.scenes import principled, principled_node
from tests.blender.helpers import put_in
from tests.blender.materials import Material, image_texture, link, output_of, shiny, show
from tests.blender.receivers import mixed, nested
from tests.blender.snapshots import of_the_user, settled
from tests.rna_dump import difference


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
    "its roughness 0.9 is above": refused_input("Roughness", 0.9),
    "has an anisotropy that varies": refused_texture("Anisotropic"),
}


def check_refused(material: Material, reason: str) -> None:
    before = settled()
    report = put_in()
    assert report.materials == ()
    [note] = report.notes
    assert note.startswith(f"material '{material.name_full}'") and reason in note
    assert difference(before, of_the_user()) == []


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="from 5.0 on every material is made of nodes")
def test_a_material_without_nodes_is_left_alone_and_named(probe) -> None:
    material = bpy.data.materials.new("No Nodes")
    show(material)
    check_refused(material, "uses no nodes: switch Use Nodes on; left as it is")


@pytest.mark.parametrize("reason", REFUSED)
def test_a_material_that_cannot_be_handled_is_unchanged_and_named_with_the_reason(probe, reason) -> None:
    material = REFUSED[reason]()
    show(material)
    check_refused(material, reason)


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
    refused, material = REFUSED["has an anisotropy that varies"](), shiny("Good")
    show(refused), show(material)
    report = put_in()
    assert [name for name, _ in report.materials] == ["Good"] and len(report.notes) == 1


def test_a_material_that_reflects_nothing_is_unchanged_without_a_word(probe) -> None:
    show(principled("Matt", Specular_IOR_Level=0.0))
    before = settled()
    report = put_in()
    assert report.materials == () and report.notes == ()
    assert difference(before, of_the_user()) == []


def test_a_material_that_is_too_rough_is_unchanged_and_named(probe) -> None:
    material = principled("Rough", Roughness=0.9)
    show(material)
    check_refused(material, "roughness 0.9 is above the scene's limit 0.6")


def test_all_reasons_are_given(probe) -> None:
    material = principled("Odd", Roughness=0.9, IOR=0.9)
    show(material)
    check_refused(
        material,
        "has an IOR below 1 (1 or more would show a probe, or a roughness of 0) and its roughness 0.9 is above",
    )


def test_a_refused_surface_does_not_keep_the_others_of_its_material_from_showing_the_probe(probe) -> None:
    material = mixed()
    material.node_tree.nodes["Principled BSDF.001"].inputs["IOR"].default_value = 0.9
    show(material)
    before = settled()
    report = put_in()
    assert report.materials == ((material.name, probe.name),)
    [note] = report.notes
    assert "surface 'Principled BSDF.001' keeps its own lobe: has an IOR below 1" in note
    remove()
    assert difference(before, of_the_user()) == []


def loops() -> dict[str, Callable[[], Material]]:
    def shader_into_itself() -> Material:
        material = mixed()
        mix = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeMixShader")
        link(material, mix.outputs[0], mix.inputs[2])
        return material

    def reroute_into_itself() -> Material:
        material = shiny()
        reroute = material.node_tree.nodes.new("NodeReroute")
        link(material, reroute.outputs[0], reroute.inputs[0])
        link(material, reroute.outputs[0], output_of(material).inputs["Surface"])
        return material

    return {"a shader": shader_into_itself, "a reroute": reroute_into_itself}


@pytest.mark.parametrize(("loop", "named"), [("a shader", 1), ("a reroute", 0)])  # the latter shows nothing at all
def test_links_that_go_round_are_named_and_the_other_materials_go_on(probe, loop, named) -> None:
    show(loops()[loop]())
    show(shiny("Good"))
    report = put_in()
    assert report.materials == (("Good", probe.name),)
    assert len(report.notes) == named


def test_a_normal_that_a_group_exposes_and_nobody_gives_is_the_surfaces_own(probe) -> None:
    material = nested()
    inner = bpy.data.node_groups["Inner"]
    inner.interface.new_socket("Normal", in_out="INPUT", socket_type="NodeSocketVector")
    source = next(n for n in inner.nodes if n.bl_idname == "NodeGroupInput")
    surface = next(n for n in inner.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    inner.links.new(source.outputs["Normal"], surface.inputs["Normal"])
    show(material)
    put_in()
    copy = next(t for t in bpy.data.node_groups if t.name.startswith("PCC Inner") and t.users)
    [probe_node] = [n for n in copy.nodes if marks.role(n) == "probe"]
    mirror = probe_node.inputs["Direction"].links[0].from_node
    assert mirror.inputs["Normal"].links[0].from_node.bl_idname == "ShaderNodeNewGeometry"
