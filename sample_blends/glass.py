"""Things of glass in a marked room: a ball, an egg, a cube, a pane and a single surface such as water's."""

from __future__ import annotations

import math
from collections.abc import Callable

import bpy
from mathutils import Vector

from .scenes import Room, add_camera, add_wall, empty_scene, principled, principled_node

ROOM = Room((2.5, 2.0, 1.5), (40.0, -20.0, 1.5), 0.4)
PLACE = Vector(ROOM.centre) + Vector((-0.4, 0.3, -0.2))
COLORS = {
    "+X": (1.0, 0.3, 0.2),
    "-X": (0.2, 0.8, 0.9),
    "+Y": (0.3, 0.9, 0.3),
    "-Y": (0.9, 0.4, 0.9),
    "+Z": (1.0, 1.0, 1.0),
    "-Z": (0.8, 0.7, 0.3),
}
FACE, SIZE = 256, (240, 180)


def ball() -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, segments=96, ring_count=48, location=PLACE)
    bpy.ops.object.shade_smooth()


def egg() -> None:
    ball()
    bpy.context.object.scale = (0.6, 0.8, 1.1)


def cube() -> None:
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=PLACE, rotation=(0.0, 0.0, 0.3))


def pane() -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=PLACE, rotation=(0.0, 0.0, 0.5))
    bpy.context.object.scale = (1.4, 0.02, 1.4)


def surface() -> None:
    bpy.ops.mesh.primitive_plane_add(size=1.4, location=PLACE, rotation=(math.pi / 2.0, 0.0, 0.5))


THINGS: dict[str, Callable[[], None]] = {
    "ball": ball,
    "egg": egg,
    "cube": cube,
    "pane": pane,
    "single surface": surface,
}


def checkered(name: str, color: tuple) -> bpy.types.Material:
    """A glowing wall of one-metre squares in world space."""
    material = principled(name, Base_Color=(0, 0, 0, 1), Specular_IOR_Level=0.0, Emission_Strength=1.0)
    tree = material.node_tree
    squares, place = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeNewGeometry")
    squares.inputs["Color1"].default_value = (*color, 1.0)
    squares.inputs["Color2"].default_value = (*(0.3 * c for c in color), 1.0)
    squares.inputs["Scale"].default_value = 1.0
    tree.links.new(place.outputs["Position"], squares.inputs["Vector"])
    tree.links.new(squares.outputs["Color"], principled_node(material).inputs["Emission Color"])
    return material


def build(thing: str, ior: float, roughness: float) -> bpy.types.Object:
    """A new file: the room, its probe and camera, and the thing; returns the thing."""
    empty_scene()
    for side, color in COLORS.items():
        add_wall(ROOM, side, checkered(side, color))
    THINGS[thing]()
    item = bpy.context.object
    glass = principled("Glass", Base_Color=(0.95, 0.95, 1, 1), Roughness=roughness, Transmission_Weight=1.0, IOR=ior)
    item.data.materials.append(glass)
    bpy.ops.pcc.probe_add(name="Room", location=ROOM.centre, half_extents=ROOM.half_extents, rotation=(0.0, 0.0, 0.4))
    settings = bpy.data.objects["Room"].pcc_probe
    settings.resolution, settings.samples, settings.denoise = FACE, 4, False
    settings.hidden_objects.add().object = item
    add_camera(PLACE + Vector((1.6, -1.0, 0.4)), PLACE, 35.0, *SIZE)
    scene = bpy.context.scene
    scene.cycles.transmission_bounces = scene.cycles.max_bounces = 16
    scene.cycles.sample_clamp_indirect = 0.0
    scene.view_settings.view_transform = "Standard"
    return item


def glass() -> bpy.types.Scene:
    """The sample: a ball, an egg and a pane side by side, and a probe to bake that leaves them out."""
    build("ball", 1.5, 0.0).name = "Ball"
    material = bpy.data.materials["Glass"]
    settings = bpy.data.objects["Room"].pcc_probe
    for thing, place in (("egg", (0.9, 0.6, -0.1)), ("pane", (-1.35, 0.3, 0.0))):
        THINGS[thing]()
        item = bpy.context.object
        item.name, item.location = thing.title(), PLACE + Vector(place)
        item.data.materials.append(material)
        settings.hidden_objects.add().object = item
    bpy.data.objects.remove(bpy.context.scene.camera)
    add_camera(PLACE + Vector((1.3, -2.1, 0.5)), PLACE + Vector((-0.15, 0.4, -0.05)), 20.0, 480, 270)
    return bpy.context.scene
