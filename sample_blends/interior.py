"""A house at dusk whose windows are flat panes: one baked room behind all of them, a wing turned, an array of panes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector

from pcc_addon.blender.shade.interior import Window, room_of_probe, window_material
from pcc_addon.blender.windows import add_pane, put_on
from pcc_addon.core.effects.interior import Cells

from .scenes import Room, add_box, add_camera, add_wall, empty_scene, principled

# The room stands apart from the house, where no camera looks; its window is in its −Y wall.
ROOM = Room((2.0, 2.5, 1.5), (40.0, 30.0, 1.5), math.radians(35.0))
OPENING, SILL = (2.4, 1.7), 0.1  # of a window, metres: its width and height, and how far its middle is above the room's


@dataclass(frozen=True)
class Front:
    """A wall of the house with a window for each room behind it.

    Attributes:
        name: of its objects.
        columns, floors: of rooms.
        place: its lower left corner as one sees it from outside, world space, metres.
        turn: about the vertical, radians; 0 faces −Y.
        wall: how thick walls and floors between rooms are, metres.
    """

    name: str
    columns: int
    floors: int
    place: tuple[float, float, float]
    turn: float
    wall: float = 0.0

    @property
    def pitch(self) -> tuple[float, float]:
        """From room to room, along the wall and up, metres."""
        return 2.0 * ROOM.half_extents[0] + self.wall, 2.0 * ROOM.half_extents[2] + self.wall

    @property
    def matrix(self) -> Matrix:
        """To world space: x along the wall, −y outwards, the origin at the lower left corner."""
        return Matrix.Translation(self.place) @ Matrix.Rotation(self.turn, 4, "Z")

    def middle_of(self, column: int, floor: int) -> Vector:
        """The middle of a room's outer side, in the wall's own axes."""
        along, up = self.pitch
        return Vector(((column + 0.5) * along, 0.0, (floor + 0.5) * up))


MAIN = Front("Main", 4, 3, (-8.8, 4.0, 0.0), 0.0, 0.2)
WING = Front("Wing", 3, 3, (8.0, 4.0, 0.0), math.radians(-62.0))


def interior(resolution: int = 256, samples: int = 64) -> bpy.types.Scene:
    """The scene: rooms of the main front by UV map, those of the wing by size, and two panes by an array.

    The room is baked at once, as window materials show pictures; the arguments are those of its probe.
    """
    scene = empty_scene()
    dusk = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    dusk.inputs["Color"].default_value, dusk.inputs["Strength"].default_value = (0.25, 0.4, 0.8, 1.0), 0.5
    furnished_room()
    probe = bake_room(resolution, samples)
    before = set(scene.objects)
    layers = flat_picture("Table", table()), flat_picture("Curtains", curtains())
    width, depth, height = (2.0 * h for h in ROOM.half_extents)
    sizes = {"Width": width, "Depth": depth, "Height": height}
    variety = {"Mirrored": 0.5, "Lit": 0.75, "Strength": 1.0, "Dark Strength": 0.04, "Curtains": 0.4, "Middle": 0.5}
    variety |= {"Tint A": (1.0, 0.72, 0.45, 1.0), "Tint B": (0.85, 0.95, 1.0, 1.0)}
    rooms = Window((room_of_probe(probe),), middle=layers[0], curtains=layers[1])
    by_uv = window_material("Window", Window(rooms.rooms, Cells.UV, *layers), {**sizes, **variety, "Seed": 4.0})
    by_size = window_material("Window by Size", rooms, {**sizes, **variety, "Offset": (-0.5, -0.5, 0.0)})
    for front, material in ((MAIN, by_uv), (WING, by_size)):
        add_front(front)
        put_on(material, [add_panes(front)])
    _annex(window_material("Shop Window", rooms, {**sizes, **variety, "Lit": 1.0, "Curtains": 0.0}))
    ground = principled("Ground", Base_Color=(0.12, 0.12, 0.12, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    add_box(Room((1, 1, 1), (0.0, 0.0, 0.0), 0.0), "Ground", (0.0, 0.0, -0.1), (60.0, 60.0, 0.1), ground)
    # Windows come after the bake whose picture they show: what the room's probe never sees cannot make it stale.
    probe.pcc_probe.hidden_collection = collected("House", before)
    add_camera(Vector((2.0, -13.0, 1.7)), Vector((2.2, 3.0, 4.4)), 22.0, 640, 360)
    scene.cycles.samples = 64
    return scene


def bake_room(resolution: int, samples: int) -> bpy.types.Object:
    """The probe in the room, baked."""
    bpy.ops.pcc.probe_add(
        name="Room", location=ROOM.centre, rotation=(0.0, 0.0, ROOM.turn), half_extents=ROOM.half_extents
    )
    probe = bpy.context.object
    probe.pcc_probe.resolution, probe.pcc_probe.samples = resolution, samples
    bpy.ops.pcc.bake(scope="ALL")
    return probe


def furnished_room() -> bpy.types.Collection:
    """The room that is baked, in a collection of its own: five walls, a sixth with an opening, furniture, a lamp."""
    before = set(bpy.context.scene.objects)
    _walls()
    wood, cloth = _matt("Oak", (0.30, 0.16, 0.07)), _matt("Sofa", (0.06, 0.22, 0.26))
    paper, red = _matt("Paper", (0.7, 0.68, 0.6)), _matt("Print", (0.6, 0.07, 0.04))
    low = -ROOM.half_extents[2]
    for name, centre, half, material in (
        ("Sofa", (-0.4, 2.0, low + 0.22), (0.95, 0.42, 0.22), cloth),
        ("Sofa Back", (-0.4, 2.34, low + 0.6), (0.95, 0.12, 0.3), cloth),
        ("Shelf", (1.8, 0.6, low + 1.0), (0.2, 0.9, 1.0), wood),
        ("Books", (1.58, 0.3, low + 1.3), (0.03, 0.4, 0.14), paper),
        ("Books", (1.58, 0.9, low + 0.8), (0.03, 0.35, 0.14), red),
        ("Frame", (-0.4, 2.46, 0.35), (0.75, 0.03, 0.5), paper),
        ("Print", (-0.4, 2.44, 0.35), (0.6, 0.03, 0.36), red),
        ("Chest", (-1.75, -0.2, low + 0.4), (0.25, 0.6, 0.4), wood),
    ):
        add_box(ROOM, name, centre, half, material)
    light = bpy.data.lights.new("Ceiling Lamp", "AREA")
    light.size, light.energy = 0.7, 90.0
    lamp = bpy.data.objects.new("Ceiling Lamp", light)
    lamp.visible_camera = True  # as captures show it
    lamp.matrix_world = ROOM.matrix @ Matrix.Translation((0.0, 0.0, ROOM.half_extents[2] - 0.03))
    bpy.context.scene.collection.objects.link(lamp)
    return collected("Furnished Room", before)


def real_rooms(front: Front, room: bpy.types.Collection) -> list[bpy.types.Object]:
    """What path tracing sees: the room itself behind every window of a front, whose panes are hidden."""
    bpy.data.objects[f"{front.name} Panes"].hide_render = True
    copies = []
    back = Matrix.Translation((0.0, ROOM.half_extents[1], 0.0)) @ ROOM.matrix.inverted()
    for column in range(front.columns):
        for floor in range(front.floors):
            copy = bpy.data.objects.new(f"{front.name} Room", None)
            copy.instance_type, copy.instance_collection = "COLLECTION", room
            copy.matrix_world = front.matrix @ Matrix.Translation(front.middle_of(column, floor)) @ back
            bpy.context.scene.collection.objects.link(copy)
            copies.append(copy)
    return copies


def add_front(front: Front) -> bpy.types.Object:
    """The outer wall with its openings, 0.12 m thick, the panes' plane at its back."""
    half_x, half_z = OPENING[0] / 2.0, OPENING[1] / 2.0
    room_x, room_z = (length / 2.0 for length in front.pitch)
    points: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []

    def quad(*corners: tuple[float, float, float]) -> None:
        faces.append(tuple(range(len(points), len(points) + 4)))
        points.extend(corners)

    for column in range(front.columns):
        for floor in range(front.floors):
            x, _, z = front.middle_of(column, floor)
            xs = (x - room_x, x - half_x, x + half_x, x + room_x)
            zs = (z - room_z, z + SILL - half_z, z + SILL + half_z, z + room_z)
            for y in (-0.12, -1e-3):
                for i in range(3):
                    for k in range(3):
                        if (i, k) != (1, 1):
                            (x0, x1), (z0, z1) = xs[i : i + 2], zs[k : k + 2]
                            quad((x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1))
            ring = [(xs[1], zs[1]), (xs[2], zs[1]), (xs[2], zs[2]), (xs[1], zs[2])]
            for (x0, z0), (x1, z1) in zip(ring, ring[1:] + ring[:1], strict=True):
                quad((x0, -0.12, z0), (x1, -0.12, z1), (x1, 0.0, z1), (x0, 0.0, z0))
    return _mesh(f"{front.name} Front", points, faces, front.matrix, _matt("Render", (0.45, 0.42, 0.38)))


def add_panes(front: Front) -> bpy.types.Object:
    """All panes of a front in one mesh, with UVs in rooms."""
    half_x, half_z = OPENING[0] / 2.0, OPENING[1] / 2.0
    points, faces, places = [], [], []
    width, height = 2.0 * ROOM.half_extents[0], 2.0 * ROOM.half_extents[2]
    for column in range(front.columns):
        for floor in range(front.floors):
            x, _, z = front.middle_of(column, floor) + Vector((0.0, 0.0, SILL))
            faces.append(tuple(range(len(points), len(points) + 4)))
            for i, k in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                points.append((x + i * half_x, 0.0, z + k * half_z))
                places.append((column + 0.5 + i * half_x / width, floor + 0.5 + (SILL + k * half_z) / height))
    panes = _mesh(f"{front.name} Panes", points, faces, front.matrix, None)
    uv = panes.data.uv_layers.new(name="Rooms").uv
    for corner, place in zip(uv, places, strict=True):
        corner.vector = place
    return panes


def _annex(material: bpy.types.Material) -> None:
    """One pane repeated by an array: cells follow the object's own axes."""
    kiosk = Room((4.2, 1.0, 1.6), (-7.0, -1.2, 1.6), math.radians(30.0))
    add_box(kiosk, "Annex", (0.0, 0.0, 0.0), kiosk.half_extents, _matt("Annex", (0.2, 0.2, 0.22)))
    place = kiosk.matrix @ Matrix.Translation((-2.0, -1.05, -0.1))
    pane = add_pane(bpy.context.scene.collection, "Annex Panes", place, 3.6, 2.6)
    array = pane.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_constant_offset = 2, False, True
    array.constant_offset_displace = (4.0, 0.0, 0.0)
    put_on(material, [pane])


def table() -> np.ndarray:
    """(256, 256, 4): a table with two chairs and a hanging lamp, seen from the front, over nothing."""
    picture = np.zeros((256, 256, 4), np.float32)
    wood, shade = (0.16, 0.08, 0.035, 1.0), (0.9, 0.75, 0.5, 1.0)
    for (x0, x1, y0, y1), color in (
        ((80, 180, 62, 68), wood),
        *(((x, x + 5, 0, 62), wood) for x in (84, 171)),
        *(((x, x + 4, 0, height), wood) for x, height in ((56, 84), (70, 42), (186, 42), (200, 84))),
        *(((x, x + 18, 38, 42), wood) for x in (56, 186)),
        ((128, 130, 150, 256), wood),
        ((112, 146, 138, 152), shade),
    ):
        picture[y0:y1, x0:x1] = color
    return picture


def curtains() -> np.ndarray:
    """(256, 256, 4): drawn to both sides, in folds, half transparent."""
    x = np.linspace(-1.0, 1.0, 256, dtype=np.float32)
    folds = 0.75 + 0.25 * np.sin(np.abs(x) * 55.0)
    picture = np.zeros((256, 256, 4), np.float32)
    picture[..., :3] = folds[None, :, None] * np.array((0.8, 0.72, 0.6), np.float32)
    picture[..., 3] = np.where(np.abs(x) > 0.33, 0.9, 0.0)[None, :]
    return picture


def flat_picture(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """A picture of 8 bits with alpha, packed; `pixels` are linear."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True)
    shown = pixels.copy()
    light = pixels[..., :3]
    shown[..., :3] = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1.0 / 2.4) - 0.055)  # sRGB
    image.pixels.foreach_set(shown.ravel())
    image.update()
    image.pack()
    return image


def _walls() -> None:
    colors = {"-X": (0.62, 0.58, 0.5), "+X": (0.62, 0.58, 0.5), "+Y": (0.25, 0.38, 0.33), "+Z": (0.75, 0.75, 0.72)}
    for side, color in (*colors.items(), ("-Z", (0.28, 0.17, 0.09))):
        add_wall(ROOM, side, _matt(f"Wall {side}", color))
    half_x, half_z = OPENING[0] / 2.0, OPENING[1] / 2.0
    x, y, z = ROOM.half_extents
    plaster = _matt("Wall -Y", (0.62, 0.58, 0.5))
    for x0, x1, z0, z1 in (
        (-x, -half_x, -z, z),
        (half_x, x, -z, z),
        (-half_x, half_x, -z, SILL - half_z),
        (-half_x, half_x, SILL + half_z, z),
    ):
        corners = [(x0, -y, z0), (x0, -y, z1), (x1, -y, z1), (x1, -y, z0)]
        _mesh("Wall -Y", corners, [(0, 1, 2, 3)], ROOM.matrix, plaster)


def _matt(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    return principled(name, Base_Color=(*color, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)


def _mesh(
    name: str, points: list, faces: list, matrix: Matrix, material: bpy.types.Material | None
) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    if material is not None:
        mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    item.matrix_world = matrix
    bpy.context.scene.collection.objects.link(item)
    return item


def collected(name: str, before: set[bpy.types.Object]) -> bpy.types.Collection:
    """A collection, in the scene, of all objects that were not there before."""
    scene = bpy.context.scene
    collection = bpy.data.collections.new(name)
    scene.collection.children.link(collection)
    for item in set(scene.objects) - before:
        scene.collection.objects.unlink(item)
        collection.objects.link(item)
    return collection
