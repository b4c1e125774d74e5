"""A room painted with a marked cubemap, and a mirror ball in it: what a probe with that picture must show."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

from .scenes import Room, add_camera, add_room_probe, emissive, empty_scene, principled

ROOM = Room((4.0, 2.5, 1.5), (17.0, -9.0, 3.0), math.radians(30.0))
PICTURE = Path(__file__).resolve().parent / "any_cubemap.png"  # a horizontal cross, 8 bits
SQUARES = 8  # of a face, along an edge

# Of each face of an engine's cubemap, its axes in Blender's space as seen from inside, and the colours of its squares.
_FACES = {
    "px": ((1, 0, 0), (0, -1, 0), (0, 0, 1), (0.95, 0.55, 0.45), (0.55, 0.12, 0.08)),
    "nx": ((-1, 0, 0), (0, 1, 0), (0, 0, 1), (0.45, 0.90, 0.95), (0.08, 0.40, 0.50)),
    "py": ((0, 0, 1), (1, 0, 0), (0, -1, 0), (1.00, 1.00, 0.95), (0.70, 0.70, 0.62)),
    "ny": ((0, 0, -1), (1, 0, 0), (0, 1, 0), (0.55, 0.45, 0.35), (0.25, 0.18, 0.12)),
    "pz": ((0, 1, 0), (1, 0, 0), (0, 0, 1), (0.55, 0.95, 0.50), (0.12, 0.45, 0.15)),
    "nz": ((0, -1, 0), (-1, 0, 0), (0, 0, 1), (0.95, 0.60, 0.95), (0.45, 0.12, 0.45)),
}
_CROSS = (".", "py", ".", "."), ("nx", "pz", "px", "nz"), (".", "ny", ".", ".")
# A letter that has no symmetry, in squares from the top left; it stands on the upper left quarter of each face.
_LETTER = ("XXX", "X..", "XX.", "X..")


def face(name: str, n: int) -> np.ndarray:
    """A marked face (n, n, 3) uint8, sRGB, the first row at the top: a chequer, a letter, a dot a face further."""
    *_, bright, dark = _FACES[name]
    t, s = np.mgrid[0:SQUARES, 0:SQUARES]
    squares = np.where(((s + t) % 2 == 0)[..., None], bright, dark)
    for row, line in enumerate(_LETTER):
        for column, mark in enumerate(line):
            if mark == "X":
                squares[row + 1, column + 1] = 0.02
    for dot in range(list(_FACES).index(name) + 1):
        squares[6, 1 + dot] = (1.0, 0.9, 0.1)
    return np.kron((squares * 255.0 + 0.5).astype(np.uint8), np.ones((n // SQUARES, n // SQUARES, 1), np.uint8))


def cross(n: int) -> np.ndarray:
    """The marked cubemap as a horizontal cross (3n, 4n, 3) uint8, the first row at the top."""
    blank = np.zeros((n, n, 3), np.uint8)
    return np.concatenate([np.concatenate([blank if f == "." else face(f, n) for f in row], 1) for row in _CROSS])


def image_of(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """An image of 8 bits from (h, w, 3) uint8, the first row at the top."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height)
    whole = np.ones((height, width, 4), np.float32)
    whole[..., :3] = pixels[::-1] / np.float32(255.0)
    image.pixels.foreach_set(whole.ravel())
    return image


def write_cross(path: Path, n: int) -> None:
    """Write the marked cubemap as a PNG."""
    image = image_of("cross", cross(n))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)


def mirror_ball(room: Room = ROOM, tilt: Euler | None = None, segments: int = 128) -> bpy.types.Scene:
    """A mirror ball in nothing, a camera, and a probe "Room" whose box is the room; turned further by `tilt`."""
    scene = empty_scene()
    mirror = principled("Mirror", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=0.9)
    ball = bpy.context.object
    ball.name, ball.location = "Ball", room.world(0.6, 0.3, -0.2)
    ball.data.materials.append(mirror)
    ball.data.shade_smooth()
    add_camera(room.world(-2.4, -1.4, -0.3), Vector(ball.location), 30.0, 240, 135)
    scene.cycles.samples = 16
    scene.view_settings.view_transform = "Standard"
    probe = add_room_probe(room)
    if tilt is not None:
        probe.rotation_euler = (tilt.to_matrix() @ probe.rotation_euler.to_matrix()).to_euler()
    bpy.context.view_layer.update()
    return scene


def paint_walls(matrix: Matrix, n: int) -> None:
    """Six walls around the image of [−1, 1]³, each glowing with the face of the marked cubemap that it stands for."""
    for name, (forward, right, up, *_) in _FACES.items():
        out, across, along = (Vector(v) for v in (forward, right, up))
        mesh = bpy.data.meshes.new(f"Wall {name}")
        corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        mesh.from_pydata([matrix @ (out + across * u + along * v) for u, v in corners], [], [(0, 1, 2, 3)])
        uv = mesh.uv_layers.new(name="Face").uv
        for k, (u, v) in enumerate(corners):
            uv[k].vector = ((u + 1) / 2, (v + 1) / 2)
        material, emission = emissive(f"Face {name}")
        texture = material.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image, texture.extension = image_of(f"Face {name}", face(name, n)), "EXTEND"
        texture.image.pack()
        material.node_tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
        mesh.materials.append(material)
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(f"Wall {name}", mesh))


def chequered_sky(scene: bpy.types.Scene) -> None:
    """Give a scene a world of colours that differ in every direction, with squares."""
    tree = scene.world.node_tree
    place, chequer = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexChecker")
    shift, product = tree.nodes.new("ShaderNodeVectorMath"), tree.nodes.new("ShaderNodeVectorMath")
    background = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Strength"].default_value = 1.0
    chequer.inputs["Scale"].default_value = 5.0
    shift.operation, product.operation = "MULTIPLY_ADD", "MULTIPLY"
    shift.inputs[1].default_value = shift.inputs[2].default_value = (0.5, 0.5, 0.5)
    for source, target in (
        (place.outputs["Generated"], chequer.inputs["Vector"]),
        (place.outputs["Generated"], shift.inputs[0]),
        (shift.outputs[0], product.inputs[0]),
        (chequer.outputs["Color"], product.inputs[1]),
        (product.outputs[0], background.inputs["Color"]),
    ):
        tree.links.new(source, target)


def any_cubemap() -> bpy.types.Scene:
    """The sample: no walls at all; the ball shows the picture beside the file as if it were painted on some."""
    scene = mirror_ball(segments=48)
    settings = bpy.data.objects["Room"].pcc_probe
    settings.source, settings.picture, settings.resolution = "IMAGE", f"//{PICTURE.name}", 128
    return scene
