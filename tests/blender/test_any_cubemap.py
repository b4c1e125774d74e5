"""Pictures from files and from the world: read, stretched, found stale, refused; nothing of the scene in them."""

from __future__ import annotations

import re
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Euler

from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.status import statuses
from pcc_addon.blender.store import pictures
from pcc_addon.blender.store.image_files import read_linear
from pcc_addon.core import equirect
from pcc_addon.core.layouts import Layout
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.probe import Source
from tests.blender.helpers import bake, picture, put_in, save, small_probe, small_room
from tests.core.test_layouts import FACES, SKETCHES, colour, face, sheet, to_engine


def write_png(path: Path, values: np.ndarray, depth: str) -> Path:
    """A PNG of encoded values 0 … 1 (h, w, 3), row 0 at the bottom."""
    image = bpy.data.images.new("written", values.shape[1], values.shape[0], float_buffer=True, is_data=True)
    pixels = np.ones((*values.shape[:2], 4), np.float32)
    pixels[..., :3] = values
    image.pixels.foreach_set(pixels.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", depth
    image.save_render(str(path), scene=bpy.context.scene)
    bpy.data.images.remove(image)
    return path


def shows(probe: bpy.types.Object, path: Path) -> None:
    probe.pcc_probe.source, probe.pcc_probe.picture = "IMAGE", str(path)


def sky(folder: Path, height: int = 64) -> Path:
    """An equirectangular EXR with a mark for each direction."""
    path = folder / "sky.exr"
    pictures.write_file(path, colour(to_engine(equirect.directions(2 * height, height))))
    return path


def state() -> tuple[str, str]:
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    return status.state, status.why


def errors_of(probe: bpy.types.Object) -> str:
    [result] = bake(probe)
    assert result.error is not None
    return result.error


def check_marks(probe: bpy.types.Object, tolerance: float) -> None:
    d = FACES + 0.3 * np.roll(FACES, 1, 1) + 0.6 * np.roll(FACES, 2, 1)
    np.testing.assert_allclose(equirect.lookup(picture(probe), d), colour(to_engine(d)), atol=tolerance)


@pytest.mark.parametrize("layout", list(SKETCHES), ids=lambda layout: layout.words)
def test_a_sheet_of_faces_is_the_probes_picture(scene, tmp_path: Path, layout: Layout) -> None:
    probe = small_probe()
    pictures.write_file(tmp_path / "sheet.exr", sheet(layout, 16))
    shows(probe, tmp_path / "sheet.exr")
    assert bake(probe)[0].error is None
    assert picture(probe).shape == (32, 64, 3)
    check_marks(probe, 0.03)


def test_six_files_are_one_picture_whichever_is_chosen(scene, tmp_path: Path) -> None:
    probe = small_probe()
    for name in ("px", "nx", "py", "ny", "pz", "nz"):
        pictures.write_file(tmp_path / f"room_{name}.exr", face(name, 16)[::-1])
    shows(probe, tmp_path / "room_ny.exr")
    assert bake(probe)[0].error is None
    check_marks(probe, 0.03)


def test_an_equirectangular_file_is_kept_as_it_is_and_blurred(scene, tmp_path: Path, renders) -> None:
    probe = small_probe()
    shows(probe, sky(tmp_path, 32))
    [result] = bake(probe)
    assert (result.error, result.warnings, result.replaced_pixels, renders) == (None, (), (), [])
    np.testing.assert_array_equal(picture(probe), read_linear(tmp_path / "sky.exr"))
    assert [level.roughness for level in probe.pcc_probe.levels] == pytest.approx(LADDER)
    assert np.ptp(picture(probe, LADDER[-1])) < np.ptp(picture(probe))
    record = bake_record(probe)
    assert record.source is Source.IMAGE
    assert record.capture_point == tuple(probe_spec(probe).box.centre)


@pytest.mark.parametrize("depth", ["8", "16"])
def test_encoded_files_become_light(scene, tmp_path: Path, depth: str) -> None:
    values = np.full((4, 8, 3), (0.25, 0.5, 0.75), np.float32)
    light = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    path = write_png(tmp_path / "sky.png", values, depth)
    np.testing.assert_allclose(read_linear(path), light, atol=4e-3 if depth == "8" else 1e-4)


def test_pixels_that_no_picture_should_hold_are_replaced_and_told(scene, tmp_path: Path) -> None:
    probe = small_probe()
    values = np.full((32, 64, 3), 0.5, np.float32)
    values[3, 4] = -1.0
    pictures.write_file(tmp_path / "sky.exr", values)
    shows(probe, tmp_path / "sky.exr")
    [result] = bake(probe)
    assert result.replaced_pixels == ("picture 'sky.exr': 1 negative pixels were replaced",)
    assert picture(probe)[3, 4].tolist() == [0.0] * 3


def test_a_black_picture_is_told_and_not_blamed_on_the_capture_point(scene, tmp_path: Path) -> None:
    probe = small_probe()
    pictures.write_file(tmp_path / "night.exr", np.zeros((32, 64, 3), np.float32))
    shows(probe, tmp_path / "night.exr")
    [warning] = bake(probe)[0].warnings
    assert "nearly black" in warning and "capture point" not in warning


def chosen(folder: Path, kind: str) -> Path | None:
    """A picture that cannot be used."""
    path = folder / f"{kind}.exr"
    if kind == "odd":
        pictures.write_file(path, np.zeros((10, 33, 3), np.float32))
    elif kind == "square_px":
        pictures.write_file(path, np.zeros((16, 16, 3), np.float32))
        pictures.write_file(folder / "square_nx.exr", np.zeros((16, 16, 3), np.float32))
    elif kind == "torn":
        path.write_bytes(sky(folder).read_bytes()[:200])
    elif kind == "text":
        path.write_text("no picture")
    elif kind == "none":
        return None
    return path


@pytest.mark.parametrize(("kind", "message"), [
    ("odd", "picture 'odd.exr': 33×10 pixels is no layout of a cubemap; accepted are equirectangular 2:1, .*six"),
    ("square_px", "picture 'square_px.exr': 16×16 pixels is one of six faces; beside it there is no square_py.exr, "),
    ("torn", "torn.exr' cannot be read: it is damaged.* give one"),
    ("text", "text.exr' cannot be read: it is damaged.* give one"),
    ("missing", "missing.exr' does not exist; choose another"),
    ("none", "none is chosen; choose a picture"),
])  # fmt: skip
def test_a_picture_that_cannot_be_used_is_refused_and_the_bake_before_stays(
    scene, tmp_path: Path, kind: str, message: str
) -> None:
    probe = small_probe()
    shows(probe, sky(tmp_path))
    assert bake(probe)[0].error is None
    before, record = picture(probe), probe.pcc_probe.bake_record
    probe.pcc_probe.picture = str(chosen(tmp_path, kind) or "")
    images = len(bpy.data.images)
    error = errors_of(probe)
    assert error.startswith("probe 'Probe'") and re.search(message, error) and "\n" not in error
    np.testing.assert_array_equal(picture(probe), before)
    assert probe.pcc_probe.bake_record == record and len(bpy.data.images) == images
    probe_group.refresh_group(probe)
    assert state()[0] == ("error" if kind in ("missing", "none") else "stale")


def test_six_faces_of_several_sizes_are_refused_by_name(scene, tmp_path: Path) -> None:
    probe = small_probe()
    for name in ("px", "nx", "py", "ny", "pz", "nz"):
        pictures.write_file(tmp_path / f"{name}.exr", np.zeros((16, 17 if name == "py" else 16, 3), np.float32))
    shows(probe, tmp_path / "nz.exr")
    assert "picture 'py.exr': 17×16 pixels is no square" in errors_of(probe)


def test_an_image_is_stale_when_its_file_is_another_and_never_for_the_scene(scene, tmp_path: Path) -> None:
    probe = small_room()
    shows(probe, sky(tmp_path))
    assert state() == ("unbaked", "it has no bake")
    bake(probe)
    assert state()[0] == "baked"
    bpy.data.objects["Wall +X"].location.x += 1.0
    probe.location.x += 0.5
    probe.rotation_euler.z = 0.5
    probe.pcc_probe.samples, probe.pcc_probe.capture_offset.x = 7, 0.25
    moved = (tmp_path / "sky.exr").rename(tmp_path / "renamed.exr")
    probe.pcc_probe.picture = str(moved)
    assert state()[0] == "baked", "nothing that the picture depends on"
    sky(tmp_path).replace(moved)
    assert state()[0] == "baked", "written anew, with the same content"
    pictures.write_file(moved, np.full((32, 64, 3), 0.5, np.float32))
    assert state() == ("stale", "its image or the probe changed since its bake")
    bake(probe)
    assert state()[0] == "baked"
    probe.pcc_probe.resolution = 32
    assert state()[0] == "stale"
    bake(probe)
    probe.pcc_probe.source = "BAKE"
    assert state()[0] == "stale"


def test_any_of_six_files_that_changes_makes_it_stale(scene, tmp_path: Path) -> None:
    probe = small_probe()
    for name in ("px", "nx", "py", "ny", "pz", "nz"):
        pictures.write_file(tmp_path / f"{name}.exr", face(name, 16)[::-1])
    shows(probe, tmp_path / "px.exr")
    bake(probe)
    assert state()[0] == "baked"
    pictures.write_file(tmp_path / "nz.exr", face("px", 16))
    assert state()[0] == "stale"


def marked_world() -> None:
    """A world with a mark for each direction, and a lamp and a room that are none of it."""
    world = bpy.context.scene.world or bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    geometry, add = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    add.operation, add.inputs[1].default_value, add.inputs[2].default_value = "MULTIPLY_ADD", (0.5,) * 3, (0.5,) * 3
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(geometry.outputs["Generated"], add.inputs[0])
    tree.links.new(add.outputs[0], background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])


def world_of(d: np.ndarray) -> np.ndarray:
    return d / np.linalg.norm(d, axis=-1, keepdims=True) * 0.5 + 0.5


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def test_the_world_alone_is_taken_along_the_boxs_axes(scene, engine: str) -> None:
    probe = small_room()
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = probe.location
    bpy.context.scene.collection.objects.link(lamp)
    marked_world()
    probe.rotation_euler = Euler((0.3, -0.4, 1.1))
    probe.pcc_probe.source, probe.pcc_probe.engine = "WORLD", engine
    probe.pcc_probe.capture_offset.x = 0.5
    bpy.context.view_layer.update()
    scenes = len(bpy.data.scenes)
    [result] = bake(probe)
    assert (result.error, result.replaced_pixels) == (None, ())
    assert len(bpy.data.scenes) == scenes
    d = FACES + 0.3 * np.roll(FACES, 1, 1) + 0.6 * np.roll(FACES, 2, 1)
    towards = d @ np.array(probe.matrix_world.to_3x3().normalized()).T
    turned = d @ np.array(Euler((0.3, -0.4, 1.1)).to_matrix()).T
    np.testing.assert_allclose(towards / np.linalg.norm(towards), turned / np.linalg.norm(turned), atol=1e-5)
    np.testing.assert_allclose(equirect.lookup(picture(probe), d), world_of(turned), atol=0.03)
    assert bake_record(probe).source is Source.WORLD


def test_a_world_is_stale_when_it_or_the_boxs_axes_change_and_never_for_the_scene(scene) -> None:
    probe = small_room()
    marked_world()
    probe.pcc_probe.source = "WORLD"
    bake(probe)
    assert state()[0] == "baked"
    bpy.data.objects["Wall +X"].location.x += 1.0
    probe.location.x += 0.5
    probe.scale *= 1.5
    probe.scale.x *= 1.5
    assert state()[0] == "baked"
    probe.rotation_euler.z = 0.5
    assert state() == ("stale", "the world or the probe changed since its bake")
    probe.rotation_euler.z = 0.0
    assert state()[0] == "baked"
    nodes = bpy.context.scene.world.node_tree.nodes
    next(n for n in nodes if n.bl_idname == "ShaderNodeBackground").inputs["Strength"].default_value = 2.0
    assert state()[0] == "stale"


def test_a_scene_without_a_world_says_so(scene) -> None:
    probe = small_probe()
    probe.pcc_probe.source = "WORLD"
    bpy.context.scene.world = None
    assert "has none; add one" in errors_of(probe)


def test_baked_probes_beside_it_are_rendered_as_ever(scene, tmp_path: Path, renders) -> None:
    """One bake job for all sources; the room's picture holds neither the image nor the world's stage."""
    room = small_room()
    bake(room)
    alone = picture(room)
    other = small_probe("Sky")
    shows(other, sky(tmp_path))
    renders.clear()
    results = bake(other, room)
    assert [(r.probe, r.error) for r in results] == [("Probe", None), ("Sky", None)]
    assert renders == ["Probe"] * 6
    np.testing.assert_array_equal(picture(room), alone)


def test_the_materials_show_it_stretched_and_the_plan_says_so(scene, tmp_path: Path) -> None:
    probe = small_room()
    shows(probe, sky(tmp_path))
    bake(probe)
    put_in()
    assert "stretched" in probe_group.shown_effects(probe.pcc_probe.group)
    probe.pcc_probe.source = "BAKE"
    put_in()
    assert "stretched" in probe_group.shown_effects(probe.pcc_probe.group), "its pictures are still the image's"
    bake(probe)
    assert "stretched" not in probe_group.shown_effects(probe.pcc_probe.group)


def test_the_operator_keeps_the_path_relative_and_refuses_what_is_no_set(scene, tmp_path: Path) -> None:
    probe = small_probe()
    save(tmp_path / "room.blend")
    bpy.context.view_layer.objects.active = probe
    names = [f"{name}.exr" for name in ("px", "nx", "py", "ny", "pz", "nz")]
    for name in [*names, "sky.exr"]:
        pictures.write_file(tmp_path / name, np.full((16, 16, 3), 0.5, np.float32))
    one = bpy.ops.pcc.picture_choose(filepath=str(tmp_path / "sky.exr"))
    assert (one, probe.pcc_probe.source, probe.pcc_probe.picture) == ({"FINISHED"}, "IMAGE", "//sky.exr")
    six = [{"name": name} for name in names]
    assert bpy.ops.pcc.picture_choose(directory=str(tmp_path), files=six) == {"FINISHED"}
    assert probe.pcc_probe.picture == "//px.exr"
    with pytest.raises(RuntimeError, match="the 6 chosen files are not six faces of one picture"):
        bpy.ops.pcc.picture_choose(directory=str(tmp_path), files=[*six[:5], {"name": "sky.exr"}])
    with pytest.raises(RuntimeError, match="does not exist"):
        bpy.ops.pcc.picture_choose(filepath=str(tmp_path / "gone.exr"))
    assert probe.pcc_probe.picture == "//px.exr"
    assert bake(probe)[0].error is None


def test_a_file_that_is_saved_elsewhere_still_finds_its_picture(scene, tmp_path: Path) -> None:
    probe = small_probe()
    save(tmp_path / "room.blend")
    shows(probe, sky(tmp_path))
    probe.pcc_probe.picture = "//sky.exr"
    save(tmp_path / "other.blend")
    assert probe.pcc_probe.picture == "//sky.exr", "the same folder"
    (tmp_path / "elsewhere").mkdir()
    save(tmp_path / "elsewhere" / "room.blend")
    assert bake(probe)[0].error is None
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "elsewhere" / "room.blend"))
    assert bake(bpy.data.objects["Probe"])[0].error is None


def test_the_operator_wants_a_probe(scene) -> None:
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.pcc.picture_choose.poll()
