"""Materials that cannot show a probe: left exactly as they are, and named with the reason."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import pytest

from sample_blends.scenes import principled, principled_node
from tests.blender.helpers import put_in
from tests.blender.materials import Material, image_texture, link, shiny, show
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
    "has a textured roughness": refused_texture("Roughness"),
    "has a varying IOR": refused_texture("IOR"),
    "transmits light": refused_input("Transmission Weight", 0.5),
    "has a coat": refused_input("Coat Weight", 0.5),
    "has sheen": refused_input("Sheen Weight", 0.5),
    "is anisotropic": refused_input("Anisotropic", 0.5),
    "has a thin film": refused_input("Thin Film Thickness", 300.0),
}


def check_refused(material: Material, reason: str) -> None:
    before = settled()
    report = put_in()
    assert report.materials == ()
    [note] = report.notes
    assert note.startswith(f"material '{material.name}' {reason}") and note.endswith("left as it is")
    assert difference(before, of_the_user()) == []


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
