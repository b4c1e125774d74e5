"""Window materials: how they are made, that they outlive the add-on and the file, that they follow bakes."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.marks import WINDOW
from pcc_addon.blender.shade.injection import inject
from pcc_addon.blender.shade.interior import SOCKETS, interior_node, room_of_probe
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.interior import Cells, Interior, RoomPicture, pane
from pcc_addon.core.effects.interior import interior as formula
from tests.blender.helpers import bake, paint_wall, pretend_bake, small_probe, small_room
from tests.blender.places import check_places, drawn
from tests.core.boxes import directions
from tests.shader_harness import evaluate_expressions


def window(**options: object) -> bpy.types.Material:
    """The material of a new pane with the probe's room behind it."""
    bpy.ops.object.select_all(action="DESELECT")
    assert bpy.ops.pcc.interior_add(**{"probes": "Probe", **options}) == {"FINISHED"}
    return bpy.context.object.active_material


def pane_of(name: str, *corners: tuple[float, float, float]) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [tuple(range(len(corners)))])
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    return item


def save_picture(path: Path, pixels: np.ndarray) -> Path:
    """An 8-bit PNG of (h, w, 4)."""
    image = bpy.data.images.new("file", pixels.shape[1], pixels.shape[0], alpha=True)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


def from_pictures(*paths: Path, **options: object) -> set[str]:
    files = [{"name": path.name} for path in paths]
    return bpy.ops.pcc.interior_add_pictures(directory=str(paths[0].parent), files=files, **options)


def images(material: bpy.types.Material) -> dict[str, bpy.types.Image]:
    tree = interior_node(material).node_tree
    return {node.name: node.image for node in tree.nodes if hasattr(node, "image")}


def test_a_new_pane_is_as_large_as_the_room_and_stands_at_the_cursor(probe) -> None:
    bpy.context.scene.cursor.location = (1.0, 2.0, 3.0)
    material = window(name="Shop")
    item = bpy.context.object
    assert material.name == "Shop" and item.location[:] == (1.0, 2.0, 3.0)
    assert np.allclose(item.dimensions, (4.0, 0.0, 2.0)), "half extents of the probe: 2, 1.5, 1"
    inputs = interior_node(material).inputs
    assert [inputs[n].default_value for n in ("Width", "Depth", "Height")] == [4.0, 3.0, 2.0]
    assert images(material) == {"Room 0": probe.pcc_probe.levels[0].image}


def test_every_socket_is_documented_and_starts_as_it_says(probe) -> None:
    tree = interior_node(window()).node_tree
    items = {item.name: item for item in tree.interface.items_tree}
    assert all(item.description for item in items.values())
    for socket in SOCKETS:
        if socket.name in items:
            found = items[socket.name].default_value
            value = tuple(found) if hasattr(found, "__len__") else found
            assert np.allclose(value, socket.default)
    assert {item.name for item in items.values() if item.in_out == "OUTPUT"} == {"Radiance", "Cell", "Random", "Is Lit"}
    assert "Curtains" not in items and "Middle" not in items, "there are no such pictures"


def test_sockets_have_limits_that_their_values_keep(probe) -> None:
    tree = interior_node(window()).node_tree
    items = {item.name: item for item in tree.interface.items_tree if item.in_out == "INPUT"}
    for socket in SOCKETS:
        assert socket.low < socket.high
        assert socket.name.startswith("Tint") or all(
            socket.low <= value <= socket.high for value in np.ravel(socket.default)
        )
        if socket.name in items and not socket.name.startswith("Tint"):
            item = items[socket.name]
            np.testing.assert_allclose((item.min_value, item.max_value), (socket.low, socket.high))
            assert item.socket_type != "NodeSocketFloat" or item.subtype == socket.subtype


def test_every_input_that_a_pane_does_not_have_by_itself_is_a_socket(scene) -> None:
    asked = {name for cells in Cells for name in formula(Interior((RoomPicture(),), cells, True, True)).inputs}
    own = {"Position", "UV", "Incoming", "Normal", "Object Scale", "Object Random"}
    assert asked - own == {socket.name for socket in SOCKETS}


def test_nodes_of_a_pane_have_room(probe) -> None:
    check_places(drawn(interior_node(window()).node_tree))


def test_selected_panes_get_the_material_and_lose_nothing(probe) -> None:
    upright = pane_of("Upright", (0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))
    flat = pane_of("Flat", (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    bpy.context.view_layer.objects.active = upright
    old = bpy.data.materials.new("Old")
    upright.active_material = old
    bpy.ops.pcc.interior_add(probes="Probe")
    assert upright.active_material == flat.active_material and interior_node(flat.active_material)
    assert old.use_fake_user, "it stays in the file"


def test_planes_that_were_made_lying_have_their_own_y_above(probe) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    flat = pane_of("Flat", (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    bpy.ops.pcc.interior_add(probes="Probe")
    assert interior_node(flat.active_material).inputs["Up"].default_value[:] == (0.0, 1.0, 0.0)


def test_selected_probes_are_the_rooms_to_choose_from(probe) -> None:
    second = small_probe("Second", (20.0, 0.0, 0.0))
    pretend_bake(second)
    bpy.ops.object.select_all(action="DESELECT")
    for item in (probe, second):
        item.select_set(True)
    assert bpy.ops.pcc.interior_add() == {"FINISHED"}
    shown = images(bpy.context.object.active_material)
    assert set(shown.values()) == {item.pcc_probe.levels[0].image for item in (probe, second)}


@pytest.mark.parametrize(
    ("options", "why"), [({}, "no probe is selected"), ({"probes": "Cellar"}, "no probe is called")]
)
def test_without_rooms_nothing_is_made(probe, options: dict, why: str) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match=why):
        bpy.ops.pcc.interior_add(**options)
    assert not bpy.data.materials


def test_an_unbaked_probe_is_refused_by_name(scene) -> None:
    small_probe()
    with pytest.raises(RuntimeError, match="'Probe' has no bake"):
        bpy.ops.pcc.interior_add(probes="Probe")


def test_a_new_bake_shows_at_once(scene) -> None:
    probe = small_room()
    bake(probe)
    material = window()
    inputs = interior_node(material).inputs
    inputs["Turns"].default_value, inputs["Width"].default_value = 0.5, 3.0
    paint_wall()
    probe.scale, probe.pcc_probe.capture_offset = (2.5, 1.5, 1.0), (0.25, 0.0, 0.0)
    bake(probe)
    tree = interior_node(material).node_tree
    assert images(material)["Room 0"] == probe.pcc_probe.levels[0].image
    expected = room_of_probe(probe).picture
    assert np.isclose(np.linalg.norm(expected.half_edges[0]), 2.5)
    constants = [tuple(s.default_value) for n in tree.nodes for s in n.inputs if s.type == "VECTOR" and not s.is_linked]
    assert any(np.allclose(c, expected.half_edges[0]) for c in constants)
    assert any(np.allclose(c, expected.capture) for c in constants)
    inputs = interior_node(material).inputs
    assert (inputs["Turns"].default_value, inputs["Width"].default_value) == (0.5, 3.0), "the user's numbers stay"
    glass = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    assert glass.inputs["Emission Color"].links[0].from_node == interior_node(material)


@pytest.mark.parametrize("link", [False, True])
def test_a_window_goes_into_another_file(probe, tmp_path: Path, link: bool) -> None:
    material = window()
    interior_node(material).inputs["Seed"].default_value = 5.0
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "room.blend"), link=link) as (_, wanted):
        wanted.materials = ["Window"]
    material = bpy.data.materials["Window"]
    node = interior_node(material)
    assert marks.role(node.node_tree) == WINDOW and node.inputs["Seed"].default_value == 5.0
    image = images(material)["Room 0"]
    assert image.size[:] == (64, 32) and len(image.pixels) == 64 * 32 * 4
    assert not bpy.data.objects, "no probe is needed"


def test_the_pane_shows_a_probe_like_any_other_surface(probe) -> None:
    material = window()
    bpy.context.object.matrix_world.translation = (3.0, -2.0, 1.0)
    bpy.context.view_layer.update()
    assert ("Window", "Probe") in inject(bpy.context.scene, bpy.context.view_layer).materials
    twins = [n for n in material.node_tree.nodes if marks.role(n) and n.bl_idname == "ShaderNodeBsdfPrincipled"]
    assert any(n.inputs["Emission Color"].is_linked for n in twins)


def test_pictures_are_rooms_too(scene, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    paths = [save_picture(tmp_path / f"room{k}.png", rng.random((16, 32, 4))) for k in range(2)]
    layer = save_picture(tmp_path / "sofa.png", rng.random((8, 8, 4)))
    assert from_pictures(*paths, curtains=str(layer), width=3.0) == {"FINISHED"}
    material = bpy.context.object.active_material
    assert {Path(i.filepath).name for i in images(material).values()} == {"room0.png", "room1.png", "sofa.png"}
    assert interior_node(material).inputs["Width"].default_value == 3.0
    assert "Curtains" in interior_node(material).inputs and "Middle" not in interior_node(material).inputs


def test_a_room_map_becomes_a_room_and_its_layers(scene, tmp_path: Path) -> None:
    pixels = np.zeros((48, 48, 4))
    pixels[16:32, 16:32] = (1.0, 0.0, 0.0, 1.0)
    pixels[:16, :16] = (0.0, 1.0, 0.0, 0.5)
    pixels[32:, :16] = (0.0, 0.0, 1.0, 1.0)
    path = save_picture(tmp_path / "map.png", pixels)
    assert from_pictures(path, layout_of="ROOM_MAP") == {"FINISHED"}
    shown = images(bpy.context.object.active_material)
    assert all(image.packed_file for image in shown.values())
    width, height = shown["Room 0"].size
    room = np.array(shown["Room 0"].pixels).reshape(height, width, 4)
    assert np.allclose(room[height // 2, width // 2], (1.0, 0.0, 0.0, 1.0)), "the back wall is in the middle"
    assert np.allclose(np.array(shown["Middle Picture"].pixels).reshape(-1, 4), (0.0, 1.0, 0.0, 0.5), atol=0.01)
    assert np.allclose(np.array(shown["Curtain Picture"].pixels).reshape(-1, 4)[:, :3], (0.0, 0.0, 1.0))


def test_files_that_are_no_rooms_are_refused(scene, tmp_path: Path) -> None:
    square = save_picture(tmp_path / "square.png", np.ones((8, 8, 4)))
    with pytest.raises(RuntimeError, match=r"'square.png' of 8 × 8 pixels is not equirectangular"):
        from_pictures(square)
    wide = save_picture(tmp_path / "wide.png", np.ones((8, 16, 4)))
    with pytest.raises(RuntimeError, match="equirectangular"):
        from_pictures(wide, layout_of="ROOM_MAP")
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(RuntimeError, match=r"text.png' cannot be read"):
        from_pictures(tmp_path / "text.png")
    with pytest.raises(RuntimeError, match="no picture is chosen"):
        bpy.ops.pcc.interior_add_pictures(directory=str(tmp_path))
    assert not bpy.data.materials


def test_the_pane_group_computes_its_axes(scene) -> None:
    rng = np.random.default_rng(4)
    count = 2000
    axes = directions(count, rng)
    axes[::10] = np.eye(3)[rng.integers(0, 3, len(axes[::10]))] * rng.choice([-1.0, 1.0], (len(axes[::10]), 1))
    incoming = directions(count, rng)
    incoming *= np.sign((incoming * axes).sum(-1, keepdims=True))
    inputs = {
        "Position": rng.uniform(-5.0, 5.0, (count, 3)),
        "Incoming": incoming,
        "Normal": axes,
        "Up": (0.0, 0.0, 1.0),
        "Object Scale": np.exp(rng.normal(size=(count, 3))),
        "Real Size": 1.0,
    }
    values = {k: np.asarray(v, np.float32) for k, v in inputs.items()}
    found = evaluate_expressions(pane(), values)
    exact = evaluate(pane(), values, np.float64)
    np.testing.assert_array_equal(found["Wall"], exact["Wall"])
    steep = np.abs(axes[:, 2]) < 0.99  # near the vertical, across is a difference of two nearly equal numbers
    np.testing.assert_allclose(found["Ray"][steep], exact["Ray"][steep], atol=2e-4)
    np.testing.assert_allclose(found["Place"][steep], exact["Place"][steep], atol=2e-3)
    assert np.isfinite(found["Ray"]).all() and np.isfinite(found["Place"]).all()
