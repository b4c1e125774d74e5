"""What goes wrong in a bake: it is told in words, and what was there before stays."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake.capture import Stage
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.store import pictures
from pcc_addon.core.errors import BakeError
from sample_blends.scenes import principled_node
from tests.blender.helpers import bake, contents, paint_wall, picture, save, small_probe, small_room


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

    def fail_on_second(path: Path, image: np.ndarray, *, half: bool) -> None:
        calls.append(path)
        if len(calls) == 2:
            raise BakeError("the disk is full")
        write(path, image, half=half)

    monkeypatch.setattr(pictures, "write_file", fail_on_second)
    [result] = bake(probe)
    assert result.error == "probe 'Probe': the disk is full" and len(calls) == 2
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


def test_a_render_result_of_another_name_is_found(scene) -> None:
    probe = small_room()
    bake(probe)
    bpy.data.images["Render Result"].name = "Mine"
    [result] = bake(probe)
    assert result.error is None


def test_a_view_layer_that_is_not_for_rendering_is_baked_too(scene) -> None:
    probe = small_room()
    bpy.context.view_layer.use = False  # as the only one: Blender renders nothing then
    [result] = bake(probe)
    assert result.error is None and picture(probe).max() > 0.9
    assert not bpy.context.view_layer.use


def test_a_damaged_record_is_mended_by_baking_again(scene) -> None:
    probe = small_room()
    bake(probe)
    probe.pcc_probe.bake_record = "{"
    [result] = bake(probe)
    assert result.error is None and probe.pcc_probe.bake_record.startswith("{\n")


def test_a_capture_point_inside_a_cupboard_is_told_with_its_name_and_a_better_place(scene) -> None:
    probe = small_room()
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=probe.location)
    bpy.context.object.name = "Cupboard"
    [result] = bake(probe)
    assert result.error is None
    [warning] = result.warnings
    assert "nearly black" in warning and "'Cupboard'" in warning and "capture offset of (" in warning
    probe.pcc_probe.capture_offset = [float(c) for c in re.search(r"\((.*?)\)", warning)[1].split(",")]
    [result] = bake(probe)
    assert result.warnings == ()


def test_a_lit_room_has_no_warning(scene) -> None:
    [result] = bake(small_room())
    assert result.warnings == ()
