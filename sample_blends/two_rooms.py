"""Two furnished rooms, turned and away from the origin, that share one tiled floor: the hard case for materials."""

from __future__ import annotations

import math
from collections.abc import Container

import bpy

from .scenes import Room, add_box, add_camera, add_wall, empty_scene, principled, principled_node

TURN = math.radians(24.0)
_HALF, _WALL = (2.5, 2.5, 1.3), 0.12  # half extents of a room and the thickness of the wall between them, metres
_CENTRE = (42.0, -17.0, 4.3)


def _beside(sign: float) -> Room:
    """The room on one side of the wall between them."""
    along = Room(_HALF, _CENTRE, TURN).world(sign * (_HALF[0] + 0.5 * _WALL), 0.0, 0.0)
    return Room(_HALF, tuple(along), TURN)


LOUNGE, STUDY = _beside(-1.0), _beside(1.0)


WHOLE = Room((2.0 * _HALF[0] + 0.5 * _WALL, _HALF[1], _HALF[2]), _CENTRE, TURN)  # both rooms and the wall between
DOORWAY_Y, DOORWAY_HALF_WIDTH, DOORWAY_HEIGHT = -1.4, 0.5, 2.1  # metres, in a room's own axes


def two_rooms(roughness: float | None = None, *, doorway: bool = False) -> bpy.types.Scene:
    """The scene with a camera in the lounge and a probe in each room, called "Lounge" and "Study".

    Args:
        roughness: of the shared floor; None: tiles of 0.04 … 0.16 with rough joints.
        doorway: whether there is an opening between the rooms, and one floor that runs through it.
    """
    scene = empty_scene()
    floor = _floor(roughness)
    for name, room, wall, accent, seat in (
        ("Lounge", LOUNGE, (0.78, 0.74, 0.68), (0.62, 0.12, 0.06), (0.10, 0.30, 0.28)),
        ("Study", STUDY, (0.70, 0.74, 0.78), (0.06, 0.16, 0.55), (0.55, 0.36, 0.10)),
    ):
        between = {"Lounge": "+X", "Study": "-X"}[name]
        _walls(name, room, floor, wall, accent, {between, "-Z"} if doorway else set())
        _furniture(name, room, seat)
        _lamps(name, room)
        bpy.ops.pcc.probe_add(
            name=name, location=room.centre, rotation=(0.0, 0.0, room.turn), half_extents=room.half_extents
        )
    if doorway:
        _doorway(bpy.data.materials["Lounge Wall"])
        add_wall(WHOLE, "-Z", floor).name = "Floor"
    add_camera(LOUNGE.world(-2.2, -2.2, 0.3), LOUNGE.world(1.0, 1.2, -0.9), 20.0, 480, 270)
    scene.cycles.samples = 64
    return scene


def of_metal() -> bpy.types.Scene:
    """The rooms with one roughness of floor; the lounge's table and shelves, and a pot on the table, are of steel.

    The seat is of polished leather, and the camera sees all of this and the mirror.
    """
    scene = two_rooms(0.12)
    steel = principled("Steel", Base_Color=(0.8, 0.75, 0.7, 1.0), Metallic=1.0, Roughness=0.25)
    leather = principled("Leather", Base_Color=(0.5, 0.05, 0.03, 1.0), Roughness=0.15)
    worn = {"Table": steel, "Leg": steel, "Shelf": steel, "Seat": leather, "Back": leather}
    for item in scene.objects:
        room, _, kind = item.name.partition(".")[0].partition(" ")
        if room == "Lounge" and kind in worn:
            item.data.materials[0] = worn[kind]
    place = LOUNGE.world(0.3, 0.6, 0.68 - LOUNGE.half_extents[2])
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.25, segments=64, ring_count=32, location=place)
    bpy.ops.object.shade_smooth()
    bpy.context.object.name = "Lounge Pot"
    bpy.context.object.data.materials.append(steel)
    bpy.data.objects.remove(scene.camera)
    add_camera(LOUNGE.world(-1.9, -1.6, 0.5), LOUNGE.world(2.4, 0.5, -0.35), 20.0, 480, 270)
    return scene


def _matt(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    return principled(name, Base_Color=(*color, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)


def _floor(roughness: float | None) -> bpy.types.Material:
    floor = principled("Tiles", Base_Color=(0.18, 0.16, 0.14, 1.0), Roughness=roughness or 0.0)
    if roughness is None:
        nodes, links = floor.node_tree.nodes, floor.node_tree.links
        uv, bricks = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeTexBrick")
        for name, value in (("Color1", 0.04), ("Color2", 0.16), ("Mortar", 0.5)):
            bricks.inputs[name].default_value = (value, value, value, 1.0)
        bricks.inputs["Scale"].default_value = 2.0
        links.new(uv.outputs["UV"], bricks.inputs["Vector"])
        links.new(bricks.outputs["Color"], principled_node(floor).inputs["Roughness"])
    return floor


def _walls(
    name: str, room: Room, floor: bpy.types.Material, wall: tuple, accent: tuple, without: Container[str]
) -> None:
    plain, strong = _matt(f"{name} Wall", wall), _matt(f"{name} Accent", accent)
    for side, material in (("-X", plain), ("+X", plain), ("-Y", plain), ("+Y", strong), ("+Z", plain), ("-Z", floor)):
        if side not in without:
            add_wall(room, side, material).name = f"{name} {side}"


def _doorway(material: bpy.types.Material) -> None:
    """The wall between the rooms, of two pieces and a lintel."""
    _, wide, high = _HALF
    left, right, top = DOORWAY_Y - DOORWAY_HALF_WIDTH, DOORWAY_Y + DOORWAY_HALF_WIDTH, DOORWAY_HEIGHT - high
    for y_low, y_high, z_low in ((-wide, left, -high), (right, wide, -high), (left, right, top)):
        centre = (0.0, 0.5 * (y_low + y_high), 0.5 * (z_low + high))
        add_box(WHOLE, "Wall Between", centre, (0.5 * _WALL, 0.5 * (y_high - y_low), 0.5 * (high - z_low)), material)


def _furniture(name: str, room: Room, seat: tuple) -> None:
    bottom = -room.half_extents[2]
    cloth, wood = _matt(f"{name} Cloth", seat), _matt(f"{name} Wood", (0.25, 0.13, 0.06))
    white = _matt(f"{name} Paper", (0.8, 0.8, 0.8))
    add_box(room, f"{name} Seat", (0.3, 1.9, bottom + 0.22), (1.0, 0.42, 0.22), cloth)
    add_box(room, f"{name} Back", (0.3, 2.25, bottom + 0.6), (1.0, 0.12, 0.3), cloth)
    add_box(room, f"{name} Table", (0.3, 0.6, bottom + 0.4), (0.6, 0.35, 0.03), wood)
    for x, y in ((-0.25, 0.3), (0.85, 0.3), (-0.25, 0.9), (0.85, 0.9)):
        add_box(room, f"{name} Leg", (x, y, bottom + 0.19), (0.03, 0.03, 0.19), wood)
    for k in range(4):
        add_box(room, f"{name} Shelf", (-2.3, 0.8, bottom + 0.3 + 0.5 * k), (0.18, 0.8, 0.02), wood)
        add_box(room, f"{name} Books", (-2.3, 0.5 + 0.2 * k, bottom + 0.45 + 0.5 * k), (0.12, 0.3, 0.13), white)
    frame = principled(f"{name} Mirror", Base_Color=(0.95, 0.95, 0.95, 1.0), Metallic=1.0, Roughness=0.02)
    add_box(room, f"{name} Mirror", (2.48, 0.4, 0.15), (0.02, 0.6, 0.7), frame)


def _lamps(name: str, room: Room) -> None:
    for k, (x, y) in enumerate(((-0.9, -0.4), (1.1, 0.7))):
        light = bpy.data.lights.new(f"{name} Lamp", "AREA")
        light.size, light.energy = 0.5 + 0.2 * k, 55.0
        lamp = bpy.data.objects.new(f"{name} Lamp", light)
        lamp.matrix_world = room.matrix.copy()
        lamp.location = room.world(x, y, room.half_extents[2] - 0.04)
        bpy.context.scene.collection.objects.link(lamp)
