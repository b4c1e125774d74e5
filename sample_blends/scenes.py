"""The sample scenes, built from nothing. `build.py` saves them; tests and benchmarks use them directly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy
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

_WALLS = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")


def empty_scene() -> bpy.types.Scene:
    """A new file with one empty scene, rendering as Cycles renders linear radiance."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
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


def _emissive_checker(name: str, bright: tuple, dark: tuple) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    links.new(_checker(material, bright, dark, 1.0), emission.inputs["Color"])
    links.new(emission.outputs[0], output.inputs["Surface"])
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
    colors = {
        "+X": ((1.0, 0.25, 0.15), (0.3, 0.07, 0.05)),
        "-X": ((0.15, 0.8, 0.9), (0.05, 0.25, 0.3)),
        "+Y": ((0.2, 0.9, 0.25), (0.06, 0.3, 0.08)),
        "-Y": ((0.9, 0.3, 0.9), (0.3, 0.1, 0.3)),
        "+Z": ((1.0, 1.0, 0.9), (0.35, 0.35, 0.3)),
    }
    for side, (bright, dark) in colors.items():
        add_wall(room, side, _emissive_checker(f"Glow {side}", bright, dark))
    mirror = principled("Mirror", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0)
    add_wall(room, "-Z", mirror)
    add_camera(room.world(-4.2, -3.3, 0.0), room.world(1.2, 0.9, -2.0), 24.0, 480, 270)
    scene.cycles.samples = 16
    return scene
