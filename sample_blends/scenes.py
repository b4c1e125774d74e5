"""The sample scenes, built from nothing. `build.py` saves them; tests and benchmarks use them directly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector


@dataclass(frozen=True)
class Room:
    """A box room: half extents in metres, placed by its centre and a turn about z in radians."""

    half_extents: tuple[float, float, float]
    centre: tuple[float, float, float]
    turn: float

    @property
    def matrix(self) -> Matrix:
        """Room axes to world, without scale."""
        return Matrix.Translation(self.centre) @ Euler((0.0, 0.0, self.turn)).to_matrix().to_4x4()

    def world(self, x: float, y: float, z: float) -> Vector:
        """A point given in metres along the room's axes from its centre."""
        return self.matrix @ Vector((x, y, z))


EMISSIVE_ROOM = Room((5.0, 4.0, 2.0), (120.0, -75.0, 14.0), math.radians(30.0))
GALLERY = Room((6.0, 4.0, 1.75), (31.0, 12.0, 5.0), math.radians(-18.0))

# Radiance of the emissive room's bright and dark squares, of one metre, by wall.
EMISSIVE_COLORS = {
    "+X": ((1.0, 0.25, 0.15), (0.3, 0.07, 0.05)),
    "-X": ((0.15, 0.8, 0.9), (0.05, 0.25, 0.3)),
    "+Y": ((0.2, 0.9, 0.25), (0.06, 0.3, 0.08)),
    "-Y": ((0.9, 0.3, 0.9), (0.3, 0.1, 0.3)),
    "+Z": ((1.0, 1.0, 0.9), (0.35, 0.35, 0.3)),
}

_WALLS = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")


def empty_scene() -> bpy.types.Scene:
    """A new file with one empty scene, rendering as Cycles renders linear radiance."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)  # keeps add-ons as they are: five times as fast
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    world = bpy.data.worlds.new("World")
    scene.world = world
    if world.node_tree is None:
        world.use_nodes = True
    background = next(n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Strength"].default_value = 0.0
    return scene


def add_wall(room: Room, side: str, material: bpy.types.Material) -> bpy.types.Object:
    """One wall of a room, facing inwards, with UVs in metres from its lower left corner as seen from inside."""
    axis, sign = "XYZ".index(side[1]), 1.0 if side[0] == "+" else -1.0
    normal = Vector([0.0] * 3)
    normal[axis] = -sign
    up = Vector((0.0, 0.0, 1.0)) if axis != 2 else Vector((0.0, 1.0, 0.0))
    right = up.cross(normal)
    half = Vector(room.half_extents)
    centre = Vector([-n * h for n, h in zip(normal, half, strict=True)])
    reach_u, reach_v = abs(right.dot(half)), abs(up.dot(half))
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    mesh = bpy.data.meshes.new(f"Wall {side}")
    mesh.from_pydata([centre + right * (u * reach_u) + up * (v * reach_v) for u, v in corners], [], [(0, 1, 2, 3)])
    uv = mesh.uv_layers.new(name="Metres").uv
    for k, (u, v) in enumerate(corners):
        uv[k].vector = ((u + 1) * reach_u, (v + 1) * reach_v)
    mesh.materials.append(material)
    wall = bpy.data.objects.new(f"Wall {side}", mesh)
    wall.matrix_world = room.matrix
    bpy.context.scene.collection.objects.link(wall)
    return wall


def principled(name: str, **inputs: object) -> bpy.types.Material:
    """A material of one Principled BSDF with some inputs set; underscores stand for spaces."""
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    node = principled_node(material)
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ")].default_value = value
    return material


def principled_node(material: bpy.types.Material) -> bpy.types.Node:
    """The Principled BSDF of a material."""
    return next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")


def _checker(
    material: bpy.types.Material, bright: tuple, dark: tuple, squares_per_metre: float
) -> bpy.types.NodeSocket:
    nodes, links = material.node_tree.nodes, material.node_tree.links
    uv, checker = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeTexChecker")
    checker.inputs["Color1"].default_value = (*bright, 1.0)
    checker.inputs["Color2"].default_value = (*dark, 1.0)
    checker.inputs["Scale"].default_value = squares_per_metre
    links.new(uv.outputs["UV"], checker.inputs["Vector"])
    return checker.outputs["Color"]


def emissive(name: str) -> tuple[bpy.types.Material, bpy.types.Node]:
    """A material of one Emission node, and that node."""
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material, emission


def emissive_checker(name: str, bright: tuple, dark: tuple) -> bpy.types.Material:
    material, emission = emissive(name)
    material.node_tree.links.new(_checker(material, bright, dark, 1.0), emission.inputs["Color"])
    return material


def add_camera(location: Vector, target: Vector, lens: float, width: int, height: int) -> bpy.types.Object:
    """A camera that looks from `location` to `target` (world space, metres), made the scene's."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = lens
    camera.matrix_world = (
        Matrix.Translation(location) @ (target - location).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    )
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, height
    return camera


def emissive_room(room: Room = EMISSIVE_ROOM) -> bpy.types.Scene:
    """A room whose walls and ceiling only glow and whose floor is a mirror: a path tracer has no noise in it."""
    scene = empty_scene()
    for side, (bright, dark) in EMISSIVE_COLORS.items():
        add_wall(room, side, emissive_checker(f"Glow {side}", bright, dark))
    mirror = principled("Mirror", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0)
    add_wall(room, "-Z", mirror)
    add_camera(room.world(-4.2, -3.3, 0.0), room.world(1.2, 0.9, -2.0), 24.0, 480, 270)
    scene.cycles.samples = 16
    return scene


def add_room_probe(room: Room, capture_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> bpy.types.Object:
    """A probe called "Room" whose box is the room's walls; the offset of its capture point in metres."""
    bpy.ops.pcc.probe_add(
        name="Room",
        location=room.centre,
        rotation=(0.0, 0.0, room.turn),
        half_extents=room.half_extents,
        capture_offset=capture_offset,
    )
    return bpy.context.object


def add_probe_around(scene: bpy.types.Scene) -> bpy.types.Object:
    """A probe called "Room" whose box is that of all meshes of a scene, along the world's axes."""
    items = [item for item in scene.objects if item.type == "MESH"]
    corners = np.array([item.matrix_world @ Vector(corner) for item in items for corner in item.bound_box])
    low, high = corners.min(0), corners.max(0)
    bpy.ops.pcc.probe_add(name="Room", location=(low + high) / 2.0, half_extents=(high - low) / 2.0)
    return bpy.context.object


def gallery(room: Room = GALLERY) -> bpy.types.Scene:
    """A turned exhibition room with lamps, pictures and pedestals over a polished floor, and a probe to bake."""
    scene = empty_scene()
    plaster = principled("Plaster", Base_Color=(0.78, 0.76, 0.72, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    ceiling = principled("Ceiling", Base_Color=(0.85, 0.85, 0.85, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    accent = principled("Accent Wall", Base_Color=(0.05, 0.2, 0.3, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    floor = principled("Polished Stone", Roughness=0.04, IOR=1.6, Specular_IOR_Level=0.5)
    stone = _checker(floor, (0.10, 0.095, 0.09), (0.035, 0.033, 0.03), 1.0)
    floor.node_tree.links.new(stone, principled_node(floor).inputs["Base Color"])
    for side in ("-X", "+Y", "-Y"):
        add_wall(room, side, plaster)
    add_wall(room, "+X", accent)
    add_wall(room, "+Z", ceiling)
    add_wall(room, "-Z", floor)
    _hang_pictures(room)
    _stand_pedestals(room)
    for x in (-3.5, 0.0, 3.5):
        _add_panel_lamp(room, x)
    add_camera(room.world(-5.4, -3.3, -0.25), room.world(2.2, 1.2, -0.75), 21.0, 560, 315)
    probe = bpy.data.objects.new("Gallery Probe", None)
    probe.empty_display_type = "CUBE"
    probe.matrix_world = room.matrix @ Matrix.Diagonal((*room.half_extents, 1.0))
    probe.pcc_probe.is_probe = True
    scene.collection.objects.link(probe)
    scene.cycles.samples = 64
    scene.cycles.max_bounces = 6
    return scene


def add_box(
    room: Room,
    name: str,
    centre: tuple[float, float, float],
    half: tuple[float, float, float],
    material: bpy.types.Material,
) -> bpy.types.Object:
    """A box along the room's axes; centre and half extents in metres."""
    mesh = bpy.data.meshes.new(name)
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata([tuple(c * h for c, h in zip(corner, half, strict=True)) for corner in corners], [], faces)
    mesh.materials.append(material)
    box = bpy.data.objects.new(name, mesh)
    box.matrix_world = room.matrix @ Matrix.Translation(centre)
    bpy.context.scene.collection.objects.link(box)
    return box


def _hang_pictures(room: Room) -> None:
    half_x, half_y, _ = room.half_extents
    frame = principled("Frame", Base_Color=(0.02, 0.02, 0.02, 1.0), Roughness=0.7, Specular_IOR_Level=0.0)
    hues = [(0.85, 0.12, 0.06), (0.95, 0.6, 0.05), (0.1, 0.45, 0.12), (0.08, 0.2, 0.7), (0.6, 0.1, 0.5)]
    places = [((-3.6, half_y, 0.1), 1), ((-0.6, half_y, 0.1), 1), ((2.8, half_y, 0.1), 1)]
    places += [((half_x, -1.8, 0.1), 0), ((half_x, 1.6, 0.1), 0)]
    for k, ((centre, axis), hue) in enumerate(zip(places, hues, strict=True)):
        paint = principled(f"Canvas {k + 1}", Base_Color=(*hue, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
        pale = principled(
            f"Canvas {k + 1} Light",
            Base_Color=(*(0.5 + 0.5 * c for c in hue), 1.0),
            Roughness=0.9,
            Specular_IOR_Level=0.0,
        )
        for inset, material, depth, size in ((0, frame, 0.03, 0.8), (1, paint, 0.035, 0.72), (2, pale, 0.04, 0.3)):
            half = [size * (1.0 + 0.25 * (k % 2)), size * (1.0 + 0.25 * (k % 2)), size]
            half[axis] = depth
            shifted = list(centre)
            shifted[1 - axis] += 0.25 * (inset == 2)
            shifted[2] -= 0.2 * (inset == 2)
            add_box(room, f"Picture {k + 1}.{inset}", tuple(shifted), tuple(half), material)


def _stand_pedestals(room: Room) -> None:
    white = principled("Pedestal", Base_Color=(0.7, 0.7, 0.68, 1.0), Roughness=0.8, Specular_IOR_Level=0.0)
    floor_z = -room.half_extents[2]
    exhibits = [
        ("Red Sphere", (1.2, 2.1), (0.8, 0.05, 0.03, 1.0)),
        ("Yellow Sphere", (3.6, 0.4), (0.9, 0.65, 0.05, 1.0)),
        ("Blue Sphere", (4.2, -2.2), (0.05, 0.15, 0.75, 1.0)),
    ]
    for name, (x, y), color in exhibits:
        add_box(room, f"Pedestal of {name}", (x, y, floor_z + 0.4), (0.25, 0.25, 0.4), white)
        material = principled(name, Base_Color=color, Roughness=0.3)
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.32)
        sphere = bpy.context.object
        sphere.name = name
        sphere.matrix_world = room.matrix @ Matrix.Translation((x, y, floor_z + 0.8 + 0.32))
        sphere.data.materials.append(material)
        sphere.data.shade_smooth()


def _add_panel_lamp(room: Room, x: float) -> None:
    light = bpy.data.lights.new("Panel", "AREA")
    light.shape = "RECTANGLE"
    light.size, light.size_y = 1.8, 0.35
    light.energy = 260.0
    lamp = bpy.data.objects.new("Panel", light)
    lamp.matrix_world = room.matrix @ Matrix.Translation((x, 0.0, room.half_extents[2] - 0.05))
    bpy.context.scene.collection.objects.link(lamp)
