"""Presets set what they name, of the chosen probes alone."""

from __future__ import annotations

from dataclasses import asdict

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
