"""A chrome ball that rolls through a room, past a box that slides, to a door that opens; then a lamp blinks.

The ball's probe stays on the walls and is captured from wherever the ball is. From frame 21 on only the lamp changes.
"""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix, Vector

from .scenes import Room, add_box, add_camera, add_wall, empty_scene, principled

ROOM = Room((2.6, 2.1, 1.3), (4.0, -2.0, 1.3), math.radians(15.0))
FRAMES = (1, 40)
AT_REST = 20  # from then on nothing moves
BLINKS = ((1, 1.0), (25, 0.0), (29, 1.0), (33, 0.0), (37, 1.0))  # frame, and whether the lamp is on
RADIUS = 0.35


def moving() -> bpy.types.Scene:
    """The room with its two probes, unbaked: the ball's, and one for the floor that leaves the ball out."""
    scene = empty_scene()
    _walls()
    ball, box, door = _ball(), _sliding_box(), _door()
    _keys(ball, ROOM.world(-1.5, -0.7, RADIUS - 1.3), ROOM.world(0.9, 0.5, RADIUS - 1.3))
    _keys(box, ROOM.world(-1.4, 1.7, -0.9), ROOM.world(0.2, 1.7, -0.9))
    _keys(door, ROOM.world(2.57, 0.3, -0.3), ROOM.world(2.57, -0.75, -0.3), begin=8)
    _lamps()
    _probes(scene, ball)
    add_camera(ROOM.world(-0.6, -2.0, 0.55), ROOM.world(0.2, 0.3, -0.75), 20.0, 320, 180)
    scene.cycles.samples = 64
    scene.frame_start, scene.frame_end = FRAMES
    scene.frame_set(FRAMES[0])
    return scene


def _matt(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    return principled(name, Base_Color=(*color, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)


def _walls() -> None:
    colors = {"+X": (0.75, 0.7, 0.6), "-X": (0.65, 0.12, 0.08), "+Y": (0.75, 0.75, 0.72), "-Y": (0.1, 0.35, 0.16)}
    for side, color in {**colors, "+Z": (0.8, 0.8, 0.8)}.items():
        add_wall(ROOM, side, _matt(f"Wall {side}", color))
    add_wall(ROOM, "-Z", principled("Floor", Base_Color=(0.12, 0.1, 0.09, 1.0), Roughness=0.05, IOR=2.0))


def _ball() -> bpy.types.Object:
    chrome = principled("Chrome", Base_Color=(0.95, 0.95, 0.95, 1.0), Metallic=1.0, Roughness=0.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=RADIUS)
    ball = bpy.context.object
    ball.name = "Ball"
    ball.data.materials.append(chrome)
    ball.data.shade_smooth()
    return ball


def _sliding_box() -> bpy.types.Object:
    return add_box(ROOM, "Sliding Box", (0.0, 0.0, 0.0), (0.35, 0.35, 0.4), _matt("Orange", (0.9, 0.35, 0.02)))


def _door() -> bpy.types.Object:
    """A door that slides aside; behind it is a lit panel on the wall."""
    sky = principled("Sky", Base_Color=(0, 0, 0, 1), Specular_IOR_Level=0.0, Emission_Color=(0.25, 0.5, 1.0, 1.0))
    sky.node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 2.5
    add_box(ROOM, "Outside", (2.595, 0.3, -0.3), (0.004, 0.5, 0.98), sky)
    return add_box(ROOM, "Door", (0.0, 0.0, 0.0), (0.02, 0.52, 1.0), _matt("Door", (0.3, 0.16, 0.07)))


def _keys(item: bpy.types.Object, start: Vector, end: Vector, begin: int = 1) -> None:
    """Let an object go from one place to another until `AT_REST`."""
    for frame, place in ((begin, start), (AT_REST, end)):
        item.location = place
        item.keyframe_insert("location", frame=frame)


def _lamps() -> None:
    for name, at, size, energy in (
        ("Lamp", (0.4, 0.2, 1.27), 1.2, 45.0),
        ("Blinking Lamp", (-1.9, 1.5, 1.27), 0.7, 90.0),
    ):
        light = bpy.data.lights.new(name, "AREA")
        light.size, light.energy = size, energy
        lamp = bpy.data.objects.new(name, light)
        lamp.matrix_world = ROOM.matrix @ Matrix.Translation(at)
        bpy.context.scene.collection.objects.link(lamp)
    light.color = (1.0, 0.8, 0.4)
    before = 1.0
    for frame, on in BLINKS:
        for at, value in ((frame - 1, before), (frame, on)):
            light.energy = energy * value
            light.keyframe_insert("energy", frame=at)
        before = on


def _probes(scene: bpy.types.Scene, ball: bpy.types.Object) -> None:
    alone = bpy.data.collections.new("Chrome Ball")
    scene.collection.children.link(alone)
    alone.objects.link(ball)
    for name in ("Ball Probe", "Room Probe"):
        bpy.ops.pcc.probe_add(
            name=name, location=ROOM.centre, rotation=(0.0, 0.0, ROOM.turn), half_extents=ROOM.half_extents
        )
        settings = bpy.data.objects[name].pcc_probe
        settings.resolution, settings.samples = 128, 16
    mine, room = (bpy.data.objects[name].pcc_probe for name in ("Ball Probe", "Room Probe"))
    mine.follow, mine.receivers = ball, alone
    room.excluded, room.hidden_collection = alone, alone
