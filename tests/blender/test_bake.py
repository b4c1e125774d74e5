"""Baking: where pictures go, what makes them stale, what goes wrong, and what they show."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import pictures
from pcc_addon.blender.capture import Stage
from pcc_addon.blender.probes import bake_record
from pcc_addon.core import equirect
from pcc_addon.core.errors import BakeError
from sample_blends.scenes import empty_scene, principled, principled_node
from tests.blender.helpers import ROOM, bake, glow, picture, small_probe, small_room


def save(path: Path) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, by relative path."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def pictures_of(probe: bpy.types.Object) -> list[Path]:
    return [Path(bpy.path.abspath(level.image.filepath)).resolve() for level in probe.pcc_probe.levels]


def run(scope: str, *, expected: str = "FINISHED") -> None:
    assert bpy.ops.pcc.bake(scope=scope) == {expected}


def times_of(probes: list[bpy.types.Object]) -> list[str]:
    """Something that every bake changes."""
    return [probe.pcc_probe.bake_record for probe in probes]


@pytest.fixture
def renders(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The probe names of the faces that were rendered."""
    seen: list[str] = []
    face = Stage.face

    def counted(self: Stage, spec: object, index: int) -> np.ndarray:
        seen.append(spec.name)
        return face(self, spec, index)

    monkeypatch.setattr(Stage, "face", counted)
    return seen


# Where pictures go


def test_a_bake_of_an_unsaved_file_is_packed_into_it(scene, tmp_path: Path) -> None:
    probe = small_room()
    [result] = bake(probe)
    assert result.error is None and result.files == ()
    assert [level.image.packed_file is not None for level in probe.pcc_probe.levels] == [True]
    before = picture(probe).copy()
    save(tmp_path / "packed.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "packed.blend"))
    assert np.array_equal(picture(bpy.data.objects["Probe"]), before) and before.max() > 0.9
    assert list(contents(tmp_path)) == ["packed.blend"]


def test_baking_a_packed_probe_again_leaves_one_picture_of_the_same_name(scene) -> None:
    probe = small_room()
    bake(probe)
    names = sorted(image.name for image in bpy.data.images)
    bake(probe)
    assert sorted(image.name for image in bpy.data.images) == names


def test_a_bake_of_a_saved_file_lies_beside_it(scene, tmp_path: Path) -> None:
    probe = small_room()
    save(tmp_path / "room.blend")
    [result] = bake(probe)
    assert [Path(f).parent.name for f in result.files] == ["room.pcc"]
    assert pictures_of(probe)[0].suffix == ".exr"
    assert not probe.pcc_probe.levels[0].image.packed_file
    assert probe.pcc_probe.levels[0].image.filepath.startswith("//")
    [sidecar] = (tmp_path / "room.pcc").glob("*.json")
    described = json.loads(sidecar.read_text(encoding="utf-8"))
    assert described["probe"] == "Probe" and described["content_hash"] == bake_record(probe).content_hash
    assert described["capture_point"] == pytest.approx(ROOM.centre)
    assert np.allclose(np.reshape(described["matrix"], (4, 4)), probe.matrix_world)
    [level] = described["levels"]
    assert np.array_equal(pictures.read_file(sidecar.parent / level["file"]), picture(probe))
    assert (level["width"], level["height"], level["roughness"]) == (64, 32, 0.0)
    assert sorted(p.suffix for p in (tmp_path / "room.pcc").iterdir()) == [".exr", ".json"]


def test_a_blurred_level_has_its_own_file(scene, tmp_path: Path) -> None:
    probe = small_room()
    principled_node(bpy.data.materials["Floor"]).inputs["Roughness"].default_value = 0.5
    save(tmp_path / "room.blend")
    bake(probe)
    assert [round(level.roughness, 4) for level in probe.pcc_probe.levels] == [0.0, 0.5]
    assert len(set(pictures_of(probe))) == 2 and all(path.is_file() for path in pictures_of(probe))
    assert picture(probe, 0.5).std() < picture(probe).std()


@pytest.mark.parametrize("name", ["a/b\\c:d*e?", "Büro 二階 🏠", "../../escape", ".", "   ", "CON", "x" * 63])
def test_any_probe_name_makes_a_safe_file_name(scene, tmp_path: Path, name) -> None:
    small_room()
    probe = bpy.data.objects["Probe"]
    probe.name = name
    (tmp_path / "inner").mkdir()
    save(tmp_path / "inner" / "room.blend")
    [result] = bake(probe)
    assert result.error is None
    assert pictures_of(probe)[0].is_file() and pictures_of(probe)[0].parent == tmp_path / "inner" / "room.pcc"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["inner"]
    assert all(c.isascii() and (c.isalnum() or c in "-_.") for p in pictures_of(probe) for c in p.name)


def test_names_that_look_alike_as_file_names_do_not_share_files(scene, tmp_path: Path) -> None:
    small_room()
    probes = [small_probe(name) for name in ("a/b", "a\\b", "a b")]
    save(tmp_path / "room.blend")
    bake(*probes)
    assert len({path for probe in probes for path in pictures_of(probe)}) == 3


def test_two_files_in_one_folder_do_not_overwrite_each_other(scene, tmp_path: Path) -> None:
    small_room()
    save(tmp_path / "one.blend")
    bake(bpy.data.objects["Probe"])
    save(tmp_path / "one.blend")
    before = contents(tmp_path)
    save(tmp_path / "two.blend")
    bpy.data.objects["Probe"].pcc_probe.resolution = 32
    bake(bpy.data.objects["Probe"])
    after = contents(tmp_path)
    assert {name: after[name] for name in before} == before
    assert any(name.startswith("two.pcc") for name in after)


def test_two_files_with_one_chosen_folder_do_not_overwrite_each_other(scene, tmp_path: Path) -> None:
    for name in ("one", "two"):
        scene = empty_scene()
        small_room()
        scene.pcc.folder = "//shared"
        save(tmp_path / f"{name}.blend")
        bake(bpy.data.objects["Probe"])
    assert len(list((tmp_path / "shared").glob("*.json"))) == 2


def test_a_chosen_folder_is_used_and_made(scene, tmp_path: Path) -> None:
    probe = small_room()
    scene.pcc.folder = str(tmp_path / "deep" / "folder")
    [result] = bake(probe)
    assert [Path(f).parent for f in result.files] == [tmp_path / "deep" / "folder"]


def test_a_new_probe_with_the_old_name_of_a_renamed_one_gets_its_own_files(scene, tmp_path: Path) -> None:
    first = small_room()
    save(tmp_path / "room.blend")
    bake(first)
    before = contents(tmp_path / "room.pcc")
    first.name = "Renamed"
    second = small_probe("Probe", half_extents=(1.0, 1.0, 0.5))
    bake(second)
    after = contents(tmp_path / "room.pcc")
    assert {name: after[name] for name in before} == before and len(after) == 2 * len(before)
    bake(first)
    assert not set(pictures_of(first)) & set(pictures_of(second))


@pytest.mark.parametrize("new_name", ["Probe", "Aula", "Zed"])
def test_baking_a_copy_leaves_the_originals_bake_alone(scene, tmp_path: Path, new_name) -> None:
    original = small_room()
    save(tmp_path / "room.blend")
    bake(original)
    before, record = contents(tmp_path / "room.pcc"), original.pcc_probe.bake_record
    shown, group = picture(original).copy(), original.pcc_probe.group
    copy = original.copy()
    scene.collection.objects.link(copy)
    copy.location.x += 0.75
    bpy.context.view_layer.update()
    original.name = new_name
    bake(copy)
    after = contents(tmp_path / "room.pcc")
    assert {name: after[name] for name in before} == before
    assert original.pcc_probe.bake_record == record and original.pcc_probe.group == group
    assert np.array_equal(picture(original), shown)
    assert copy.pcc_probe.group != group and copy.pcc_probe.uid != original.pcc_probe.uid
    assert copy.pcc_probe.levels[0].image != original.pcc_probe.levels[0].image


def test_baking_a_copy_in_an_unsaved_file_leaves_the_originals_picture_alone(scene) -> None:
    original = small_room()
    bake(original)
    shown = picture(original).copy()
    copy = original.copy()
    scene.collection.objects.link(copy)
    copy.location.x += 0.75
    bpy.context.view_layer.update()
    bake(copy)
    assert np.array_equal(picture(original), shown)
    assert copy.pcc_probe.levels[0].image != original.pcc_probe.levels[0].image


# What is baked


def move_wall() -> None:
    bpy.data.objects["Wall +X"].location.x += 0.1


def brighten_lamp() -> None:
    bpy.data.lights["Lamp"].energy += 1.0


def paint_wall() -> None:
    principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Color"].default_value = (0.5, 0.5, 0.5, 1.0)


def move_vertex() -> None:
    bpy.data.meshes["Wall +X"].vertices[0].co.x += 0.1


def move_probe() -> None:
    bpy.data.objects["Probe"].location.x += 0.1


def change_resolution() -> None:
    bpy.data.objects["Probe"].pcc_probe.resolution = 32


def change_offset() -> None:
    bpy.data.objects["Probe"].pcc_probe.capture_offset.x = 0.5


def delete_file() -> None:
    pictures_of(bpy.data.objects["Probe"])[0].unlink()


def hide_wall() -> None:
    bpy.data.objects["Wall +X"].hide_render = True


def hide_from_capture() -> None:
    bpy.data.objects["Probe"].pcc_probe.hidden_objects.add().object = bpy.data.objects["Wall +X"]


def new_object() -> None:
    mesh = bpy.data.meshes.new("New")
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("New", mesh))


def brighten_world() -> None:
    nodes = bpy.context.scene.world.node_tree.nodes
    next(n for n in nodes if n.bl_idname == "ShaderNodeBackground").inputs["Strength"].default_value = 1.0


CHANGES = [
    move_wall, brighten_lamp, paint_wall, move_vertex, move_probe, change_resolution, change_offset, delete_file,
    hide_wall, hide_from_capture, new_object, brighten_world,
]  # fmt: skip


def widen_box() -> None:
    bpy.data.objects["Probe"].scale *= 1.5


def change_falloff() -> None:
    bpy.data.objects["Probe"].pcc_probe.falloff = 1.0


def inject() -> None:
    assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"}


def inject_and_remove() -> None:
    inject()
    assert bpy.ops.pcc.remove(scope="SCENE") == {"FINISHED"}


def select_all() -> None:
    for item in bpy.context.scene.objects:
        item.select_set(True)


def move_camera() -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def reopen() -> None:
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)


def add_output_for_each_engine() -> None:
    tree = bpy.data.materials["Floor"].node_tree
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    output.target = "CYCLES"
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    other.target = "EEVEE"
    tree.links.new(principled_node(bpy.data.materials["Floor"]).outputs[0], other.inputs["Surface"])
    run("STALE")
    inject()


NOT_CHANGES = [
    widen_box, change_falloff, inject, inject_and_remove, select_all, move_camera, reopen, add_output_for_each_engine,
]  # fmt: skip


def lit_room(folder: Path) -> None:
    """A saved file with a room, a lamp and a baked probe."""
    small_room()
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = ROOM.world(0.5, 0.5, 0.5)
    bpy.context.scene.collection.objects.link(lamp)
    save(folder / "room.blend")
    run("STALE")


@pytest.mark.parametrize("change", CHANGES, ids=lambda f: f.__name__)
def test_a_stale_bake_is_baked_again_once(scene, tmp_path: Path, renders, change) -> None:
    lit_room(tmp_path)
    assert renders == ["Probe"] * 6
    run("STALE")
    assert len(renders) == 6, "nothing had changed"
    change()
    run("STALE")
    assert len(renders) == 12, "the change was not seen"
    run("STALE")
    assert len(renders) == 12, "the second bake does not hold"


@pytest.mark.parametrize("change", NOT_CHANGES, ids=lambda f: f.__name__)
def test_what_does_not_change_the_picture_does_not_make_it_stale(scene, tmp_path: Path, renders, change) -> None:
    lit_room(tmp_path)
    change()
    before = len(renders)
    run("STALE")
    assert len(renders) == before if change is not add_output_for_each_engine else len(renders) <= 12


def test_each_scope_bakes_its_probes(scene, renders) -> None:
    small_room()
    second = small_probe("Second", half_extents=(1.0, 1.0, 0.5))
    run("ALL")
    assert set(renders) == {"Probe", "Second"}
    renders.clear()
    second.location.x += 0.1
    run("STALE")
    assert set(renders) == {"Second"}
    renders.clear()
    for item in bpy.context.view_layer.objects:
        item.select_set(item.name == "Probe")
    run("SELECTED")
    assert set(renders) == {"Probe"}
    renders.clear()
    run("ALL")
    assert set(renders) == {"Probe", "Second"}


def test_baking_a_scene_without_probes_is_refused_with_what_to_do(scene) -> None:
    with pytest.raises(RuntimeError, match="add one"):
        bpy.ops.pcc.bake()


# What goes wrong


def flatten_by_parent(probe: bpy.types.Object) -> None:
    parent = bpy.data.objects.new("Flat", None)
    bpy.context.scene.collection.objects.link(parent)
    probe.parent, parent.scale = parent, (1.0, 1.0, 0.0)
    probe.rotation_euler = (0.5, 0.4, 0.3)


FAULTS: dict[str, tuple[Callable[[bpy.types.Object], None], str]] = {
    "zero scale": (lambda p: setattr(p, "scale", (1.0, 0.0, 1.0)), "zero size along Y.*scale"),
    "NaN location": (lambda p: setattr(p, "location", (math.nan, 0.0, 0.0)), "not finite.*reset"),
    "infinite scale": (lambda p: setattr(p, "scale", (math.inf, 1.0, 1.0)), "not finite.*reset"),
    "flattened by its parent": (flatten_by_parent, "flatten.*remove"),
    "clip planes crossed": (lambda p: setattr(p.pcc_probe, "clip_start", 2000.0), "clip start.*below"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_probe_is_told_in_one_line_and_the_others_are_baked(scene, fault) -> None:
    good = small_room()
    bad = small_probe("Faulty One")
    break_it, words = FAULTS[fault]
    break_it(bad)
    results = {result.probe: result.error for result in bake(good, bad)}
    assert results["Probe"] is None and good.pcc_probe.bake_record
    assert "Faulty One" in results["Faulty One"] and "\n" not in results["Faulty One"]
    assert re.search(words, results["Faulty One"])
    assert not bad.pcc_probe.bake_record
    with pytest.raises(RuntimeError, match=r"Faulty One"):
        bpy.ops.pcc.bake(scope="ALL")


def test_an_old_bake_survives_a_failing_new_one_byte_for_byte(scene, tmp_path: Path, monkeypatch) -> None:
    probe = small_room()
    principled_node(bpy.data.materials["Floor"]).inputs["Roughness"].default_value = 0.5
    save(tmp_path / "room.blend")
    bake(probe)
    before, record = contents(tmp_path), probe.pcc_probe.bake_record
    shown = picture(probe).copy()
    paint_wall()
    write, calls = pictures.write_file, []

    def fail_on_second(path: Path, image: np.ndarray) -> None:
        calls.append(path)
        if len(calls) == 2:
            raise BakeError("the disk is full")
        write(path, image)

    monkeypatch.setattr(pictures, "write_file", fail_on_second)
    [result] = bake(probe)
    assert result.error == "the disk is full" and len(calls) == 2
    assert contents(tmp_path) == before and probe.pcc_probe.bake_record == record
    monkeypatch.undo()
    probe.pcc_probe.levels[0].image.reload()
    assert np.array_equal(picture(probe), shown)


def test_a_folder_that_cannot_be_written_is_told_before_anything_is_rendered(scene, tmp_path: Path, renders) -> None:
    small_room()
    (tmp_path / "file").write_text("in the way")
    scene.pcc.folder = str(tmp_path / "file")
    with pytest.raises(RuntimeError, match=r"cannot write into '.*file'.*choose another folder"):
        bpy.ops.pcc.bake(scope="ALL")
    assert renders == []


def test_pixels_that_no_picture_should_hold_are_counted_and_replaced(scene, monkeypatch) -> None:
    probe = small_room()
    material = bpy.data.materials["Glow +X"]
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Strength"].default_value = -3.0
    links.new(emission.outputs[0], output.inputs["Surface"])
    bpy.data.materials["Glow -X"].node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 1e6
    face = Stage.face

    def spoilt(self: Stage, spec: object, index: int) -> np.ndarray:  # Cycles' film never holds these itself
        rendered = face(self, spec, index)
        if index == 2:
            rendered[10, 12], rendered[11, 12] = math.nan, math.inf
        return rendered

    monkeypatch.setattr(Stage, "face", spoilt)
    [result] = bake(probe)
    assert result.error is None
    text = "\n".join(result.replaced_pixels)
    for words in (r"face \+X: .*negative", r"face -X: .*too bright", r"face \+Y: 2 not finite"):
        assert re.search(words, text), text
    assert bake_record(probe).replaced_pixels == result.replaced_pixels
    image = picture(probe)
    assert np.isfinite(image).all() and image.min() >= 0.0 and image.max() == 65504.0


# What the pictures show


def towards(probe: bpy.types.Object, *direction: float) -> np.ndarray:
    return equirect.lookup(picture(probe), np.array(direction))


def test_a_hidden_object_and_a_hidden_collection_are_not_captured(scene) -> None:
    probe = small_room()
    collection = bpy.data.collections.new("Hidden")
    scene.collection.children.link(collection)
    collection.objects.link(bpy.data.objects["Wall +Y"])
    bake(probe)
    before = picture(probe).copy()
    probe.pcc_probe.hidden_objects.add().object = bpy.data.objects["Wall +X"]
    probe.pcc_probe.hidden_collection = collection
    bake(probe)
    for direction, wall in (((1, 0, 0), 0), ((0, 1, 0), 2)):
        assert equirect.lookup(before, np.array(direction, float))[wall] == pytest.approx(1.0, abs=0.02)
        assert towards(probe, *direction).max() == pytest.approx(0.0, abs=0.02)
    assert towards(probe, -1, 0, 0).max() == pytest.approx(1.0, abs=0.02)
    assert not bpy.data.objects["Wall +X"].hide_render and not bpy.data.objects["Wall +Y"].hide_render


@pytest.mark.parametrize("visible_glossy", [True, False])
def test_lamps_are_captured_as_reflections_see_them(scene, visible_glossy) -> None:
    probe = small_probe()
    light = bpy.data.lights.new("Lamp", "AREA")
    light.size, light.energy = 2.0, 40.0
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.location = ROOM.world(1.0, 0.0, 0.0)
    lamp.rotation_euler = (0.0, math.radians(90.0), 0.0)  # shines along −X, at the probe
    lamp.visible_camera, lamp.visible_glossy = False, visible_glossy
    scene.collection.objects.link(lamp)
    bake(probe)
    radiance = 40.0 / (math.pi * 4.0)
    assert towards(probe, 1, 0, 0) == pytest.approx([radiance if visible_glossy else 0.0] * 3, rel=0.02, abs=1e-3)
    assert towards(probe, -1, 0, 0).max() == pytest.approx(0.0, abs=1e-3)
    assert not lamp.visible_camera


@pytest.mark.parametrize("injected", [False, True])
def test_receivers_are_captured_without_their_reflections(scene, injected) -> None:
    probe = small_room()
    bpy.data.objects["Wall -Z"].data.materials[0] = principled(
        "Mirror", Base_Color=(1, 1, 1, 1), Metallic=1.0, Roughness=0.0
    )
    if injected:
        bake(probe)
        inject()
    bake(probe)
    assert towards(probe, 0, 0, -1).max() == pytest.approx(0.0, abs=1e-3), "a mirror has no diffuse light"
    assert towards(probe, 0, 0, 1).max() == pytest.approx(1.0, abs=0.02)


def test_a_mirror_out_of_the_probes_reach_is_captured_with_its_reflections(scene) -> None:
    probe = small_room()
    bpy.data.objects["Wall -Z"].data.materials[0] = principled(
        "Mirror", Base_Color=(1, 1, 1, 1), Metallic=1.0, Roughness=0.0
    )
    probe.scale = (0.3, 0.3, 0.3)
    bpy.context.view_layer.update()
    bake(probe)
    assert towards(probe, 0, 0, -1).max() > 0.5


def test_walls_are_captured_with_their_own_radiance(scene) -> None:
    probe = small_room()
    bpy.data.materials["Glow +X"].node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 1234.5
    bake(probe)
    assert towards(probe, 1, 0, 0) == pytest.approx((1234.5, 0.0, 0.0), rel=1e-4, abs=1e-3)


def test_what_lies_beyond_the_clip_planes_is_not_captured(scene) -> None:
    probe = small_probe()
    mesh = bpy.data.meshes.new("Near")
    mesh.from_pydata([(0.5, -2, -2), (0.5, 2, -2), (0.5, 2, 2), (0.5, -2, 2)], [], [(0, 1, 2, 3)])
    mesh.materials.append(glow("Near", (1.0, 1.0, 1.0)))
    near = bpy.data.objects.new("Near", mesh)
    near.location = ROOM.centre
    scene.collection.objects.link(near)
    bake(probe)
    assert towards(probe, 1, 0, 0) == pytest.approx((1.0, 1.0, 1.0), abs=0.02)
    probe.pcc_probe.clip_start = 0.75
    bake(probe)
    assert towards(probe, 1, 0, 0).max() == 0.0
