"""Settings of the user's own renders: each would change a capture, and none does."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake import capture
from pcc_addon.blender.rendering import Renderer
from pcc_addon.blender.status import statuses
from sample_blends.scenes import Room, add_wall, principled
from tests.blender.helpers import bake, glow, picture, small_probe, small_room

ROOM = Room((2.0, 1.5, 1.0), (3.0, -2.0, 1.0), 0.0)
ABSENT = np.zeros((0, 0, 3))  # where there is no picture at all


@pytest.fixture
def probe(scene: bpy.types.Scene) -> bpy.types.Object:
    """In a room that is open to a bright world on one side, lit with noise, with something that moves."""
    background = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (0.2, 0.4, 0.9, 1.0), 1.0
    for side in ("+X", "-X", "+Z", "-Z"):
        add_wall(ROOM, side, principled(f"Paint {side}", Base_Color=(0.8, 0.5, 0.3, 1.0)))
    add_wall(ROOM, "-Y", glow("Glow", (1.0, 0.6, 0.2)))
    mesh = bpy.data.meshes.new("Mover")
    mesh.from_pydata([(-0.4, 0, -0.4), (0.4, 0, -0.4), (0.4, 0, 0.4), (-0.4, 0, 0.4)], [], [(0, 1, 2, 3)])
    mesh.materials.append(glow("Mover", (0.0, 2.0, 0.0)))
    mover = bpy.data.objects.new("Mover", mesh)
    for frame, x in ((0, -1.5), (2, 1.5)):
        mover.location = (ROOM.centre[0] + x, ROOM.centre[1] + 1.0, ROOM.centre[2])
        mover.keyframe_insert("location", frame=frame)
    scene.collection.objects.link(mover)
    scene.frame_set(1)
    probe = small_probe()
    probe.pcc_probe.samples = 32  # adaptive sampling looks after 16
    return probe


def motion_blur(scene: bpy.types.Scene) -> None:
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 2.0


def time_limit(scene: bpy.types.Scene) -> None:
    scene.cycles.time_limit = 1e-6


def adaptive_sampling(scene: bpy.types.Scene) -> None:
    scene.cycles.use_adaptive_sampling = True
    scene.cycles.adaptive_threshold, scene.cycles.adaptive_min_samples = 1.0, 1


def pixel_aspect(scene: bpy.types.Scene) -> None:
    scene.render.pixel_aspect_x = 2.0


def pixel_aspect_of_y(scene: bpy.types.Scene) -> None:
    scene.render.pixel_aspect_y = 2.0


def percentage(scene: bpy.types.Scene) -> None:
    scene.render.resolution_percentage = 50


def size(scene: bpy.types.Scene) -> None:
    scene.render.resolution_x, scene.render.resolution_y = 20, 24


def border(scene: bpy.types.Scene) -> None:
    scene.render.use_border, scene.render.border_max_x, scene.render.border_max_y = True, 0.4, 0.3


def film_transparent(scene: bpy.types.Scene) -> None:
    scene.render.film_transparent = True


def film_exposure(scene: bpy.types.Scene) -> None:
    scene.cycles.film_exposure = 4.0


def pixel_filter(scene: bpy.types.Scene) -> None:
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 5.0


def samples(scene: bpy.types.Scene) -> None:
    scene.cycles.samples = 3


def denoising(scene: bpy.types.Scene) -> None:
    scene.cycles.use_denoising = True


def sequencer(scene: bpy.types.Scene) -> None:
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    length = {"length": 10} if bpy.app.version >= (5, 0) else {"frame_end": 10}
    strips.new_effect("Red", "COLOR", 1, frame_start=0, **length).color = (1.0, 0.0, 0.0)


def freestyle(scene: bpy.types.Scene) -> None:
    scene.render.use_freestyle = bpy.context.view_layer.use_freestyle = True
    style = bpy.context.view_layer.freestyle_settings.linesets.new("Lines")
    style.linestyle.thickness = 9.0


def multiview(scene: bpy.types.Scene) -> None:
    scene.render.use_multiview, scene.render.views_format = True, "STEREO_3D"


def compositor(scene: bpy.types.Scene) -> None:
    if bpy.app.version >= (5, 0):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Post", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        layers, out = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        layers, out = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeComposite")
    invert = tree.nodes.new("CompositorNodeInvert")
    tree.links.new(layers.outputs["Image"], invert.inputs["Color"])
    tree.links.new(invert.outputs[0], out.inputs[0])


SETTINGS = [
    motion_blur, time_limit, adaptive_sampling, pixel_aspect, pixel_aspect_of_y, percentage, size, border,
    film_transparent, film_exposure, pixel_filter, samples, denoising, sequencer, freestyle, multiview, compositor,
]  # fmt: skip


def captured(probe: bpy.types.Object) -> np.ndarray:
    bake(probe)
    return picture(probe).copy()


@pytest.fixture(scope="module")
def kept() -> list[np.ndarray]:
    """The room's picture, once a test has baked it; every test's room is the same to the digit."""
    return []


@pytest.fixture
def before(probe: bpy.types.Object, kept: list[np.ndarray]) -> np.ndarray:
    """What a capture sees with no setting changed."""
    if not kept:
        kept.append(captured(probe))
    return kept[0]


@pytest.mark.sweep
@pytest.mark.parametrize("change", SETTINGS, ids=lambda change: change.__name__)
def test_a_capture_does_not_obey(probe, before, change: Callable[[bpy.types.Scene], None]) -> None:
    change(bpy.context.scene)
    assert np.array_equal(captured(probe), before)


@pytest.mark.sweep
@pytest.mark.parametrize("change", SETTINGS, ids=lambda change: change.__name__)
def test_a_capture_that_obeyed_would_differ(
    probe, before, monkeypatch, change: Callable[[bpy.types.Scene], None]
) -> None:
    """So the test above can fail: with the overrides gone, the setting changes the picture or leaves none."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = probe.pcc_probe.resolution + 2 * capture.OVERSCAN
    scene.render.resolution_percentage = 100
    scene.cycles.samples, scene.cycles.use_denoising = probe.pcc_probe.samples, False
    scene.cycles.pixel_filter_type = "BOX"
    monkeypatch.setattr(capture.compat, "detach_compositor", lambda *_: None)
    monkeypatch.setattr(capture, "_quiet_render", lambda *_: None)
    monkeypatch.setattr(capture, "_set_engines", lambda *_: None)
    monkeypatch.setattr(capture.Renderer, "use", lambda self, settings: None)
    assert np.array_equal(captured(probe), before), "and without it, it would not"
    change(scene)
    [result] = bake(probe)
    after = ABSENT if result.error else picture(probe)
    assert after.shape != before.shape or np.abs(after - before).max() > 1e-3


def test_adaptive_sampling_is_a_setting_of_the_probe(scene, monkeypatch) -> None:
    """It is on with its threshold while faces are rendered, and off for distances and where it is not set."""
    probe = small_room()
    probe.pcc_probe.correction = "RELIEF"
    seen, once = [], Renderer._render

    def noting(self: Renderer, what: str, **options: bool) -> None:
        cycles = bpy.context.scene.cycles
        seen.append((cycles.use_adaptive_sampling, round(cycles.adaptive_threshold, 6)))
        once(self, what, **options)

    monkeypatch.setattr(Renderer, "_render", noting)
    before = scene.cycles.use_adaptive_sampling, scene.cycles.adaptive_threshold
    bake(probe)
    assert {on for on, _ in seen} == {False}
    fresh = statuses(scene, bpy.context.view_layer)[0].state
    seen.clear()
    probe.pcc_probe.adaptive = 0.05
    assert (fresh, statuses(scene, bpy.context.view_layer)[0].state) == ("baked", "stale")
    bake(probe)
    assert (True, 0.05) in seen and False in {on for on, _ in seen}
    assert (scene.cycles.use_adaptive_sampling, scene.cycles.adaptive_threshold) == before
