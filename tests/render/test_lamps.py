"""A capture sees the lamps that a reflection ray would see, as bright and as large, in both engines."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest

from pcc_addon.blender.store import pictures
from pcc_addon.core import equirect
from sample_blends.scenes import empty_scene


def _add_lamp(kind: str, location: tuple, rotation: tuple, **settings: object) -> None:
    light = bpy.data.lights.new(kind, kind)
    for name, value in settings.items():
        setattr(light, name, value)
    lamp = bpy.data.objects.new(kind, light)
    lamp.location, lamp.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(lamp)


def _captured(engine: str) -> np.ndarray:
    probe = bpy.data.objects["P"].pcc_probe
    probe.engine, probe.resolution, probe.samples, probe.denoise = engine, 64, 16, False
    bpy.ops.pcc.bake(scope="ALL")
    return pictures.read_pixels(probe.levels[0].image)


def _flux(picture: np.ndarray, towards: int, sign: int) -> float:
    """Radiance integrated over the directions of one half space."""
    height, width = picture.shape[:2]
    half = equirect.directions(width, height)[..., towards] * sign > 0.7
    return float((picture.mean(-1) * equirect.solid_angles(width, height)[:, None])[half].sum())


@pytest.mark.heavy
def test_area_point_and_spot_lamps_are_as_bright_in_eevee_as_in_cycles() -> None:
    empty_scene()
    bpy.ops.pcc.probe_add(name="P", half_extents=(5, 5, 5))
    _add_lamp("AREA", (0, 0, 3), (0, 0, 0), energy=50.0, shape="RECTANGLE", size=2.0, size_y=1.0)
    _add_lamp("POINT", (4, 0, 0), (0, 0, 0), energy=30.0, shadow_soft_size=0.6)
    _add_lamp("SPOT", (0, 4, 0), (-math.pi / 2, 0, 0), energy=30.0, shadow_soft_size=0.6, spot_size=1.5, spot_blend=0.1)
    _add_lamp("AREA", (-4, 0, 0), (0, math.pi / 2, 0), energy=50.0, size=2.0)  # shines away
    cycles, eevee = _captured("CYCLES"), _captured("EEVEE")
    for towards, sign in ((2, 1), (0, 1), (1, 1)):
        expected = _flux(cycles, towards, sign)
        assert expected > 0.01
        assert _flux(eevee, towards, sign) == pytest.approx(expected, rel=0.08)
    assert _flux(cycles, 0, -1) == pytest.approx(_flux(eevee, 0, -1), abs=0.01)
