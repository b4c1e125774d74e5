"""What makes a bake stale and what does not, by its hash alone: nothing is rendered here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.node_lines import node_lines
from pcc_addon.core.probe import Engine
from sample_blends.scenes import principled_node
from tests.blender.helpers import save
from tests.blender.materials import image_texture, link, new, output_of, shiny, show
from tests.core.scenes import spec

PROBE = spec("Probe", capture_offset=(0.1, 0.2, 0.3), resolution=64, samples=16)


def fingerprint(probe: object = PROBE) -> str:
    bpy.context.view_layer.update()
    return SceneFingerprint(bpy.context.scene, bpy.context.view_layer).content_hash(probe)


@pytest.fixture
def item(scene) -> bpy.types.Object:
    """A triangle with attributes, modifiers, a group in its material and a muted link to mend; a lamp; a world."""
    material = shiny()
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    inner.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    rgb, sink = inner.nodes.new("ShaderNodeRGB"), inner.nodes.new("NodeGroupOutput")
    mix = inner.nodes.new("ShaderNodeBrightContrast")
    inner.links.new(rgb.outputs[0], mix.inputs["Color"])
    inner.links.new(mix.outputs[0], sink.inputs[0])
    ramp, curves = new(material, "ShaderNodeValToRGB"), new(material, "ShaderNodeRGBCurve")
    link(material, ramp.outputs["Color"], curves.inputs["Color"])
    link(material, curves.outputs["Color"], principled_node(material).inputs["Emission Color"])
    group, texture = new(material, "ShaderNodeGroup"), image_texture(material)
    group.node_tree = inner
    link(material, group.outputs[0], principled_node(material).inputs["Base Color"])
    link(material, texture.outputs["Alpha"], principled_node(material).inputs["Metallic"])
    item = show(material, "Item")
    bevel = item.modifiers.new("Bevel", "BEVEL")
    bevel.width = 0.1
    mesh = item.data
    mesh.attributes.new("Paint", "FLOAT_COLOR", "POINT")
    mesh.attributes.new("Bytes", "BYTE_COLOR", "CORNER")
    for kind in ("FLOAT", "INT", "BOOLEAN", "FLOAT_VECTOR"):
        mesh.attributes.new(kind.title(), kind, "POINT")
    mesh.uv_layers.new(name="UV")
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    scene.collection.objects.link(lamp)
    bpy.context.view_layer.update()
    return item


def the(name: str) -> bpy.types.Object:
    return bpy.data.objects[name]


def tree() -> bpy.types.NodeTree:
    return bpy.data.materials["Shiny"].node_tree


def attribute(name: str, field: str, value: object) -> Callable[[], None]:
    return lambda: setattr(the("Item").data.attributes[name].data[0], field, value)


def flag(name: str) -> Callable[[], None]:
    return lambda: setattr(the("Item"), name, not getattr(the("Item"), name))


def setting(name: str) -> Callable[[], None]:
    def change() -> None:
        cycles, value = bpy.context.scene.cycles, getattr(bpy.context.scene.cycles, name)
        setattr(cycles, name, (not value) if isinstance(value, bool) else value + 1)

    return change


def new_modifier() -> None:
    the("Item").modifiers.new("Array", "ARRAY")


CHANGES: dict[str, Callable[[], None]] = {
    **{f"cycles.{name}": setting(name) for name in (
        "max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces",
        "transparent_max_bounces", "sample_clamp_direct", "sample_clamp_indirect", "caustics_reflective",
        "caustics_refractive", "blur_glossy", "use_fast_gi",
    )},
    **{name: flag(name) for name in (
        "visible_glossy", "visible_diffuse", "visible_transmission", "visible_shadow", "is_shadow_catcher",
        "hide_render",
    )},
    "a colour attribute": attribute("Paint", "color", (0.25, 0.5, 0.75, 1.0)),
    "a byte colour": attribute("Bytes", "color", (0.25, 0.5, 0.75, 1.0)),
    "a number attribute": attribute("Float", "value", 0.5),
    "a whole number attribute": attribute("Int", "value", 3),
    "a truth attribute": attribute("Boolean", "value", True),
    "a vector attribute": attribute("Float_Vector", "vector", (1.0, 2.0, 3.0)),
    "a texture coordinate": attribute("UV", "vector", (0.5, 0.25)),
    "an attribute's name": lambda: setattr(the("Item").data.attributes["Float"], "name", "Other"),
    "a corner moved by a tenth of a millimetre": lambda: setattr(the("Item").data.vertices[1].co, "x", 1.0001),
    "a modifier's width": lambda: setattr(the("Item").modifiers[0], "width", 0.1001),
    "a modifier switched off": lambda: setattr(the("Item").modifiers[0], "show_render", False),
    "a new modifier": new_modifier,
    "an object turned": lambda: setattr(the("Item").rotation_euler, "z", 0.001),
    "a lamp's strength": lambda: setattr(the("Lamp").data, "energy", the("Lamp").data.energy * 1.001),
    "a lamp's size": lambda: setattr(the("Lamp").data, "shadow_soft_size", 0.11),
    "a value in the third digit": lambda: setattr(
        principled_node(bpy.data.materials["Shiny"]).inputs["Roughness"], "default_value", 0.001
    ),
    "a link cut": lambda: tree().links.remove(principled_node(bpy.data.materials["Shiny"]).inputs["Metallic"].links[0]),
    "a link muted": lambda: setattr(
        principled_node(bpy.data.materials["Shiny"]).inputs["Metallic"].links[0], "is_muted", True
    ),
    "a link moved": lambda: tree().links.new(
        tree().nodes["Image Texture"].outputs["Alpha"],
        principled_node(bpy.data.materials["Shiny"]).inputs["Roughness"],
    ),
    "a node muted": lambda: setattr(tree().nodes["Image Texture"], "mute", True),
    "a node's setting": lambda: setattr(tree().nodes["Image Texture"], "interpolation", "Closest"),
    "a node's picture": lambda: setattr(tree().nodes["Image Texture"], "image", bpy.data.images.new("Other", 8, 4)),
    "a colour": lambda: setattr(
        principled_node(bpy.data.materials["Shiny"]).inputs["Specular Tint"], "default_value", (1.0, 0.5, 1.0, 1.0)
    ),
    "a colour ramp's stop": lambda: setattr(tree().nodes["Color Ramp"].color_ramp.elements[0], "position", 0.25),
    "a colour ramp's colour": lambda: setattr(
        tree().nodes["Color Ramp"].color_ramp.elements[1], "color", (1.0, 0.0, 0.0, 1.0)
    ),
    "a colour ramp's new stop": lambda: tree().nodes["Color Ramp"].color_ramp.elements.new(0.5),
    "a curve's point": lambda: setattr(
        tree().nodes["RGB Curves"].mapping.curves[3].points[0], "location", (0.0, 0.25)
    ),
    "a value inside a group": lambda: setattr(
        next(n for n in bpy.data.node_groups["Inner"].nodes if n.bl_idname == "ShaderNodeBrightContrast").inputs[1],
        "default_value", 0.5,
    ),
    "a link inside a group": lambda: bpy.data.node_groups["Inner"].links.remove(
        bpy.data.node_groups["Inner"].links[0]
    ),
    "another material": lambda: the("Item").data.materials.append(shiny("Second")),
    "the world's colour": lambda: setattr(bpy.context.scene.world, "color", (0.1, 0.2, 0.3)),
    "no world": lambda: setattr(bpy.context.scene, "world", None),
    "a lamp removed": lambda: bpy.data.objects.remove(the("Lamp")),
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_a_picture_shows_changes_the_hash(item, change: Callable[[], None]) -> None:
    before = fingerprint()
    assert fingerprint() == before, "the hash holds while nothing changes"
    change()
    assert fingerprint() != before


def camera() -> None:
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))


def nothing_shown() -> None:
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Empty", None))


def hidden_object() -> None:
    show(shiny("Unseen"), "Unseen").hide_render = True


def select() -> None:
    mesh = the("Item").data
    for vertex in mesh.vertices:
        vertex.select = True
        vertex.hide = True


NO_CHANGES: dict[str, Callable[[], None]] = {
    "an object selected": lambda: the("Item").select_set(True),
    "corners selected and hidden": select,
    "a camera": camera,
    "an empty": nothing_shown,
    "an object that is not rendered": hidden_object,
    "a node moved": lambda: setattr(tree().nodes["Image Texture"], "location", (500.0, 100.0)),
    "a curve's point selected": lambda: setattr(
        tree().nodes["RGB Curves"].mapping.curves[3].points[0],
        "select",
        not tree().nodes["RGB Curves"].mapping.curves[3].points[0].select,
    ),
    "a node's label": lambda: setattr(tree().nodes["Image Texture"], "label", "Mine"),
    "an output's target": lambda: setattr(output_of(bpy.data.materials["Shiny"]), "target", "CYCLES"),
    "a modifier's panel": lambda: setattr(the("Item").modifiers[0], "show_expanded", False),
    "the viewport": lambda: setattr(the("Item"), "show_name", True),
    "the picture's size": lambda: setattr(bpy.context.scene.render, "resolution_x", 123),
}


@pytest.mark.parametrize("change", NO_CHANGES.values(), ids=NO_CHANGES)
def test_what_no_picture_shows_does_not_change_the_hash(item, change: Callable[[], None]) -> None:
    before = fingerprint()
    change()
    assert fingerprint() == before


@pytest.mark.parametrize(
    "change",
    [
        {"capture_offset": (0.1, 0.2, 0.301)}, {"resolution": 65}, {"samples": 17}, {"engine": Engine.EEVEE},
        {"denoise": False}, {"clip_start": 0.011}, {"clip_end": 1001.0}, {"hidden": ("Item",)},
    ],
    ids=str,
)  # fmt: skip
def test_settings_of_the_capture_change_the_hash(item, change: dict) -> None:
    assert fingerprint(replace(PROBE, **change)) != fingerprint()


@pytest.mark.parametrize(
    "change", [{"padding": 0.5}, {"falloff": 0.5}, {"corrected": False}, {"hidden": ("Nobody",)}], ids=str
)
def test_settings_of_the_shader_do_not(item, change: dict) -> None:
    assert fingerprint(replace(PROBE, **change)) == fingerprint()


def test_the_hash_is_the_same_when_the_file_is_opened_again(item, tmp_path: Path) -> None:
    before = fingerprint()
    save(tmp_path / "saved.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    assert fingerprint() == before


def test_polygons_of_the_same_corners_are_told_apart(scene) -> None:
    """Seven corners as four and three, or as three and four."""
    item = show(shiny(), "Item")
    mesh = item.data
    mesh.clear_geometry()
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)] * 2, [], [(0, 1, 2, 3), (4, 5, 6)])
    first = fingerprint()
    mesh.clear_geometry()
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)] * 2, [], [(0, 1, 2), (3, 4, 5, 6)])
    assert fingerprint() != first


def test_lines_without_values_leave_out_those_of_the_tree_itself_and_not_of_groups(item) -> None:
    def lines() -> list[str]:
        return node_lines(tree(), values=False)

    before = lines()
    principled_node(bpy.data.materials["Shiny"]).inputs["Roughness"].default_value = 0.4
    CHANGES["a colour ramp's stop"]()
    CHANGES["a curve's point"]()
    assert lines() == before and before
    CHANGES["a value inside a group"]()
    assert lines() != before
    assert node_lines(None) == []


def test_a_group_has_its_lines_once_however_often_it_is_used(scene) -> None:
    """Each of twenty groups uses the next one twice; read at every use they would be a million."""
    groups = [bpy.data.node_groups.new(f"Depth {k}", "ShaderNodeTree") for k in range(20)]
    for outer, inner in pairwise(groups):
        for _ in range(2):
            outer.nodes.new("ShaderNodeGroup").node_tree = inner
    groups[-1].nodes.new("ShaderNodeValue").name = "The innermost"
    material = shiny()
    for _ in range(2):
        new(material, "ShaderNodeGroup").node_tree = groups[0]
    lines = node_lines(material.node_tree)
    assert len([line for line in lines if line.startswith("node ") and "The innermost" in line]) == 1


def passing(tree_: bpy.types.NodeTree) -> bpy.types.Node:
    """A group's two ends, and a node between them that mixes what feeds it."""
    for way in ("INPUT", "OUTPUT"):
        tree_.interface.new_socket("Color", in_out=way, socket_type="NodeSocketColor")
    source, sink = tree_.nodes.new("NodeGroupInput"), tree_.nodes.new("NodeGroupOutput")
    mix = tree_.nodes.new("ShaderNodeMixRGB")
    tree_.links.new(source.outputs[0], mix.inputs[1])
    tree_.links.new(mix.outputs[0], sink.inputs[0])
    return mix


def test_groups_in_groups_are_read_once_and_to_the_last(scene) -> None:
    """Each of twenty groups uses the next one twice; read at every use they would be a million."""
    groups = [bpy.data.node_groups.new(f"Depth {k}", "ShaderNodeTree") for k in range(20)]
    mixes = [passing(group) for group in groups]
    for outer, inner, mix in zip(groups, groups[1:], mixes, strict=False):
        uses = [outer.nodes.new("ShaderNodeGroup") for _ in range(2)]
        for use in uses:
            use.node_tree = inner
        outer.links.new(uses[0].outputs[0], uses[1].inputs[0])
        outer.links.new(uses[1].outputs[0], mix.inputs[2])
    material = shiny()
    use = new(material, "ShaderNodeGroup")
    use.node_tree = groups[0]
    link(material, use.outputs[0], principled_node(material).inputs["Base Color"])
    show(material)
    before = fingerprint()
    mixes[-1].inputs[0].default_value = 0.25
    assert fingerprint() != before


def test_a_chain_of_nodes_may_be_long_and_reroutes_may_feed_themselves(scene) -> None:
    material = shiny()
    first = last = new(material, "ShaderNodeGamma")
    for _ in range(400):
        node = new(material, "ShaderNodeGamma")
        link(material, last.outputs[0], node.inputs[0])
        last = node
    link(material, last.outputs[0], principled_node(material).inputs["Base Color"])
    reroutes = [new(material, "NodeReroute") for _ in range(2)]
    for source, target in zip(reroutes, reroutes[::-1], strict=True):
        link(material, source.outputs[0], target.inputs[0])
    link(material, reroutes[0].outputs[0], principled_node(material).inputs["Emission Color"])
    show(material)
    before = fingerprint()
    first.inputs["Gamma"].default_value = 2.0
    assert fingerprint() != before
