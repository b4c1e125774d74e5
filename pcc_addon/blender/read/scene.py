"""What a scene shows: the objects that a render sees, and where their surfaces are."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from .. import marks


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


def missing_textures(view_layer: bpy.types.ViewLayer, world: bpy.types.World | None) -> list[str]:
    """A sentence for each image file that rendered materials or the world need and that is not there."""
    trees = {material.node_tree for _, material, _ in surfaces(view_layer) if material.node_tree}
    if world and world.node_tree:
        trees.add(world.node_tree)
    found = {}
    for image in sorted({i for tree in trees for i in _images(tree, set())}, key=lambda i: i.name_full):
        path = bpy.path.abspath(image.filepath, library=image.library)
        if image.source == "FILE" and not image.packed_file and not Path(path).is_file():
            found[image.name] = f"image '{image.name}': its file '{path}' is missing; relink it or pack it"
    return list(found.values())


def _images(tree: bpy.types.NodeTree, seen: set[str]) -> set[bpy.types.Image]:
    if tree.name_full in seen:
        return set()
    seen.add(tree.name_full)
    found = set()
    for node in tree.nodes:
        if marks.role(node):
            continue
        if getattr(node, "image", None):
            found.add(node.image)
        if getattr(node, "node_tree", None):
            found |= _images(node.node_tree, seen)
    return found


def _depsgraph(view_layer: bpy.types.ViewLayer) -> bpy.types.Depsgraph:
    view_layer.update()  # reading a depsgraph behind the data crashes Blender
    return view_layer.depsgraph
