"""What a scene shows: the objects that a render sees, and where their surfaces are."""

from __future__ import annotations

import bpy
import numpy as np


def rendered_objects(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> list[bpy.types.Object]:
    """The objects of a scene, and those that its instances bring in, by name; probes and cameras not excepted."""
    found = {item.name_full: item for item in scene.objects}
    for instance in _depsgraph(view_layer).object_instances:
        original = instance.object.original
        found.setdefault(original.name_full, original)
    return [found[name] for name in sorted(found)]


def surfaces(
    view_layer: bpy.types.ViewLayer,
) -> list[tuple[bpy.types.Object, bpy.types.Material, np.ndarray]]:
    """Every (object, material, world-space corners (8, 3)) that a render shows, instances included."""
    found = []
    for instance in _depsgraph(view_layer).object_instances:
        evaluated = instance.object
        if evaluated.type not in {"MESH", "CURVE", "SURFACE", "META", "FONT"} or evaluated.hide_render:
            continue
        matrix = np.array(instance.matrix_world, np.float64)
        corners = np.array(evaluated.bound_box, np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        original = evaluated.original
        materials = {slot.material for slot in original.material_slots if slot.material}
        found += [(original, material, corners) for material in sorted(materials, key=lambda m: m.name_full)]
    return found


def _depsgraph(view_layer: bpy.types.ViewLayer) -> bpy.types.Depsgraph:
    view_layer.update()  # reading a depsgraph behind the data crashes Blender
    return view_layer.depsgraph
