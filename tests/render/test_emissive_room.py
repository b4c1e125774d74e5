"""The floor of a turned room far from the origin, against the path tracer's exact picture."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from benchmarks.measure import covered, relative_rmse, render
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_camera, add_room_probe, emissive_room, principled_node
from tests.eevee import without_shadows


@pytest.fixture
def room() -> bpy.types.Scene:
    scene = emissive_room()
    scene.render.resolution_x, scene.render.resolution_y = 240, 135
    settings = add_room_probe(EMISSIVE_ROOM, (0.0, 0.0, -0.35)).pcc_probe
    settings.samples, settings.denoise = 16, False
    return scene


def _bake(resolution: int, engine: Engine = Engine.CYCLES) -> None:
    settings = bpy.data.objects["Room"].pcc_probe
    settings.resolution, settings.engine = resolution, engine.value
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()


def _truth(scene: bpy.types.Scene) -> tuple[np.ndarray, np.ndarray]:
    return render(scene).pixels, covered(scene, bpy.data.objects["Wall -Z"])


def test_box_correction_finds_the_room_and_the_classic_lookup_does_not(room: bpy.types.Scene) -> None:
    truth, floor = _truth(room)
    _bake(128)
    assert relative_rmse(render(room).pixels, truth, floor) <= 0.12
    bpy.data.objects["Room"].pcc_probe.correction = "NONE"
    assert relative_rmse(render(room).pixels, truth, floor) >= 0.5


@pytest.mark.heavy
def test_a_rough_floor_shows_what_its_lobe_gathers_and_hardens_towards_walls(room: bpy.types.Scene) -> None:
    """Along the mirrored view the error is 0.30. Seen from above, the floor hardens towards the walls."""
    inputs = principled_node(bpy.data.objects["Wall -Z"].data.materials[0]).inputs
    inputs["Roughness"].default_value = 0.4
    bpy.data.objects.remove(room.camera)
    add_camera(EMISSIVE_ROOM.world(-4.2, -3.3, -1.6), EMISSIVE_ROOM.world(1.2, 0.9, -2.0), 24.0, 120, 68)
    truth, floor = render(room, samples=512).pixels, covered(room, bpy.data.objects["Wall -Z"])
    _bake(128)
    assert relative_rmse(render(room).pixels, truth, floor) <= 0.18
    bpy.data.objects.remove(room.camera)
    add_camera(EMISSIVE_ROOM.world(-4.2, -3.3, 0.0), EMISSIVE_ROOM.world(1.2, 0.9, -2.0), 24.0, 120, 68)
    bpy.ops.pcc.remove()
    truth, floor = render(room, samples=512).pixels, covered(room, bpy.data.objects["Wall -Z"])
    bpy.ops.pcc.inject()
    plain = relative_rmse(render(room).pixels, truth, floor)
    bpy.data.objects["Room"].pcc_probe.contact_hardening = True
    for engine in Engine:
        assert relative_rmse(render(room, engine, samples=8).pixels, truth, floor) <= 0.75 * plain


def test_a_box_that_is_fitted_after_the_bake_is_right_at_once(room: bpy.types.Scene) -> None:
    truth, floor = _truth(room)
    probe = bpy.data.objects["Room"]
    probe.scale = (4.0, 3.5, 1.8)
    probe.location.x += 0.4
    probe.pcc_probe.capture_offset = (0.1, 0.2, -0.1)
    probe.pcc_probe.outside = "UNCORRECTED"  # or the floor outside the box would keep its own reflection
    _bake(128)
    assert relative_rmse(render(room).pixels, truth, floor) >= 0.2
    probe.scale, probe.location = EMISSIVE_ROOM.half_extents, EMISSIVE_ROOM.centre
    assert relative_rmse(render(room).pixels, truth, floor) <= 0.12


def test_removing_brings_the_path_traced_picture_back(room: bpy.types.Scene) -> None:
    before = render(room, samples=4).pixels
    _bake(32)
    assert not np.array_equal(render(room, samples=4).pixels, before)
    bpy.ops.pcc.remove()
    assert np.array_equal(render(room, samples=4).pixels, before)


@pytest.mark.heavy
def test_no_shadow_map_changes_what_eevee_shows_of_a_probe(room: bpy.types.Scene) -> None:
    """Blender's own settings, which other tests spare."""
    _bake(32)
    before = render(room, Engine.EEVEE, samples=1).pixels
    without_shadows(room)
    np.testing.assert_allclose(render(room, Engine.EEVEE, samples=1).pixels, before, atol=2e-3)
    assert before.std() > 0.1


@pytest.mark.heavy
def test_error_stays_below_what_the_readme_promises(room: bpy.types.Scene) -> None:
    room.render.resolution_x, room.render.resolution_y = 480, 270
    bpy.data.objects["Room"].pcc_probe.samples = 4  # nothing is noisy here but edges
    without_shadows(room)
    truth, floor = _truth(room)
    for resolution, bound in ((512, 0.035), (1024, 0.015)):
        _bake(resolution)
        cycles = relative_rmse(render(room).pixels, truth, floor)
        eevee = relative_rmse(render(room, Engine.EEVEE).pixels, truth, floor)
        assert cycles <= bound
        assert eevee <= cycles + 0.003


@pytest.mark.heavy
def test_a_bake_by_eevee_is_as_good(room: bpy.types.Scene) -> None:
    without_shadows(room)
    truth, floor = _truth(room)
    _bake(256, Engine.EEVEE)
    assert relative_rmse(render(room).pixels, truth, floor) <= 0.07
