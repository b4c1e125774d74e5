"""Where the pictures of a bake go: packed or beside the file, under safe names, never in place of another probe's."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.status import statuses
from pcc_addon.blender.store import pictures
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.core import equirect
from pcc_addon.core.errors import BakeError
from pcc_addon.core.pictures import LADDER
from sample_blends.scenes import empty_scene
from tests.blender.helpers import (
    ROOM,
    bake,
    contents,
    paint_wall,
    picture,
    pictures_of,
    put_in,
    save,
    small_probe,
    small_room,
)


def test_a_bake_of_an_unsaved_file_is_packed_into_it(scene, tmp_path: Path) -> None:
    probe = small_room()
    [result] = bake(probe)
    assert result.error is None and result.files == ()
    assert [level.image.packed_file is not None for level in probe.pcc_probe.levels] == [True] * len(LADDER)
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


@pytest.mark.parametrize("saved", [False, True])
def test_files_that_pack_their_resources_by_themselves_are_baked_too(scene, tmp_path: Path, saved) -> None:
    probe = small_room()
    bpy.data.use_autopack = True  # File > External Data > Automatically Pack Resources
    if saved:
        save(tmp_path / "room.blend")
    for _ in range(2):
        paint_wall()
        [result] = bake(probe)
        assert result.error is None
        seen = [picture(probe, roughness) for roughness in LADDER]
        assert all(not np.array_equal(a, b) for a, b in itertools.pairwise(seen))
        assert np.abs(equirect.lookup(seen[0], np.array((-1.0, 0.0, 0.0)))).max() == pytest.approx(1.0, abs=0.02)
    [status] = statuses(scene, bpy.context.view_layer)
    assert status.state == "baked"


def test_a_bake_of_a_saved_file_lies_beside_it(scene, tmp_path: Path) -> None:
    probe = small_room()
    save(tmp_path / "room.blend")
    [result] = bake(probe)
    assert [Path(f).parent.name for f in result.files] == ["room.pcc"] * len(LADDER)
    assert pictures_of(probe)[0].suffix == ".exr"
    assert not probe.pcc_probe.levels[0].image.packed_file
    assert probe.pcc_probe.levels[0].image.filepath.startswith("//")
    [sidecar] = (tmp_path / "room.pcc").glob("*.json")
    described = json.loads(sidecar.read_text(encoding="utf-8"))
    assert described["probe"] == "Probe" and described["content_hash"] == bake_record(probe).content_hash
    assert described["capture_point"] == pytest.approx(ROOM.centre)
    assert np.allclose(np.reshape(described["matrix"], (4, 4)), probe.matrix_world)
    assert [level["roughness"] for level in described["levels"]] == list(LADDER)
    for level in described["levels"]:
        assert np.array_equal(pictures.read_file(sidecar.parent / level["file"]), picture(probe, level["roughness"]))
        assert (level["width"], level["height"]) == (64, 32)
    assert sorted(p.suffix for p in (tmp_path / "room.pcc").iterdir()) == [".exr"] * len(LADDER) + [".json"]


def test_every_level_has_its_own_file_and_is_more_blurred_than_the_one_before(scene, tmp_path: Path) -> None:
    probe = small_room()
    save(tmp_path / "room.blend")
    bake(probe)
    assert len(set(pictures_of(probe))) == len(LADDER) and all(path.is_file() for path in pictures_of(probe))
    spreads = [picture(probe, roughness).std() for roughness in LADDER]
    assert spreads == sorted(spreads, reverse=True) and spreads[-1] < spreads[0]


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
    assert len({path for probe in probes for path in pictures_of(probe)}) == 3 * len(LADDER)


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
    assert [Path(f).parent for f in result.files] == [tmp_path / "deep" / "folder"] * len(LADDER)


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


def test_a_cancelled_bake_leaves_no_empty_folders(scene, tmp_path: Path) -> None:
    probe = small_room()
    scene.pcc.folder = str(tmp_path / "deep" / "folder")
    work = BakeJob(scene, bpy.context.view_layer, [probe], bake_folder(scene))
    assert work.step() and work.step()
    work.cancel()
    assert list(tmp_path.iterdir()) == []


def test_a_bake_that_cannot_be_stored_leaves_no_empty_folder_and_an_old_one_stays(
    scene, tmp_path: Path, monkeypatch
) -> None:
    probe = small_room()
    monkeypatch.setattr(pictures, "write_file", lambda *_, **__: (_ for _ in ()).throw(BakeError("the disk is full")))
    scene.pcc.folder = str(tmp_path / "new")
    assert bake(probe)[0].error == "probe 'Probe': the disk is full"
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "old").mkdir()
    scene.pcc.folder = str(tmp_path / "old")
    bake(probe)
    assert [path.name for path in tmp_path.iterdir()] == ["old"]


def test_what_a_killed_run_left_in_the_folder_is_removed_by_the_next_bake(scene, tmp_path: Path) -> None:
    probe = small_room()
    save(tmp_path / "room.blend")
    script = (
        "import os; from pathlib import Path; from pcc_addon.core.workplace import *\n"
        f"with temporary_folder(UNFINISHED, Path({str(tmp_path / 'room.pcc')!r})): os._exit(9)"
    )
    (tmp_path / "room.pcc").mkdir()
    subprocess.run([sys.executable, "-c", script], cwd=Path(__file__).parents[2])
    assert len(list((tmp_path / "room.pcc").glob(".unfinished-*"))) == 1
    bake(probe)
    assert list((tmp_path / "room.pcc").glob(".unfinished-*")) == []


@pytest.mark.parametrize("act", [bake, lambda probe: put_in()], ids=["bake", "inject"])
def test_a_renamed_probe_takes_its_names_along(scene, tmp_path: Path, act) -> None:
    probe = small_room()
    save(tmp_path / "room.blend")
    bake(probe)
    probe.name = "Hall"
    act(probe)
    assert [i.name for i in bpy.data.images if "Probe" in i.name] == []
    assert len([i.name for i in bpy.data.images if i.name.startswith("PCC Hall 0.")]) == len(LADDER)
    assert probe.pcc_probe.group.name == "PCC Probe Hall"


def test_an_appended_probe_shows_the_sources_pictures_until_it_is_baked_into_its_own_folder(
    scene, tmp_path: Path
) -> None:
    probe = small_room()
    (tmp_path / "source").mkdir()
    save(tmp_path / "source" / "room.blend")
    bake(probe)
    save(tmp_path / "source" / "room.blend")
    shown, source = picture(probe).copy(), contents(tmp_path / "source")
    empty_scene()
    (tmp_path / "own").mkdir()
    save(tmp_path / "own" / "shot.blend")
    with bpy.data.libraries.load(str(tmp_path / "source" / "room.blend"), link=False) as (there, wanted):
        wanted.objects = there.objects
    for item in wanted.objects:
        bpy.context.scene.collection.objects.link(item)
    probe = bpy.data.objects["Probe"]
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert status.state == "baked" and np.array_equal(picture(probe), shown)
    put_in()
    save(tmp_path / "own" / "shot.blend")
    probe.pcc_probe.resolution = 24
    [result] = bake(probe)
    assert {Path(file).parent for file in result.files} == {tmp_path / "own" / "shot.pcc"}
    save(tmp_path / "own" / "shot.blend")
    after = contents(tmp_path / "source")
    assert {name: after[name] for name in source} == source


def test_a_duplicate_with_the_originals_name_leaves_the_originals_pictures_alone(scene, tmp_path: Path) -> None:
    original = small_room()
    save(tmp_path / "room.blend")
    bake(original)
    before = {path: path.read_bytes() for path in pictures_of(original)}
    copy = original.copy()
    scene.collection.objects.link(copy)
    original.name, copy.name = "Away", "Probe"
    copy.location.x += 0.75
    bpy.context.view_layer.update()
    bake(copy)
    for _ in range(2):
        save(tmp_path / "room.blend")
    assert {path: path.read_bytes() for path in before} == before
    assert {s.probe: s.state for s in statuses(scene, bpy.context.view_layer)} == {"Away": "baked", "Probe": "baked"}
