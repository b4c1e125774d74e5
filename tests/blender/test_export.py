"""Exports from a file: what is written, what is refused, by the operator and the shell."""

from __future__ import annotations

import json
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.export import ExportJob
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.store.image_files import read_linear
from pcc_addon.blender.store.pictures import read_file
from pcc_addon.cli import run_in_blender
from pcc_addon.core import equirect, layouts
from pcc_addon.core.errors import PccError
from pcc_addon.core.export import cubemaps, document
from pcc_addon.core.export.targets import TARGETS, target_of
from tests.blender.helpers import bake, picture, small_probe, small_room


def texels(path: Path, width: int) -> np.ndarray:
    """(6, n, n, 3): the sharpest level of a DDS file."""
    faces = np.frombuffer(path.read_bytes(), "<f2", offset=128).reshape(6, -1, 4)
    return faces[:, : width * width, :3].reshape(6, width, width, 3).astype(np.float32)


def listing(to: Path) -> dict:
    return json.loads((to / document.NAME).read_text(encoding="utf-8"))


def export(to: Path, key: str = "generic", **options: object) -> list:
    job = ExportJob(
        bpy.context.scene, bpy.context.view_layer, [bpy.data.objects["Probe"]], target_of(key), to, **options
    )
    job.finish()
    return job.results


@pytest.fixture
def baked(scene) -> bpy.types.Object:
    probe = small_room()
    assert bake(probe)[0].error is None
    return probe


def test_all_kinds_of_files_show_what_was_baked(baked, tmp_path: Path) -> None:
    [result] = export(tmp_path)
    assert result.error is None
    [found] = listing(tmp_path)["probes"]
    assert {*result.files, document.NAME} == {path.name for path in tmp_path.iterdir()}
    capture, files = picture(baked), found["pictures"]
    np.testing.assert_array_equal(read_file(tmp_path / files["exr"]), capture)
    np.testing.assert_allclose(read_linear(tmp_path / files["hdr"]), capture, atol=capture.max() / 100.0)
    faces = [read_file(tmp_path / name) for name in files["faces"]]
    again = layouts.from_faces(layouts.six_faces(faces, files["faces"]), 16)
    assert np.abs(again - capture).mean() < 0.03 < 0.1 < np.abs(again[:, ::-1] - capture).mean()
    np.testing.assert_allclose(texels(tmp_path / files["dds"], 16), [face[::-1] for face in faces], atol=1e-3)
    assert found["captured_faces"] == ["+X", "-X", "+Y", "-Y", "+Z", "-Z"] or any("guessed" in n for n in result.notes)


@pytest.mark.parametrize("target", TARGETS, ids=lambda t: t.key)
def test_every_engine_gets_its_files(baked, tmp_path: Path, target) -> None:
    [result] = export(tmp_path, target.key)
    assert result.error is None
    found = listing(tmp_path)
    written = {path.name for path in tmp_path.iterdir()}
    assert found["target"] == target.key and set(found["files"]) == written - {document.NAME}
    texts = [path for path in tmp_path.iterdir() if path.suffix in {".glsl", ".hlsl", ".ush", ".gdshader", ".shader"}]
    for path in (*texts, *tmp_path.glob("*.gdshaderinc")):
        assert "PROBE" not in path.name and "PROBE" not in path.read_text(encoding="utf-8")
    assert found["probes"][0]["shader"] in written


def test_the_same_bake_gives_the_same_files(baked, tmp_path: Path) -> None:
    export(tmp_path, "three")
    before = listing(tmp_path)
    export(tmp_path, "three")
    assert listing(tmp_path) == before
    export(tmp_path, "babylon")
    assert not list(tmp_path.glob("*.ktx2")) and list(tmp_path.glob("*.dds"))


def test_a_picture_that_is_stretched_to_the_box_is_one_along_the_world_s_axes(scene, tmp_path: Path) -> None:
    """Seen from the middle of the box, each wall has the colour of the side of the cubemap that is stretched to it."""
    colors = equirect.directions(64, 32) + 2.0
    image = bpy.data.images.new("Sky", 64, 32, float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.dstack([colors, np.ones((32, 64))]).astype(np.float32).ravel())
    image.file_format, image.filepath_raw = "OPEN_EXR", str(tmp_path / "sky.exr")
    image.save()
    probe = small_probe(half_extents=(2.0, 1.0, 0.5), rotation=(0.2, -0.4, 0.9))
    probe.pcc_probe.source, probe.pcc_probe.picture = "IMAGE", str(tmp_path / "sky.exr")
    assert bake(probe)[0].error is None
    [result] = export(tmp_path / "out", width=64)
    assert result.error is None
    box = probe_spec(probe).box
    [found] = listing(tmp_path / "out")["probes"]
    assert np.allclose(found["capture_point"], box.centre, atol=1e-6)
    level = texels(tmp_path / "out" / found["pictures"]["dds"], 64)
    rng = np.random.default_rng(0)
    on_cube = rng.uniform(-1.0, 1.0, (200, 3))
    on_cube[np.arange(200), rng.integers(0, 3, 200)] = 1.0
    towards = on_cube @ box.axes.T
    target = target_of("generic")
    seen = cubemaps.sample(level, towards @ target.axes.matrix.T @ target.sampled.matrix.T) - 2.0
    expected = on_cube / np.linalg.norm(on_cube, axis=1, keepdims=True)
    assert np.median(np.abs(seen - expected).max(-1)) < 0.08 and np.abs(seen - expected).max() < 0.35


def test_what_cannot_be_exported_says_why(scene, tmp_path: Path) -> None:
    probe = small_room()
    [result] = export(tmp_path / "out")
    assert result.error == "probe 'Probe' has no bake; bake it first"
    assert not list((tmp_path / "out").iterdir())
    bake(probe)
    with pytest.raises(PccError, match="face width 100 is no power of two between 16 and 4096; choose 128"):
        export(tmp_path, width=100)
    bpy.data.images.remove(probe.pcc_probe.levels[0].image)
    [result] = export(tmp_path / "out")
    assert "missing" in result.error and "bake it again" in result.error


def test_a_full_disk_leaves_the_folder_as_it_was(baked, tmp_path: Path, monkeypatch) -> None:
    export(tmp_path, "babylon")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(PccError, match=r"cannot write into .* \(No space left on device\); free space"):
        export(tmp_path, "godot")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_operator_exports(baked, tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="No folder is chosen"):
        bpy.ops.pcc.export()
    assert bpy.ops.pcc.export(directory=str(tmp_path), target="godot", width="32") == {"FINISHED"}
    assert listing(tmp_path)["probes"][0]["face_width"] == 32
    baked.select_set(False)
    bpy.context.view_layer.objects.active = None
    with pytest.raises(RuntimeError, match="No parallax probe is selected"):
        bpy.ops.pcc.export(directory=str(tmp_path), selected=True)


def test_the_shell_exports(baked, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    blend, to = tmp_path / "room.blend", tmp_path / "out"
    small_probe("Unbaked", (50.0, 0.0, 0.0))
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    before = blend.read_bytes()
    capfd.readouterr()
    assert run_in_blender(["export", str(blend), "--to", str(to), "--target", "three", "--json"]) == 1
    events = [json.loads(line) for line in capfd.readouterr().out.splitlines()]
    assert [e["error"] for e in events if e["event"] == "error"] == ["probe 'Unbaked' has no bake; bake it first"]
    assert [e["probes"] for e in events if e["event"] == "exported"] == [["Probe"]]
    assert run_in_blender(["export", str(blend), "--to", str(to), "--target", "three", "--probe", "Probe"]) == 0
    assert f"wrote 1 probe for three.js into {to}" in capfd.readouterr().out
    assert run_in_blender(["export", str(blend), "--to", str(blend), "--target", "three"]) == 1
    assert "is a file; name a folder" in capfd.readouterr().err
    assert run_in_blender(["export", str(blend), "--target", "three"]) == 2
    assert blend.read_bytes() == before
