"""Probes in shaders made by hand: what their groups compute, how they are added, what bakes make of them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender import marks
from pcc_addon.blender.read.materials import read_material
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.shade import by_hand, injection
from pcc_addon.blender.shade.probe_group import known_values
from pcc_addon.blender.status import stale_probes
from pcc_addon.blender.store.levels import ensure_levels, store
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import by_hand as formula
from pcc_addon.core.errors import PccError
from pcc_addon.core.lookup_plan import Receivers, lookup_effects
from pcc_addon.core.pictures import LADDER
from pcc_addon.ui import menus
from sample_blends.scenes import add_wall, emissive
from tests.blender.helpers import ROOM, bake, paint_wall, picture, pretend_bake, put_in, small_probe, small_room
from tests.blender.places import check_places, drawn
from tests.core.boxes import directions
from tests.shader_harness import evaluate_group

UP = (0.0, 0.0, 1.0)  # what the harness's quads have for normals, and from where it looks at them


def add(probe: bpy.types.Object, material: bpy.types.Material) -> bpy.types.Node:
    """Add a probe's node to a material as a script does."""
    wall = next(o for o in bpy.context.scene.objects if o.active_material == material)
    with bpy.context.temp_override(object=wall):
        assert bpy.ops.pcc.node_add(probe=probe.name) == {"FINISHED"}
    return material.node_tree.nodes.active


@pytest.fixture
def wall(scene) -> bpy.types.Material:
    """A wall's material that only emits."""
    material, _ = emissive("By Hand")
    add_wall(ROOM, "+X", material)
    return material


def let_emit(node: bpy.types.Node) -> None:
    tree = node.id_data
    emission = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    tree.links.new(node.outputs["Radiance"], emission.inputs["Color"])


def gradient(probe: bpy.types.Object) -> None:
    """Pictures of all levels, each another; at the poles, where nobody knows the azimuth, it does not count."""
    record = bake_record(probe)
    v, u = np.mgrid[0:16, 0:32].astype(np.float32)
    across, around = np.sin(v * np.pi / 15.0), u * np.pi / 16.0
    base = np.stack([1.0 + across * np.cos(around), v / 8.0, 1.0 + across * np.sin(around)], -1)
    store(probe, record, {r: (base * (1.0 + 0.5 * k)).astype(np.float32) for k, r in enumerate(LADDER)}, None)


def quads(count: int) -> np.ndarray:
    """(n, 3): where the harness's cases lie."""
    width = max(int(np.ceil(np.sqrt(count))), 4)
    k = np.arange(count)
    return np.stack([k % width + 0.5, k // width + 0.5, np.zeros(count)], -1)


ALL_SETTINGS = {"weight": 0.5, "normal_fade": 0.4, "influence_low": (0.2, 0.0, 0.1), "contact_hardening": True}


@pytest.mark.parametrize(
    ("correction", "settings"), [("BOX", {}), ("NONE", {}), ("BOX", ALL_SETTINGS), ("NONE", {"weight": 0.5})]
)
def test_a_group_computes_the_formula(scene, correction: str, settings: dict) -> None:
    """Around a turned box, in and outside its influence, with the direction given and not."""
    count = 60
    probe = small_probe(rotation=(0.3, 0.2, 0.5), capture_offset=(0.3, -0.2, 0.1))
    for name, value in {"correction": correction, "falloff": 0.5, **settings}.items():
        setattr(probe.pcc_probe, name, value)
    pretend_bake(probe)
    gradient(probe)
    tree = by_hand.group_for(probe)
    rng = np.random.default_rng(7)
    position = ROOM.centre + rng.uniform(-1.3, 1.3, (count, 3)) * ROOM.half_extents
    inputs = {
        "Direction": directions(count, rng) * (np.arange(count) % 3 != 0)[:, None] * 2.0,
        "Roughness": rng.uniform(0.0, 0.7, count),
        "Offset": position - quads(count),
    }
    found = evaluate_group(tree, inputs)
    spec, record = probe_spec(probe), bake_record(probe)
    box, effects = spec.box, lookup_effects(spec, Receivers(), record.capture_point)
    values = {
        "Position": quads(count),
        "Incoming": np.broadcast_to(UP, (count, 3)),
        "Normal": np.broadcast_to(UP, (count, 3)),
        "Shown": 1.0,
        **known_values(spec, record, effects.correction),
        "Box Centre": box.centre,
        "Half Widths": box.half_widths,
        **{f"Face Normal {axis}": box.face_normals[k] for k, axis in enumerate("XYZ")},
    }
    heights = {f"Level {k}": 16 for k in range(len(LADDER))}
    pictures = {f"Level {k}": picture(probe, r) for k, r in enumerate(LADDER)}
    expected = evaluate(
        formula.by_hand(effects, heights, LADDER).outputs,
        {name: np.asarray(value, np.float32) for name, value in (inputs | values).items()},
        np.float32,
        pictures,
    )
    if correction == "BOX":
        assert np.min(expected["Weight"]) == 0.0
    assert np.max(expected["Weight"]) == settings.get("weight", 1.0)
    for name, tolerance in (("Radiance", 2e-3), ("Weight", 1e-4)):
        shape = found[name].shape
        np.testing.assert_allclose(found[name], np.broadcast_to(expected[name], shape), atol=tolerance)
    inside = (np.abs(box.coordinates(position)) < box.half_widths - 0.01).all(-1)
    ray = np.where(inputs["Direction"].any(-1, keepdims=True), 0.5 * inputs["Direction"], UP)
    ends = box.coordinates(position + ray * found["Distance"][:, None])[inside]
    np.testing.assert_allclose(np.abs(ends / box.half_widths).max(-1), 1.0, atol=1e-3)


def test_every_socket_is_documented(probe) -> None:
    for tree in (by_hand.group_for(probe), by_hand.mirrored_view_group()):
        items = {(item.in_out, item.name): item for item in tree.interface.items_tree}
        assert all(item.description for item in items.values())
    tree = by_hand.group_for(probe)
    outputs = [item.name for item in tree.interface.items_tree if item.in_out == "OUTPUT"]
    assert outputs == ["Radiance", "Weight", "Distance"] and tree.name == "PCC Probe"


def test_nodes_of_groups_have_room(probe) -> None:
    for tree in (by_hand.group_for(probe), by_hand.mirrored_view_group()):
        check_places(drawn(tree))
    view = by_hand.mirrored_view_group()
    geometry = view.nodes["Geometry"]
    first = min(node.location.x for node in drawn(view) if node != geometry)
    assert 0.0 < first - (geometry.location.x + geometry.width) < 100.0


def test_the_mirrored_view_mirrors_in_what_is_linked(scene) -> None:
    normals = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 3.0), (0.0, 1.0, 1.0), (-0.5, 0.0, 1.0)])
    found = evaluate_group(by_hand.mirrored_view_group(), {"Normal": normals})["Direction"]
    half = np.where(normals.any(-1, keepdims=True), normals, UP)
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    np.testing.assert_allclose(found, 2.0 * half[:, 2:] * half - UP, atol=1e-4)  # the mesh packs its normals


def test_a_script_adds_a_node_to_the_active_material(probe, wall) -> None:
    node = add(probe, wall)
    assert node.node_tree == by_hand.group_for(probe) and marks.role(node) is None
    assert {socket.name for socket in node.inputs} == {"Direction", "Roughness", "Offset"}, "all levels are there"
    again = add(probe, wall)
    assert again != node and again.node_tree == node.node_tree


@pytest.fixture
def editor(scene) -> Iterator[bpy.types.SpaceNodeEditor]:
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    before = area.ui_type
    with bpy.context.temp_override(window=window, area=area):
        area.ui_type = "ShaderNodeTree"
        yield area.spaces.active
        area.ui_type = before


def test_the_shader_editor_gets_a_node_at_its_cursor(probe, wall, editor) -> None:
    editor.pin, editor.node_tree = True, wall.node_tree
    editor.cursor_location = (120.0, -40.0)
    assert bpy.ops.pcc.node_add(probe="Probe") == {"FINISHED"}
    assert wall.node_tree.nodes.active.location[:] == (120.0, -40.0)
    assert bpy.ops.pcc.mirrored_view_add() == {"FINISHED"}
    assert wall.node_tree.nodes.active.node_tree == by_hand.mirrored_view_group()


def test_other_editors_and_our_own_groups_get_none(probe, wall, editor) -> None:
    editor.pin, editor.node_tree = True, probe.pcc_probe.group
    with pytest.raises(RuntimeError, match="is a group of Parallax Probes"):
        bpy.ops.pcc.node_add(probe="Probe")
    bpy.context.area.ui_type = "GeometryNodeTree"
    with pytest.raises(RuntimeError, match="in the Shader Editor"):
        bpy.ops.pcc.node_add(probe="Probe")


def test_an_unbaked_probe_is_refused_by_name(wall) -> None:
    probe = small_probe()
    with pytest.raises(RuntimeError, match="'Probe' has no bake"):
        add(probe, wall)
    assert not bpy.data.node_groups


def test_a_missing_picture_is_an_error_that_leaves_no_group(probe, wall) -> None:
    bpy.data.images.remove(probe.pcc_probe.levels[0].image)
    before = set(bpy.data.node_groups)
    with pytest.raises(PccError, match="'Probe'"):
        by_hand.group_for(probe)
    assert set(bpy.data.node_groups) == before


class _Layout:
    """Stands in for a menu's layout; remembers what was drawn."""

    def __init__(self) -> None:
        self.drawn: list[tuple[str, object]] = []

    def operator(self, name: str, **options: object) -> _Layout:
        self.drawn.append((name, options.get("text")))
        return self

    def label(self, **options: object) -> None:
        self.drawn.append(("label", options["text"]))

    def menu(self, name: str, **_: object) -> None:
        self.drawn.append((name, None))

    def separator(self) -> None:
        pass


def test_the_menu_lists_baked_probes_under_a_heading(probe) -> None:
    small_probe("Unbaked")
    menu = type("Menu", (), {"layout": _Layout()})()
    menus.PCC_MT_node_add.draw(menu, bpy.context)
    assert menu.layout.drawn == [("pcc.node_add", "Probe"), ("pcc.mirrored_view_add", None)]
    assert menu.layout.probe == "Probe"
    assert menus.draw_nodes in bpy.types.NODE_MT_shader_node_add_all.draw._draw_funcs
    assert bpy.types.PCC_MT_node_add.bl_label == "Parallax Probes"


def test_removing_probes_leaves_what_users_placed(scene) -> None:
    probe = small_room()
    bake(probe)
    floor = bpy.data.materials["Floor"]
    node = add(probe, floor)
    put_in()
    injection.remove()
    assert node.name in floor.node_tree.nodes and node.node_tree in list(bpy.data.node_groups)
    floor.node_tree.nodes.remove(node)
    injection.remove()
    assert not [t for t in bpy.data.node_groups if marks.role(t) == marks.BY_HAND], "nothing uses it any more"


def test_samplers_of_what_users_placed_count(probe, wall) -> None:
    assert read_material(wall).textures == 0
    add(probe, wall)
    assert read_material(wall).textures == len(LADDER)


def test_a_new_bake_shows_in_place_and_no_bake_sees_the_last(scene) -> None:
    """The wall shows the probe, at twice its light: fed back, it would grow with each bake."""
    probe = small_room()
    bake(probe)
    material, emission = emissive("By Hand")
    next(o for o in scene.objects if o.active_material.name == "Glow -X").active_material = material
    emission.inputs["Strength"].default_value = 2.0
    node = add(probe, material)
    let_emit(node)
    tree, links = node.node_tree, len(material.node_tree.links)
    stranger = small_probe("Stranger", Vector(ROOM.centre) + Vector((0.2, 0.0, 0.0)))
    for x in (0.25, 0.5):
        paint_wall()
        probe.pcc_probe.capture_offset.x = x
        bake(probe, stranger)
        assert node.node_tree == tree and len(material.node_tree.links) == links
        assert images(tree) == {level.image for level in probe.pcc_probe.levels}
        assert tree.nodes["Shown"].outputs[0].default_value == 1.0
        [found] = [n for n in tree.nodes if n.bl_idname == "ShaderNodeGroup" and n.label == "Lookup"]
        assert found.inputs["Capture Point"].default_value[0] == ROOM.centre[0] + x
        for each in (probe, stranger):
            seen = picture(each)
            middle = seen[seen.shape[0] // 2, 0]  # −X
            assert np.abs(middle).max() < 1e-3, f"'{each.name}' sees what the wall shows"
            assert seen.max() > 0.9
    probe.pcc_probe.falloff = 0.75
    assert found.inputs["Falloff"].default_value == 0.75
    assert stale_probes(scene, bpy.context.view_layer, [probe, stranger]) == [], "what is black changes no picture"


def images(tree: bpy.types.ShaderNodeTree) -> set[bpy.types.Image]:
    return {node.image for node in tree.nodes if node.bl_idname == "ShaderNodeTexEnvironment"}


def test_a_group_that_is_built_anew_within_a_bake_stays_black(probe, wall) -> None:
    tree = add(probe, wall).node_tree
    with ExitStack() as stack:
        by_hand.hide(stack)
        tree.nodes.remove(tree.nodes["Level 0"])
        by_hand.refresh(probe)
        assert "Level 0" in tree.nodes and tree.nodes["Shown"].outputs[0].default_value == 0.0
    assert tree.nodes["Shown"].outputs[0].default_value == 1.0


def test_the_box_is_followed(probe, wall) -> None:
    """By drivers where it only moves, by another lookup where it is turned."""
    tree = add(probe, wall).node_tree
    probe.location.x += 1.0
    probe.rotation_euler = (0.1, 0.2, 0.3)
    bpy.context.view_layer.update()
    lookups = [n.node_tree.name for n in tree.nodes if n.bl_idname == "ShaderNodeGroup" and n.label == "Lookup"]
    assert len(lookups) == 1 and "oriented box" in lookups[0]


def test_a_copied_probe_has_a_group_of_its_own(probe, wall) -> None:
    ensure_levels(probe, LADDER, None)
    first = by_hand.group_for(probe)
    copy = probe.copy()
    bpy.context.scene.collection.objects.link(copy)
    assert by_hand.group_for(copy) != first and by_hand.group_for(probe) == first


def test_what_was_deleted_inside_is_built_again_on_opening(probe, wall, tmp_path) -> None:
    add(probe, wall)
    path = str(tmp_path / "by hand.blend")
    [inner] = [t for t in bpy.data.node_groups if t.name.startswith("PCC Distance")]
    bpy.data.node_groups.remove(inner)
    assert not by_hand.is_current(probe)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert by_hand.is_current(bpy.data.objects["Probe"])
