"""A probe's pictures in the file and on disk: stored, blurred further, checked, replaced; nothing is rendered here."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.probes import ensure_uid
from pcc_addon.blender.read.holders import Holders
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.store import keeping, pictures
from pcc_addon.blender.store.levels import bake_folder, check_folder, ensure_levels, faulty_picture, store
from pcc_addon.core.errors import BakeError
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.prefilter import prefilter
from pcc_addon.core.sidecar import Sidecar
from tests.blender.helpers import bake, picture, pictures_of, save, small_probe, small_room

RNG = np.random.default_rng(1)
SHARP = RNG.uniform(0.0, 4.0, (16, 32, 3)).astype(np.float32)


def stored(probe: bpy.types.Object, folder: Path | None, **levels: np.ndarray) -> None:
    record = Sidecar.of_bake(probe_spec(probe), ensure_uid(probe), seconds=0.0, content_hash="", blender="", addon="")
    store(probe, record, {0.0: SHARP, **{float(k[1:]) / 10: v for k, v in levels.items()}}, folder)


def record_of(probe: bpy.types.Object) -> Sidecar:
    record = bake_record(probe)
    assert record is not None
    return record


@pytest.fixture(params=["packed", "linked"])
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path | None:
    return None if request.param == "packed" else tmp_path / "deep" / "bakes"


def test_what_is_stored_is_read_back_and_described(scene, folder: Path | None) -> None:
    probe = small_probe()
    stored(probe, folder, r5=2.0 * SHARP)
    np.testing.assert_array_equal(picture(probe), SHARP)
    np.testing.assert_array_equal(picture(probe, 0.5), 2.0 * SHARP)
    record = record_of(probe)
    assert [level.roughness for level in record.levels] == [0.0, 0.5]
    assert [(level.width, level.height) for level in record.levels] == [(32, 16)] * 2
    assert [level.key.level for level in record.levels] == [0, 1]
    assert faulty_picture(probe, record) == ""
    for level in probe.pcc_probe.levels:
        assert bool(level.image.packed_file) is (folder is None)
        assert level.image.name == f"PCC Probe {level.roughness:.4f}"
    if folder is None:
        assert [level.image.packed_file.size for level in probe.pcc_probe.levels] == [x.size for x in record.levels]
    else:
        files = {*(level.file for level in record.levels), *(path.name for path in folder.glob("*.json"))}
        assert {path.name for path in folder.iterdir()} == files and len(files) == 3
        assert [path.stat().st_size for path in pictures_of(probe)] == [level.size for level in record.levels]


def test_a_picture_of_a_sequence_is_shown_as_one_and_a_still_as_a_file(scene, tmp_path: Path) -> None:
    probe = small_probe()
    stored(probe, tmp_path)
    [level] = record_of(probe).levels
    assert probe.pcc_probe.levels[0].image.source == "FILE"
    first = replace(level, key=replace(level.key, number=0), file="other_0001.exr")
    (tmp_path / first.file).write_bytes((tmp_path / level.file).read_bytes())
    [image] = keeping.linked(tmp_path, [first], keeping.own_images(probe, Holders()), probe).values()
    assert image.source == "SEQUENCE" and probe.pcc_probe.levels[0].image == image


def test_a_folder_that_another_bake_makes_at_the_same_moment_is_no_fault(tmp_path: Path, monkeypatch) -> None:
    folder = tmp_path / "shared"
    folder.mkdir()
    exists = Path.exists
    monkeypatch.setattr(Path, "exists", lambda path: path != folder and exists(path))
    with ExitStack() as stack:
        assert keeping.folder_for_parts(stack, folder).parent == folder


def test_a_picture_that_is_replaced_is_replaced_wherever_it_is_shown(scene, folder: Path | None) -> None:
    probe = small_probe()
    stored(probe, folder)
    material = bpy.data.materials.new("Shows it")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = probe.pcc_probe.levels[0].image
    record = record_of(probe)
    store(probe, record, {0.0: 3.0 * SHARP}, folder)
    assert node.image == probe.pcc_probe.levels[0].image and len(bpy.data.images) == 1
    np.testing.assert_array_equal(pictures.read_pixels(node.image), 3.0 * SHARP)
    store(probe, record, {0.0: 3.0 * SHARP}, folder)
    assert len(bpy.data.images) == 1 and bpy.data.images[0].name == "PCC Probe 0.0000"


def test_a_picture_whose_file_was_damaged_meanwhile_is_read_anew_where_it_is_shown(scene, tmp_path: Path) -> None:
    probe = small_probe()
    stored(probe, tmp_path)
    image, [path] = probe.pcc_probe.levels[0].image, pictures_of(probe)
    for damage in (path.unlink, lambda: path.write_bytes(b"torn")):
        damage()
        image.reload()
        assert tuple(image.size) == (0, 0)
        stored(probe, tmp_path)
        assert probe.pcc_probe.levels[0].image == image
        np.testing.assert_array_equal(pictures.read_pixels(image), SHARP)


def test_files_become_pictures_that_nobody_manages_the_colours_of(scene, tmp_path: Path) -> None:
    """Also where they are copies of each other, of which none was read."""
    probe = small_probe()
    stored(probe, tmp_path, r3=2.0 * SHARP, r5=3.0 * SHARP)
    images = [level.image for level in probe.pcc_probe.levels]
    assert [(image.colorspace_settings.name, image.alpha_mode) for image in images] == [("Non-Color", "NONE")] * 3
    assert len({image.filepath for image in images}) == 3 and len(bpy.data.images) == 3
    for image, times in zip(images, (1.0, 2.0, 3.0), strict=True):
        np.testing.assert_array_equal(pictures.read_pixels(image), np.float32(times) * SHARP)


def test_a_picture_that_a_copy_shows_is_its_own_once_the_original_has_others(scene, tmp_path: Path) -> None:
    probe = small_probe()
    stored(probe, tmp_path)
    copy = probe.copy()
    copy.name = "Copy"
    scene.collection.objects.link(copy)
    shared, holders, record = probe.pcc_probe.levels[0].image, Holders(), record_of(probe)
    assert holders.share(shared) and holders.share_identity(probe.pcc_probe.uid)
    assert ensure_uid(probe, holders) == record.uid != ensure_uid(copy, holders) == copy.pcc_probe.uid
    assert not holders.share_identity(record.uid)
    store(probe, record, {0.0: 2.0 * SHARP}, tmp_path, holders)
    np.testing.assert_array_equal(picture(copy), SHARP)
    assert not holders.share(shared)
    store(copy, replace(record, uid=copy.pcc_probe.uid), {0.0: 3.0 * SHARP}, tmp_path, holders)
    assert len(bpy.data.images) == 2, "the picture that both showed is gone"
    np.testing.assert_array_equal(picture(probe), 2.0 * SHARP)
    np.testing.assert_array_equal(picture(copy), 3.0 * SHARP)


def test_levels_that_are_wanted_no_more_are_removed_unless_somebody_shows_them(scene) -> None:
    probe = small_probe()
    stored(probe, None, r3=SHARP, r5=SHARP)
    kept = probe.pcc_probe.levels[2].image
    kept.use_fake_user = True
    stored(probe, None)
    assert len(probe.pcc_probe.levels) == 1
    assert {image.name for image in bpy.data.images} == {"PCC Probe 0.0000", kept.name}


def test_missing_levels_are_made_from_the_sharpest_and_the_others_stay(scene, folder: Path | None) -> None:
    probe = small_probe()
    stored(probe, folder, r5=2.0 * SHARP)
    ensure_levels(probe, [0.0, 0.5, 0.3], folder)
    assert [level.roughness for level in probe.pcc_probe.levels] == pytest.approx([0.0, 0.3, 0.5])
    np.testing.assert_array_equal(picture(probe), SHARP)
    np.testing.assert_array_equal(picture(probe, 0.5), 2.0 * SHARP)
    np.testing.assert_allclose(picture(probe, 0.3), prefilter(SHARP, 0.3), rtol=1e-6)
    before = [level.image for level in probe.pcc_probe.levels]
    ensure_levels(probe, [0.3, 0.5], folder)
    assert [level.image for level in probe.pcc_probe.levels] == before, "nothing was missing"


def test_levels_of_a_probe_without_a_bake_or_a_capture_are_refused(scene) -> None:
    probe = small_probe()
    with pytest.raises(BakeError, match="probe 'Probe' has no bake; bake it first"):
        ensure_levels(probe, [0.3], None)
    stored(probe, None)
    probe.pcc_probe.levels[0].image = None
    with pytest.raises(BakeError, match="'Probe': its capture is missing from the file; bake it again"):
        ensure_levels(probe, [0.3], None)


def test_a_renamed_probes_pictures_are_renamed(scene) -> None:
    probe = small_probe()
    stored(probe, None)
    probe.name = "Hall"
    ensure_levels(probe, [0.0], None)
    assert [level.image.name for level in probe.pcc_probe.levels] == ["PCC Hall 0.0000"]


def test_a_copys_pictures_are_its_own_from_its_first_bake_on(scene) -> None:
    probe = small_probe()
    stored(probe, None)
    copy = probe.copy()
    bpy.context.scene.collection.objects.link(copy)
    shared = probe.pcc_probe.levels[0].image
    assert copy.pcc_probe.levels[0].image == shared
    ensure_levels(copy, [0.0], None)
    assert shared.name == "PCC Probe 0.0000", "it is not the copy's to rename"
    record = replace(record_of(copy), uid="0123456789abcdef")
    store(copy, record, {0.0: 2.0 * SHARP}, None)
    assert copy.pcc_probe.levels[0].image != shared == probe.pcc_probe.levels[0].image
    np.testing.assert_array_equal(picture(probe), SHARP)


def test_a_baked_copy_takes_no_name_from_the_probe_that_it_was_copied_from(scene) -> None:
    probe = small_room()
    bake(probe)
    copies = [probe.copy() for _ in range(2)]
    for copy in copies:
        scene.collection.objects.link(copy)
    bake(probe)
    assert [level.image.name for level in probe.pcc_probe.levels] == [f"PCC Probe {rung:.4f}" for rung in LADDER]
    bake(copies[0])
    assert [level.image.name for level in copies[1].pcc_probe.levels] == [
        f"PCC Probe.002 {rung:.4f}" for rung in LADDER
    ]
    assert [level.image.name for level in copies[0].pcc_probe.levels] == [
        f"PCC Probe.001 {rung:.4f}" for rung in LADDER
    ]


def test_every_fault_of_a_picture_is_named(scene, tmp_path: Path) -> None:
    probe = small_probe()
    stored(probe, tmp_path, r5=SHARP)
    record = record_of(probe)
    [sharp, blurred] = pictures_of(probe)

    def fault(of: Sidecar = record) -> str:
        return faulty_picture(probe, of)

    assert fault() == ""
    assert fault(replace(record, levels=())) == "its record names no pictures"
    extra = replace(record.levels[1], roughness=0.7)
    assert (
        fault(replace(record, levels=(*record.levels, extra)))
        == "its picture of roughness 0.7 is missing from the file"
    )
    other = replace(record.levels[0], file="other.exr")
    assert fault(replace(record, levels=(other,))) == f"its picture '{sharp}' is that of another bake"
    larger = replace(record.levels[0], size=record.levels[0].size + 1)
    assert fault(replace(record, levels=(larger,))).endswith("is not the one that was baked: it has another size")
    unsized = tuple(replace(level, size=0) for level in record.levels)
    assert fault(replace(record, levels=unsized)) == "", "older records note no size"
    whole = blurred.read_bytes()
    blurred.write_bytes(whole[:200])
    assert fault() == f"its picture '{blurred}' is not the one that was baked: it has another size"
    assert fault(replace(record, levels=unsized)) == f"its picture '{blurred}' cannot be read"
    blurred.unlink()
    assert fault() == f"its picture '{blurred}' is missing"
    probe.pcc_probe.levels[0].image = None
    assert fault() == "its picture of roughness 0 is missing from the file"


def test_a_packed_picture_of_another_bake_is_named(scene) -> None:
    probe = small_probe()
    stored(probe, None)
    record = record_of(probe)
    level = record.levels[0]
    name = probe.pcc_probe.levels[0].image.name
    other = replace(record, levels=(replace(level, size=level.size + 1),))
    assert faulty_picture(probe, other) == f"its packed picture '{name}' is not the one that was baked"
    assert faulty_picture(probe, replace(record, levels=(replace(level, size=0),))) == ""


def test_a_folder_that_cannot_be_written_is_named_and_nothing_stays(scene, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(
            BakeError, match=f"cannot write into '{folder}' .*; free space there, make it writable or choose another"
        ):
            check_folder(folder)
    check_folder(tmp_path / "new" / "deep")
    check_folder(None)
    assert [path.name for path in tmp_path.iterdir()] == ["file"] and (tmp_path / "file").read_text() == "mine"
    (tmp_path / "kept").mkdir()
    check_folder(tmp_path / "kept")
    assert (tmp_path / "kept").is_dir()


def test_a_store_that_fails_leaves_the_old_bake(scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    probe = small_probe()
    stored(probe, tmp_path)
    before, record = {path: path.read_bytes() for path in tmp_path.iterdir()}, probe.pcc_probe.bake_record

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pcc_addon.core.sidecar.move_into_place", full)
    with pytest.raises(BakeError, match=r"probe 'Probe': cannot write into .* \(No space left on device\); free space"):
        stored(probe, tmp_path, r5=SHARP)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert probe.pcc_probe.bake_record == record and len(probe.pcc_probe.levels) == 1


def test_bakes_go_beside_the_file_or_where_the_scene_says(scene, tmp_path: Path) -> None:
    assert bake_folder(scene) is None
    scene.pcc.folder = "//bakes"
    assert bake_folder(scene) is None, "relative to nothing"
    assert bake_folder(scene, str(tmp_path / "a.blend")) == (tmp_path / "bakes").resolve()
    scene.pcc.folder = str(tmp_path / "chosen")
    assert bake_folder(scene) == (tmp_path / "chosen").resolve()
    scene.pcc.folder = ""
    assert bake_folder(scene, str(tmp_path / "a.blend")) == (tmp_path / "a.pcc").resolve()
    save(tmp_path / "b.blend")
    assert bake_folder(bpy.context.scene) == (tmp_path / "b.pcc").resolve()
    bpy.context.scene.pcc.folder = "//bakes"
    assert bake_folder(bpy.context.scene) == (tmp_path / "bakes").resolve()
