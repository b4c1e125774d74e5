"""Probes and records that cannot be baked or shown: named and left alone, the others go on."""

from __future__ import annotations

import json
import re
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.status import statuses
from pcc_addon.core.errors import PccError
from sample_blends.scenes import empty_scene
from tests.blender.helpers import bake, pretend_bake, put_in, save, small_probe, small_room
from tests.blender.materials import shiny, show
from tests.shell.test_bad_input import run


def states() -> dict[str, tuple[str, str]]:
    return {s.probe: (s.state, s.why) for s in statuses(bpy.context.scene, bpy.context.view_layer)}


def exclude(probe: bpy.types.Object) -> None:
    own = bpy.data.collections.new("Attic")
    bpy.context.scene.collection.children.link(own)
    own.objects.link(probe)
    bpy.context.scene.collection.objects.unlink(probe)
    bpy.context.view_layer.layer_collection.children["Attic"].exclude = True


def disable_and_move(probe: bpy.types.Object) -> None:
    probe.hide_viewport = True
    bpy.context.view_layer.update()
    probe.location.x += 5.0


def flatten(probe: bpy.types.Object) -> None:
    """A parent's scale near 0, and a rotation: a box that is singular but for rounding."""
    parent = bpy.data.objects.new("Flat", None)
    bpy.context.scene.collection.objects.link(parent)
    probe.parent, parent.scale = parent, (1.0, 1.0, 1e-7)
    probe.rotation_euler = (0.5, 0.4, 0.3)


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (exclude, "leaves its collection out.*include"),
        (disable_and_move, "disabled in viewports.*enable"),
        (flatten, "flatten"),
    ],
    ids=["excluded", "disabled", "flat"],
)
def test_a_probe_whose_place_is_unknown_is_named_and_the_others_are_baked(scene, harm, words) -> None:
    good = small_room()
    bad = small_probe("Bad One", half_extents=(1.0, 1.0, 0.5))
    harm(bad)
    results = {result.probe: result.error for result in bake(good, bad)}
    assert results["Probe"] is None and not bad.pcc_probe.bake_record
    assert "'Bad One'" in results["Bad One"] and re.search(words, results["Bad One"])
    assert states()["Bad One"][0] == "error" and re.search(words, states()["Bad One"][1])
    report = put_in()
    assert [probe for _, probe in report.materials] == ["Probe"]
    assert any("'Bad One'" in note for note in report.notes)


def test_a_disabled_probe_that_stands_where_it_stood_is_baked(scene) -> None:
    probe = small_room()
    probe.hide_viewport = True
    [result] = bake(probe)
    assert result.error is None


@pytest.mark.parametrize("whole", [True, False])
def test_a_library_override_is_named_with_where_to_bake_it(scene, tmp_path: Path, whole: bool) -> None:
    """It shows the library's bake, unless levels are missing that it could not keep."""
    probe = small_room()
    bake(probe) if whole else pretend_bake(probe)
    save(tmp_path / "library.blend")
    empty_scene()
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Probe"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    probe = wanted.objects[0].override_create(remap_local_usages=True)
    [result] = bake(probe)
    for words in ("'Probe'", "library.blend", "Make Local"):
        assert words in result.error
    show(shiny())
    if whole:
        assert put_in().materials == (("Shiny", "Probe"),)
    else:
        with pytest.raises(PccError, match="library override"):
            put_in()


WRONG = [
    {"capture_point": [1e300, 0, 0]},
    {"capture_point": "abc"},
    {"capture_point": [10**400, 0, 0]},
    {"matrix": [{}] * 16},
    {"levels": {}},
    {"levels": None},
    {"levels": [{"key": "x-y"}]},
    {"version": 99},
    {"version": True},
    {"format": []},
    {"replaced_pixels": 5},
    {"uid": 3},
]


@pytest.mark.sweep
@pytest.mark.parametrize("wrong", WRONG, ids=str)
def test_a_tampered_record_is_named_and_the_other_probe_is_shown(scene, wrong: dict) -> None:
    good, bad = small_probe(), small_probe("Bad One")
    pretend_bake(good), pretend_bake(bad)
    bad.pcc_probe.bake_record = json.dumps({**json.loads(bad.pcc_probe.bake_record), **wrong})
    show(shiny())
    report = put_in()
    assert report.materials == (("Shiny", "Probe"),)
    assert any("'bake record of 'Bad One''" in note and "bake" in note for note in report.notes)
    assert states()["Bad One"][0] == "error"
    bpy.data.objects.remove(good)
    with pytest.raises(RuntimeError, match="Bad One"):
        bpy.ops.pcc.inject()


def test_a_record_without_pictures_is_stale(scene) -> None:
    probe = small_probe()
    pretend_bake(probe)
    probe.pcc_probe.bake_record = json.dumps({**json.loads(probe.pcc_probe.bake_record), "levels": []})
    assert states()["Probe"] == ("stale", "its record names no pictures; bake it again")


def test_a_damaged_record_is_mended_from_the_shell(capfd, scene, tmp_path: Path) -> None:
    probe = small_probe()
    pretend_bake(probe)
    probe.pcc_probe.bake_record = "{"
    save(tmp_path / "hall.blend")
    assert run(capfd, "bake", tmp_path / "hall.blend", "--stale", "--save")[0] == 0
    assert run(capfd, "status", tmp_path / "hall.blend") == (0, [])
