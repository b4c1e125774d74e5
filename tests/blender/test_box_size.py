"""The size of a box in lengths is the object's scale, whatever is around it."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from pcc_addon.blender.read.probes import probe_spec
from tests.blender.helpers import small_probe


def edges(probe: bpy.types.Object) -> np.ndarray:
    bpy.context.view_layer.update()
    return 2.0 * probe_spec(probe).box.half_extents


def plain(probe: bpy.types.Object) -> None:
    pass


def turned(probe: bpy.types.Object) -> None:
    probe.rotation_euler = (0.3, -0.2, 1.1)


def parented(probe: bpy.types.Object) -> None:
    turned(probe)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, parent.rotation_euler = (1.0, 2.0, 0.5), (0.0, 0.4, 0.0)
    probe.parent = parent


def stretched(probe: bpy.types.Object) -> None:
    turned(probe)
    probe.delta_scale, probe.empty_display_size = (1.5, 1.0, 2.0), 0.5


def mirrored(probe: bpy.types.Object) -> None:
    probe.scale.x *= -1.0


@pytest.mark.parametrize("way", [plain, turned, parented, stretched, mirrored], ids=lambda w: w.__name__)
def test_it_is_told_and_set_in_lengths(scene, way) -> None:
    probe = small_probe()
    way(probe)
    np.testing.assert_allclose(probe.pcc_probe.size, edges(probe), rtol=1e-5)
    signs = np.sign(probe.scale)
    for size in ((5.0, 6.0, 7.0), (0.5, 0.25, 0.125)):
        probe.pcc_probe.size = size
        np.testing.assert_allclose(probe.pcc_probe.size, size, rtol=1e-5)
        np.testing.assert_allclose(edges(probe), size, rtol=1e-5)
    assert (np.sign(probe.scale) == signs).all(), "what mirrors it stays"


def test_a_box_without_volume_is_not_made_but_mended(scene) -> None:
    probe = small_probe()
    probe.pcc_probe.size = (0.0, 5.0, 0.0)
    np.testing.assert_allclose(probe.pcc_probe.size, (4.0, 5.0, 2.0), rtol=1e-5)
    probe.scale.x = 0.0
    probe.pcc_probe.size = (3.0, 5.0, 2.0)
    np.testing.assert_allclose(edges(probe), (3.0, 5.0, 2.0), rtol=1e-5)
