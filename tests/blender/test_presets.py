"""Presets set what they name, of the chosen probes alone."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from pcc_addon.core.presets import Preset
from tests.blender.helpers import small_probe


def settings_of(probe: bpy.types.Object, names: object) -> dict[str, object]:
    return {name: getattr(probe.pcc_probe, name) for name in names}


@pytest.mark.parametrize("preset", list(Preset), ids=lambda p: p.name)
def test_a_preset_sets_the_selected_probes(scene, preset: Preset) -> None:
    first, second, other = (small_probe(name) for name in ("First", "Second", "Other"))
    wanted = asdict(preset.settings)
    before = settings_of(other, wanted)
    for probe in (first, second, other):
        probe.select_set(probe is not other)
    assert bpy.ops.pcc.preset(preset=preset.name) == {"FINISHED"}
    assert settings_of(first, wanted) == settings_of(second, wanted) == wanted
    assert settings_of(other, wanted) == before


def test_better_presets_have_more_of_everything() -> None:
    sizes = [[p.settings.resolution, p.settings.samples] for p in Preset]
    assert (np.diff(sizes, axis=0) > 0).all()
    assert (np.diff([[p.settings.relief_steps, p.settings.relief_refinements] for p in Preset], axis=0) >= 0).all()


def test_without_a_probe_it_says_what_to_do(scene) -> None:
    assert not bpy.ops.pcc.preset.poll()


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """Where Blender keeps what users save."""
    monkeypatch.setattr(bpy.utils, "user_resource", lambda kind, path="", create=False: str(tmp_path))
    monkeypatch.setattr(bpy.utils, "preset_paths", lambda subdir: [str(tmp_path)])
    return tmp_path


def test_what_a_user_saved_is_set_again_of_all_that_are_selected(scene, folder) -> None:
    first, second, other = (small_probe(name) for name in ("First", "Second", "Other"))
    bpy.context.view_layer.objects.active = first
    names = [name.removeprefix("probe.") for name in bpy.types.PCC_OT_preset_add.preset_values]
    first.pcc_probe.resolution, first.pcc_probe.correction, first.pcc_probe.engine = 333, "RELIEF", "EEVEE"
    first.pcc_probe.picture = "//mine.exr"
    wanted, before = settings_of(first, names), settings_of(other, names)
    assert bpy.ops.pcc.preset_add(name="My Rooms") == {"FINISHED"}
    [saved] = folder.glob("*.py")
    first.pcc_probe.resolution = 64
    for probe in (first, second, other):
        probe.select_set(probe is not other)
    assert bpy.ops.pcc.preset_load(filepath=str(saved), menu_idname="PCC_PT_presets") == {"FINISHED"}
    assert settings_of(first, names) == settings_of(second, names) == wanted
    assert settings_of(other, names) == before and second.pcc_probe.picture == ""
    assert bpy.context.object == first


def test_a_preset_that_is_broken_is_told(scene, folder) -> None:
    small_probe().select_set(True)
    (folder / "broken.py").write_text("import bpy\nprobe = bpy.context.object.pcc_probe\nprobe.samples = 'many'\n")
    with pytest.raises(RuntimeError, match=r"Preset 'broken' cannot be loaded .*; save it again"):
        bpy.ops.pcc.preset_load(filepath=str(folder / "broken.py"))


@pytest.mark.parametrize("preset", list(Preset), ids=lambda p: p.name)
def test_a_preset_says_what_it_sets(preset: Preset) -> None:
    said = bpy.types.PCC_OT_preset.description(bpy.context, SimpleNamespace(preset=preset.name))
    assert f"{preset.settings.resolution} px faces, {preset.settings.samples} samples denoised" in said


def test_a_new_probe_is_set_as_the_preset_says_and_scripts_get_the_usual_one(scene) -> None:
    scene.pcc.preset = Preset.PREVIEW.name
    bpy.ops.pcc.probe_add(name="Scripted")
    bpy.ops.pcc.probe_add(name="Chosen", preset=Preset.FINAL.name)
    wanted = asdict(Preset.FINAL.settings)
    assert settings_of(bpy.data.objects["Chosen"], wanted) == wanted
    assert bpy.data.objects["Scripted"].pcc_probe.resolution == 512
