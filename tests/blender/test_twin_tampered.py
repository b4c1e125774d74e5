"""What users do to injected materials and to pictures: removal still restores, and probe groups stay whole."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.shade.injection import remove
from pcc_addon.blender.status import statuses
from tests.blender.helpers import bake, pictures_of, put_in, save, small_room
from tests.blender.materials import shiny, show


@pytest.fixture
def material(probe) -> bpy.types.Material:
    """A material with two outputs, the second of them active, that shows the probe."""
    material = shiny()
    tree = material.node_tree
    second = tree.nodes.new("ShaderNodeOutputMaterial")
    second.name = "Second"
    tree.links.new(tree.nodes["Principled BSDF"].outputs[0], second.inputs["Surface"])
    second.is_active_output = True
    show(material)
    assert put_in().materials == (("Shiny", "Probe"),)
    assert material.cycles.emission_sampling == "NONE" and not second.is_active_output
    return material


def rename_output(tree: bpy.types.ShaderNodeTree) -> None:
    tree.nodes["Second"].name = "Mine"


def delete_twin_output(tree: bpy.types.ShaderNodeTree) -> None:
    tree.nodes.remove(next(n for n in tree.nodes if marks.role(n) == "output"))


def delete_all_of_the_twin(tree: bpy.types.ShaderNodeTree) -> None:
    for node in [n for n in tree.nodes if marks.role(n)]:
        tree.nodes.remove(node)


@pytest.mark.parametrize("edit", [rename_output, delete_twin_output, delete_all_of_the_twin], ids=lambda f: f.__name__)
def test_removal_brings_back_the_right_output_and_lamp_sampling(material, edit) -> None:
    edit(material.node_tree)
    assert remove() == ["Shiny"]
    active = [n.name for n in material.node_tree.nodes if getattr(n, "is_active_output", False)]
    assert active == ["Mine" if edit is rename_output else "Second"]
    assert material.cycles.emission_sampling == "AUTO"
    assert not [n for n in material.node_tree.nodes if marks.role(n)]


def test_a_missing_picture_leaves_the_probes_group_whole_whatever_is_changed(scene, tmp_path: Path) -> None:
    probe = small_room()
    save(tmp_path / "room.blend")
    bake(probe)
    put_in()
    path, image = pictures_of(probe)[3], probe.pcc_probe.levels[3].image
    whole, nodes = path.read_bytes(), sorted(node.name for node in probe.pcc_probe.group.nodes)
    path.unlink()
    image.reload()
    probe.rotation_euler.x = 0.3
    bpy.context.view_layer.update()
    probe.pcc_probe.padding = 0.5
    probe.pcc_probe.correction = "NONE"
    assert sorted(node.name for node in probe.pcc_probe.group.nodes) == nodes
    [status] = statuses(scene, bpy.context.view_layer)
    assert status.state == "stale" and str(path) in status.why
    path.write_bytes(whole)
    image.reload()
    [status] = statuses(scene, bpy.context.view_layer)
    assert status.state == "baked"
