"""A sequence and an animated probe in final renders of other frames, by a Blender without the add-on."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import relative_rmse, render
from pcc_addon.blender import compat
from pcc_addon.core.frames import FrameRange
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, principled_node
from tests.blender.helpers import ROOM, bake_folder, put_in, save, small_room
from tests.eevee import without_shadows

FRAMES = (1, 3, 5)
WIDTH, HEIGHT = 64, 48
WITHOUT_ADDON = """
import sys, bpy, numpy as np
blend, out, engine, *frames = sys.argv[1:]
bpy.ops.wm.open_mainfile(filepath=blend)
assert not hasattr(bpy.types.Object, "pcc_probe")
scene = bpy.context.scene
scene.render.engine, scene.render.filepath = engine, out + "/picture"
pictures = []
for frame in frames:
    scene.frame_set(int(frame))
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(out + "/picture.exr")
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    pictures.append(pixels.reshape(image.size[1], image.size[0], 4)[..., :3])
    bpy.data.images.remove(image)
np.save(out + "/pictures.npy", np.array(pictures))
"""


@pytest.fixture
def mirror_room(scene: bpy.types.Scene, tmp_path: Path) -> bpy.types.Object:
    """A saved room with a mirror for a floor and a wall that goes dark from frame 1 to 5; its probe."""
    probe = small_room()
    probe.pcc_probe.resolution = 48
    floor = principled_node(bpy.data.materials["Floor"]).inputs
    floor["Metallic"].default_value, floor["Base Color"].default_value = 1.0, (1.0, 1.0, 1.0, 1.0)
    strength = principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Strength"]
    for frame, value in ((1, 1.0), (5, 0.0)):
        strength.default_value = value
        strength.keyframe_insert("default_value", frame=frame)
    bottom = Vector(ROOM.world(0.0, 0.0, -ROOM.half_extents[2]))
    add_camera(bottom + Vector((-1.3, -0.7, 1.0)), bottom + Vector((0.6, 0.3, 0.0)), 24.0, WIDTH, HEIGHT)
    scene.cycles.samples, scene.eevee.taa_render_samples = 4, 2
    compat.set_float_exr(scene.render.image_settings)
    without_shadows(scene)
    scene.frame_set(1)
    save(tmp_path / "room.blend")
    return probe


def follow(probe: bpy.types.Object) -> None:
    """The capture point goes through the room with something."""
    thing = bpy.data.objects.new("Thing", None)
    bpy.context.scene.collection.objects.link(thing)
    for frame, place in ((1, (-1.0, -0.5, 0.0)), (5, (1.0, 0.5, 0.3))):
        thing.location = ROOM.world(*place)
        thing.keyframe_insert("location", frame=frame)
    probe.pcc_probe.follow = thing


def ride(probe: bpy.types.Object) -> None:
    """The room, all that is in it and the camera go along with the probe, on a parent that is animated and turns."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    bpy.context.view_layer.update()
    for item in [o for o in bpy.context.scene.objects if o != parent]:
        item.parent = parent
    for frame, place, turn in ((1, (0.0, 0.0, 0.0), 0.0), (5, (7.0, -3.0, 2.0), 1.0)):
        parent.location, parent.rotation_euler[2] = place, turn
        parent.keyframe_insert("location", frame=frame)
        parent.keyframe_insert("rotation_euler", frame=frame)


def stand(probe: bpy.types.Object) -> None:
    """Nothing but the light changes."""


@pytest.mark.sweep
@pytest.mark.parametrize("move", [stand, follow, ride], ids=lambda f: f.__name__)
def test_each_frame_is_right_without_the_add_on(mirror_room, scene, tmp_path: Path, move) -> None:
    move(mirror_room)
    truth = []
    for frame in FRAMES:
        scene.frame_set(frame)
        truth.append(render(scene, samples=16).pixels)
    scene.frame_set(2)
    assert bpy.ops.pcc.bake(scope="ALL", frames=FrameRange(1, 5).text) == {"FINISHED"}
    assert bake_folder(scene).is_dir()
    put_in()
    save(tmp_path / "room.blend")
    for engine in Engine:
        command = [sys.executable, "-c", WITHOUT_ADDON, str(tmp_path / "room.blend"), str(tmp_path)]
        command += [compat.engine_id(engine), *map(str, FRAMES)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[-2000:]
        shown = np.load(tmp_path / "pictures.npy")
        errors = np.array([[relative_rmse(picture, other) for other in truth] for picture in shown])
        assert (np.diag(errors) <= 0.13).all(), (engine, errors)
        assert (errors + np.eye(len(FRAMES)) >= 0.3).all(), "frames are alike, so that nothing is tested"
