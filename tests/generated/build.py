"""Drawn scenes made in Blender."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix, Vector

from pcc_addon.blender import marks
from sample_blends.scenes import emissive, empty_scene, principled, principled_node

from .scenes import ANY, GLOWS, NONE, OPEN, Drawn, Kind, Paint, Room, Shape, Stand, Thing, View

SIZE = 24
"""Pixels along a side of the picture."""
FRAMES = (1, 11)
"""What moves, moves from the first to the last."""
_HUES = [(1.0, 0.2, 0.1), (0.1, 0.9, 0.3), (0.2, 0.3, 1.0), (0.9, 0.8, 0.1), (0.8, 0.1, 0.9), (0.9, 0.9, 0.9)]
_FACES = [(0, 1, 3, 2), (0, 4, 5, 1), (0, 2, 6, 4), (4, 6, 7, 5), (2, 3, 7, 6), (1, 5, 7, 3)]  # as a room's walls


def build(drawn: Drawn) -> bpy.types.Scene:
    """A new file with the scene, its probes not baked."""
    scene = _cleared()
    scene.cycles.seed, scene.cycles.samples, scene.cycles.max_bounces = 7, drawn.samples, 4
    scene.frame_start, scene.frame_end = FRAMES
    scene.pcc.roughness_limit = drawn.roughness_limit
    materials = [_painted(f"Paint {k}", paint) for k, paint in enumerate(drawn.paints)]
    things = [_add_thing(f"Thing {k}", thing, drawn, materials) for k, thing in enumerate(drawn.things)]
    for k, room in enumerate(drawn.rooms):
        _add_walls(k, room, materials)
        _add_probe(k, room, drawn, things)
    _choose(drawn, things, materials)
    _add_camera(drawn.view, drawn)
    bpy.context.view_layer.update()
    return scene


def _cleared() -> bpy.types.Scene:
    """An empty scene; of the file before only the groups of formulas are kept, which take longest to build."""
    kept = {tree for tree in bpy.data.node_groups if (marks.role(tree) or "").startswith(_FORMULA)}
    if not kept:
        return empty_scene()
    for tree in kept:
        tree.use_fake_user = True
    scene = bpy.context.scene
    everything = (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.cameras, bpy.data.images)
    others = (bpy.data.actions, bpy.data.collections, [t for t in bpy.data.node_groups if t not in kept])
    bpy.data.batch_remove([item for each in (*everything, *others) for item in each])
    scene.frame_set(FRAMES[0])
    return scene


_FORMULA = "formula: "  # how the roles of these groups begin


def probes() -> list[bpy.types.Object]:
    """The probes of the scene."""
    return [item for item in bpy.context.scene.objects if item.pcc_probe.is_probe]


def _painted(name: str, paint: Paint) -> bpy.types.Material:
    material = principled(name)
    nodes, links, kind = material.node_tree.nodes, material.node_tree.links, paint.kind
    node = principled_node(material)
    other = {Kind.GLASS: "Glass", Kind.GLOSSY: "Anisotropic", Kind.METALLIC: "Metallic"}.get(kind)
    if other:
        output = next(n for n in nodes if n.bl_idname == "ShaderNodeOutputMaterial")
        nodes.remove(node)
        node = nodes.new(f"ShaderNodeBsdf{other}")
        links.new(node.outputs[0], output.inputs["Surface"])
        if kind is Kind.METALLIC:
            node.fresnel_type = "F82"
    node.inputs["Base Color" if "Base Color" in node.inputs else "Color"].default_value = (*paint.color, 1.0)
    for socket, value in _VALUES.get(kind, {}).items():
        node.inputs[socket].default_value = value
    node.inputs["Roughness"].default_value = paint.roughness
    noise = nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 3.0
    if paint.varied:
        links.new(noise.outputs["Fac"], node.inputs["Roughness"])
    if kind is Kind.SPOTTED:
        checker = nodes.new("ShaderNodeTexChecker")
        checker.inputs["Scale"].default_value = 3.0
        links.new(checker.outputs["Fac"], node.inputs["Metallic"])
    if paint.bumpy:
        bump = nodes.new("ShaderNodeBump")
        bump.inputs["Strength"].default_value = 0.5
        links.new(noise.outputs["Fac"], bump.inputs["Height"])
        links.new(bump.outputs["Normal"], node.inputs["Normal"])
    return material


_TINT = (1.0, 0.6, 0.3, 1.0)
_VALUES: dict[Kind, dict[str, object]] = {
    Kind.METAL: {"Metallic": 1.0},
    Kind.MIXED: {"Metallic": 0.4},
    Kind.TINTED: {"Specular Tint": _TINT, "Specular IOR Level": 0.8},
    Kind.TINTED_METAL: {"Metallic": 1.0, "Specular Tint": _TINT},
    Kind.COATED: {"Coat Weight": 0.7},
    Kind.CLEAR: {"Transmission Weight": 0.8},
    Kind.FILM: {"Thin Film Thickness": 400.0},
    Kind.METAL_FILM: {"Metallic": 1.0, "Thin Film Thickness": 400.0},
    Kind.BRUSHED: {"Metallic": 1.0, "Anisotropic": 0.6},
}


def _glow(name: str, hue: tuple[float, float, float]) -> bpy.types.Material:
    material, emission = emissive(name)
    checker = material.node_tree.nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 3.0
    checker.inputs["Color1"].default_value = (*hue, 1.0)
    checker.inputs["Color2"].default_value = (*(0.3 * c for c in hue), 1.0)
    material.node_tree.links.new(checker.outputs["Color"], emission.inputs["Color"])
    return material


def _add_mesh(name: str, corners: np.ndarray, faces: list, material: bpy.types.Material) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners.tolist(), [], faces)
    mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    return item


_CUBE = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0


def _add_walls(number: int, room: Room, materials: list[bpy.types.Material]) -> None:
    for k, (wall, face) in enumerate(zip(room.walls, _FACES, strict=True)):
        if wall != OPEN:
            name = f"Wall {number}.{k}"
            material = _glow(name, _HUES[(k + number) % 6]) if wall == GLOWS else materials[wall]
            corners = (np.c_[_CUBE[list(face)], np.ones(4)] @ room.matrix.T)[:, :3] - room.centre
            _add_mesh(name, corners, [(0, 1, 2, 3)], material).location = room.centre


def _add_probe(number: int, room: Room, drawn: Drawn, things: list[bpy.types.Object]) -> None:
    probe = bpy.data.objects.new(f"Probe {number}", None)
    probe.empty_display_type = "CUBE"
    bpy.context.scene.collection.objects.link(probe)
    if room.shear:
        parent = bpy.data.objects.new(f"Parent {number}", None)
        parent.matrix_basis = Matrix(room.parent.tolist())
        bpy.context.scene.collection.objects.link(parent)
        probe.parent = parent
    turn = room.turn
    probe.location, probe.rotation_euler, probe.scale = room.local[:3, 3], turn, room.half
    settings = probe.pcc_probe
    settings.is_probe = True
    settings.resolution, settings.samples, settings.denoise = drawn.resolution, 1, False
    settings.capture_offset = [c * h for c, h in zip(room.capture, room.half, strict=True)]
    settings.padding, settings.falloff, settings.normal_fade = room.padding, room.falloff, room.normal_fade
    settings.influence_low, settings.influence_high = room.low, room.high
    if room.falloff_high is not None:
        settings.falloff_per_face, settings.falloff_high = True, room.falloff_high
        settings.falloff_low = (room.falloff,) * 3
    settings.weight, settings.priority, settings.outside = room.weight, room.priority, room.outside
    settings.contact_hardening, settings.correction = room.hardening, "BOX" if room.corrected else "NONE"
    if room.excludes:
        settings.excluded = bpy.data.collections.new(f"Not in {number}")
        settings.excluded.objects.link(things[0])
    if room.moves:
        _move(probe, Vector((0.6, 0.3, 0.2)), turn=0.4)


def _choose(drawn: Drawn, things: list[bpy.types.Object], materials: list[bpy.types.Material]) -> None:
    """Which probes paints and things show."""
    for material, room in zip(materials, drawn.chosen, strict=True):
        if room == NONE:
            material.pcc.show_probes = False
        elif room != ANY:
            material.pcc.probe = bpy.data.objects[f"Probe {room}"]
    for item, excluded in zip(things, drawn.excluded, strict=True):
        item.pcc.show_probes = not excluded


def _add_thing(name: str, thing: Thing, drawn: Drawn, materials: list[bpy.types.Material]) -> bpy.types.Object:
    room = drawn.rooms[thing.room]
    if thing.shape is Shape.BALL:
        bpy.ops.mesh.primitive_uv_sphere_add(radius=1.0, segments=16, ring_count=8)
        item = bpy.context.object
        bpy.ops.object.shade_smooth()
        item.name = name
        item.data.materials.append(materials[thing.paint])
    elif thing.shape is Shape.BOX:
        item = _add_mesh(name, _CUBE, _FACES, materials[thing.paint])
    else:
        corners = _CUBE[list(_FACES[2])] * (1.0, 1.0, 0.0)
        item = _add_mesh(name, corners, [(0, 1, 2, 3)], materials[thing.paint])
    item.scale = (thing.size,) * 3
    item.rotation_euler = (Matrix(_unscaled(room)).to_3x3() @ _matrix_of(thing.turn)).to_euler()
    item.location = room.world(_place(thing, room, item))
    if thing.moves:
        _move(item, Vector((0.5, 0.4, 0.3)))
    return item


def _place(thing: Thing, room: Room, item: bpy.types.Object) -> tuple[float, float, float]:
    """Where the middle of a thing is, in half extents of its room."""
    normals = np.linalg.inv(room.matrix[:3, :3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    width = 1.0 / np.linalg.norm(np.linalg.inv(room.matrix[:3, :3]), axis=1)[thing.axis]
    axes = np.array(item.rotation_euler.to_matrix()) * thing.size
    reach = np.abs(normals[thing.axis] @ axes[:, : 2 if thing.shape is Shape.PLANE else 3]).sum()
    if thing.shape is Shape.BALL:
        reach = thing.size
    distance = {
        Stand.MIDDLE: 0.3 * (width - reach),
        Stand.TOUCHING: width - reach,
        Stand.THROUGH: width - 0.3 * reach,
        Stand.IN_PADDING: width - reach + room.padding,
        Stand.BEYOND: width + reach + 0.05,
    }[thing.stand]
    place = list(thing.aside)
    place.insert(thing.axis, thing.side * float(distance) / width)
    return tuple(place)


def _matrix_of(angles: tuple[float, float, float]) -> Matrix:
    from mathutils import Euler

    return Euler(angles).to_matrix()


def _unscaled(room: Room) -> list:
    matrix = room.local[:3, :3] / np.array(room.half)
    return matrix.tolist()


def _add_camera(view: View, drawn: Drawn) -> None:
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    place = Vector(drawn.rooms[view.room].world(view.place))
    target = Vector(drawn.rooms[view.target_room].world(view.target))
    way = target - place if (target - place).length > 0.1 else Vector((0.1, 1.0, -0.2))
    camera.matrix_world = Matrix.Translation(place) @ way.to_track_quat("-Z", "Y").to_matrix().to_4x4()
    camera.data.lens, camera.data.clip_start = 18.0, 0.01
    if view.parallel:
        camera.data.type, camera.data.ortho_scale = "ORTHO", 5.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    if view.moves:
        _move(camera, Vector((1.5, 0.5, 0.7)))


def _move(item: bpy.types.Object, way: Vector, turn: float = 0.0) -> None:
    item.keyframe_insert("location", frame=FRAMES[0])
    item.keyframe_insert("rotation_euler", frame=FRAMES[0])
    item.location = item.location + way
    item.rotation_euler[2] += turn
    item.keyframe_insert("location", frame=FRAMES[1])
    item.keyframe_insert("rotation_euler", frame=FRAMES[1])
    bpy.context.scene.frame_set(FRAMES[0])
