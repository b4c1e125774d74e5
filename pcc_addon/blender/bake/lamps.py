"""Stand-ins for lamps in captures by an EEVEE that does not draw them: emissive shapes of the same radiance."""

from __future__ import annotations

import math
from contextlib import ExitStack

import bpy
from mathutils import Matrix, Vector

from ..overrides import temporary

_SEGMENTS = 48


def add_stand_ins(stack: ExitStack, scene: bpy.types.Scene, capture_point: Vector, clip_end: float) -> None:
    """Add a stand-in to `scene` for each lamp that a reflection ray would see, until `stack` closes.

    Radiances follow Blender's units (radiant watts; sun in watts per square metre), for a lamp whose colour is
    not made of nodes. A spot is seen at the strength that it has towards the capture point.
    """
    for lamp in [o for o in scene.objects if o.type == "LIGHT" and not o.hide_render and o.visible_glossy]:
        shape = _shape(lamp, capture_point, clip_end)
        if shape is None:
            continue
        vertices, faces, radiance = shape
        mesh = temporary(stack, bpy.data.meshes, bpy.data.meshes.new("pcc lamp"))
        mesh.from_pydata(vertices, [], faces)
        material = temporary(stack, bpy.data.materials, _emitter(lamp.data, radiance))
        mesh.materials.append(material)
        stand_in = temporary(stack, bpy.data.objects, bpy.data.objects.new("pcc lamp", mesh))
        stand_in.visible_shadow = False
        stand_in.visible_diffuse = False
        scene.collection.objects.link(stand_in)


def _emitter(light: bpy.types.Light, radiance: float) -> bpy.types.Material:
    material = bpy.data.materials.new("pcc lamp")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*light.color, 1.0)
    emission.inputs["Strength"].default_value = radiance
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def _shape(
    lamp: bpy.types.Object, capture_point: Vector, clip_end: float
) -> tuple[list[Vector], list[tuple[int, ...]], float] | None:
    """World-space vertices, faces and radiance of a lamp, or None where it has no size to be seen."""
    light, matrix = lamp.data, lamp.matrix_world
    strength = light.energy * 2.0**light.exposure
    to_capture = matrix.inverted_safe() @ capture_point
    if light.type == "AREA":
        if to_capture.z >= 0.0:  # an area lamp shines along its −Z only
            return None
        return _area(light, matrix, strength)
    if light.type in {"POINT", "SPOT"}:
        radius = light.shadow_soft_size
        if radius <= 0.0:
            return None
        radiance = strength / math.pi / (4.0 * math.pi * radius**2 if light.normalize else 1.0)
        if light.type == "SPOT":
            radiance *= _spot_share(light, to_capture)
        facing = (capture_point - matrix.translation).to_track_quat("Z", "Y").to_matrix().to_4x4()
        place = Matrix.Translation(matrix.translation) @ facing
        return [place @ p for p in _disc(radius)], [tuple(range(_SEGMENTS))], radiance
    if light.type == "SUN":
        half_angle = 0.5 * light.angle
        if half_angle <= 0.0:
            return None
        towards = (matrix.to_3x3() @ Vector((0.0, 0.0, 1.0))).normalized()
        distance = 0.99 * clip_end
        facing = (-towards).to_track_quat("Z", "Y").to_matrix().to_4x4()
        place = Matrix.Translation(capture_point + towards * distance) @ facing
        radiance = strength / (math.pi * math.sin(half_angle) ** 2 if light.normalize else 1.0)
        return [place @ p for p in _disc(distance * math.tan(half_angle))], [tuple(range(_SEGMENTS))], radiance
    return None


def _area(
    light: bpy.types.AreaLight, matrix: Matrix, strength: float
) -> tuple[list[Vector], list[tuple[int, ...]], float] | None:
    x = light.size
    y = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    if light.shape in {"SQUARE", "RECTANGLE"}:
        outline = [Vector((sx * x / 2, sy * y / 2, 0.0)) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        local_area = x * y
    else:
        outline = [Vector((p.x * x / 2, p.y * y / 2, 0.0)) for p in _disc(1.0)]
        local_area = math.pi * x * y / 4
    axes = matrix.to_3x3()
    area = local_area * axes.col[0].cross(axes.col[1]).length
    if area <= 0.0:
        return None
    return (
        [matrix @ p for p in outline],
        [tuple(range(len(outline)))],
        strength / math.pi / (area if light.normalize else 1.0),
    )


def _spot_share(light: bpy.types.SpotLight, to_capture: Vector) -> float:
    """How much of a spot's strength goes towards a point in its own space, 0 … 1 (smooth edge by `spot_blend`)."""
    if to_capture.length == 0.0:
        return 0.0
    cosine = -to_capture.normalized().z
    edge = math.cos(0.5 * light.spot_size)
    width = (1.0 - edge) * light.spot_blend
    if width <= 0.0:
        return float(cosine > edge)
    t = min(max((cosine - edge) / width, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def _disc(radius: float) -> list[Vector]:
    angles = (2.0 * math.pi * k / _SEGMENTS for k in range(_SEGMENTS))
    return [Vector((radius * math.cos(a), radius * math.sin(a), 0.0)) for a in angles]
