"""Every fault is one line that names the thing and the remedy; nothing is damaged. Disks and files: `tests/faults`."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.cli import run_in_blender
from sample_blends.scenes import empty_scene

FAST = ["--resolution", "16", "--samples", "1"]


@pytest.fixture
def blend(tmp_path: Path) -> Path:
    """A saved file with one probe; afterwards no file is open."""
    empty_scene()
    bpy.ops.pcc.probe_add(name="Hall", location=(1, 2, 3), half_extents=(2, 2, 2))
    path = tmp_path / "hall.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def run(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, list[str]]:
    """Exit code and the lines on standard error that are ours."""
    capfd.readouterr()
    code = run_in_blender([str(a) for a in arguments])
    return code, [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]


@pytest.mark.parametrize(
    ("arguments", "code", "named"),
    [
        (["bake", "nowhere.blend"], 1, "nowhere.blend"),
        (["bake"], 2, "FILE.blend"),
        (["polish", "x.blend"], 2, "polish"),
        (["bake", "x.blend", "--samples", "many"], 2, "many"),
    ],
)
def test_wrong_words_are_told_in_one_line(
    capfd: pytest.CaptureFixture[str], arguments: list[str], code: int, named: str
) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    found, lines = run(capfd, *arguments)
    assert found == code
    assert len(lines) == 1 and named in lines[0]


def test_a_file_that_is_no_blend_is_named(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "letter.blend"
    path.write_text("Dear Sir")
    code, lines = run(capfd, "bake", path)
    assert code == 1 and len(lines) == 1 and "letter.blend" in lines[0]
    assert path.read_text() == "Dear Sir"


@pytest.mark.parametrize("samples", ["2147483648", "99999999999999999999", "0", "-1"])
def test_samples_beyond_all_bounds_are_told_in_one_line(
    capfd: pytest.CaptureFixture[str], blend: Path, samples: str
) -> None:
    code, lines = run(capfd, "bake", blend, f"--samples={samples}")
    assert code == 1 and len(lines) == 1 and f"--samples {samples}" in lines[0]


@pytest.mark.parametrize(
    ("frames", "remedy"),
    [("5-1", "ask for 1-5"), ("12", "such as 1-250"), ("1-9:0", "at least 1"), ("1-9999999", "stay within")],
)
def test_bad_frames_are_told_with_what_to_write(
    capfd: pytest.CaptureFixture[str], blend: Path, frames: str, remedy: str
) -> None:
    before = blend.read_bytes()
    code, lines = run(capfd, "bake", blend, f"--frames={frames}", "--save")
    assert code == 1 and len(lines) == 1 and "--frames" in lines[0] and frames in lines[0] and remedy in lines[0]
    assert blend.read_bytes() == before and not blend.with_suffix(".pcc").exists()


@pytest.mark.parametrize("option", [[], ["--output"]])
def test_a_name_longer_than_the_system_allows_is_told_in_one_line(
    capfd: pytest.CaptureFixture[str], blend: Path, option: list[str]
) -> None:
    long = blend.parent / f"{'x' * 300}.blend"
    code, lines = run(capfd, "bake", *([blend, *option, long] if option else [long]))
    assert code == 1 and len(lines) == 1 and "xxx" in lines[0]


def test_a_file_that_comes_out_torn_leaves_the_one_before(
    capfd: pytest.CaptureFixture[str], blend: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a full disk, where Blender reports success."""
    from pcc_addon.blender import saving

    load = bpy.data.libraries.load

    def torn(path: str) -> object:
        Path(path).write_bytes(Path(path).read_bytes()[:-2000])
        return load(path)

    class Data:
        class libraries:
            load = staticmethod(torn)

    class Torn:
        ops, context, data = bpy.ops, bpy.context, Data

    monkeypatch.setattr(saving, "bpy", Torn)
    before = blend.read_bytes()
    code, lines = run(capfd, "remove", blend, "--save")
    assert code == 1 and len(lines) == 1 and "cannot be saved" in lines[0]
    assert blend.read_bytes() == before
    assert [p.name for p in blend.parent.iterdir() if "unfinished" in p.name] == []


def test_nothing_is_saved_where_nothing_was_baked(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    for probe in [o for o in bpy.data.objects if o.pcc_probe.is_probe]:
        probe.scale.x = 0.0
    bpy.ops.wm.save_mainfile()
    before = blend.read_bytes()
    code, _ = run(capfd, "bake", blend, "--save")
    assert code == 1 and blend.read_bytes() == before


def test_a_scene_without_probes_says_how_to_add_one(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    empty_scene()
    path = tmp_path / "bare.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    for sub in ("bake", "inject", "status"):
        code, lines = run(capfd, sub, path)
        assert code == 1 and len(lines) == 1 and "add one" in lines[0]


def test_an_unknown_probe_is_answered_with_the_known_ones(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    code, lines = run(capfd, "bake", blend, "--probe", "Attic")
    assert code == 1 and len(lines) == 1
    assert "'Attic'" in lines[0] and "'Hall'" in lines[0]


def test_a_probe_without_size_fails_and_the_others_are_baked(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.ops.pcc.probe_add(name="Flat", half_extents=(1, 1, 1))
    bpy.data.objects["Flat"].scale.z = 0.0
    bpy.ops.wm.save_mainfile()
    code, lines = run(capfd, "bake", blend, *FAST, "--save")
    assert code == 1 and len(lines) == 1 and "'Flat'" in lines[0] and "zero size along Z" in lines[0]
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert bpy.data.objects["Hall"].pcc_probe.bake_record


def test_settings_out_of_range_are_told_before_anything_is_done(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    for option, value in (("--resolution", "3"), ("--samples", "0")):
        code, lines = run(capfd, "bake", blend, option, value)
        assert code == 1 and len(lines) == 1 and option in lines[0]


def test_a_missing_texture_is_named_and_the_bake_goes_on(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.ops.mesh.primitive_plane_add(size=3, location=(1, 2, 2))
    material = bpy.data.materials.new("Paper")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("flowers", 4, 4)
    node.image.source, node.image.filepath = "FILE", "//flowers.png"
    bpy.context.object.data.materials.append(material)
    bpy.ops.wm.save_mainfile()
    code, lines = run(capfd, "bake", blend, *FAST, "--save")
    assert code == 1 and len(lines) == 1 and "'flowers'" in lines[0] and "relink" in lines[0]
    code, lines = run(capfd, "bake", blend, *FAST, "--allow-missing-textures")
    assert code == 0
    assert list(blend.with_suffix(".pcc").glob("*.exr"))
