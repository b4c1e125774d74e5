"""What modifiers, shape keys, instances and simulations make of a scene at its frame, for what depends on that."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

from .. import marks
from .probes import is_animated, is_disabled

_WITH_SHAPES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}
_SIMULATED = {"FLUID", "CLOTH", "SOFT_BODY", "DYNAMIC_PAINT", "PARTICLE_SYSTEM", "OCEAN"}
_PLAYED = {"SEQUENCE", "MOVIE"}


def evaluated(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> dict[str, bytes]:
    """Digests by the objects' names that change when the shape of an object or its instances do.

    Objects whose state nobody can read without rendering have another digest at each frame. What has neither modifiers
    nor instances nor anything of that kind is left out.
    """
    found: dict[str, bytes] = {}
    frame = f"frame {scene.frame_current_final}".encode()
    view_layer.update()
    for instance in view_layer.depsgraph.object_instances:
        original = instance.object.original
        if instance.is_instance:
            parent = instance.parent.original.name_full
            placed = np.array(instance.matrix_world, np.float32).tobytes() + original.name_full.encode()
            found[parent] = hashlib.sha256(found.get(parent, b"") + placed).digest()
        elif original.type in _WITH_SHAPES and (original.modifiers or getattr(original.data, "shape_keys", None)):
            shape = hashlib.sha256(found.get(original.name_full, b"") + _shape(instance.object))
            found[original.name_full] = shape.digest()
    for item in scene.objects:
        if _is_unknown(item, view_layer):
            found[item.name_full] = found.get(item.name_full, b"") + frame
    return found


def plays_pictures(tree: bpy.types.NodeTree | None, seen: frozenset[str] = frozenset()) -> bool:
    """Whether a shader of the user's shows a film or a sequence of images, which may be another at each frame."""
    if tree is None or tree.name_full in seen:
        return False
    seen |= {tree.name_full}
    for node in tree.nodes:
        image, inner = getattr(node, "image", None), getattr(node, "node_tree", None)
        if marks.role(node) or (inner is not None and marks.role(inner)):
            continue
        if (image is not None and image.source in _PLAYED) or plays_pictures(inner, seen):
            return True
    return False


def _shape(item: bpy.types.Object) -> bytes:
    """Where the vertices of an evaluated object are, in its own axes, and how many faces join them."""
    mesh = item.to_mesh()
    if mesh is None:
        return b""
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", places)
    counts = f"{len(mesh.edges)} {len(mesh.polygons)}".encode()
    item.to_mesh_clear()
    return hashlib.sha256(counts + places.tobytes()).digest()


def _is_unknown(item: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> bool:
    """Whether what an object shows depends on the frame in a way that cannot be read."""
    if item.hide_render:
        return False
    return (
        (is_disabled(item, view_layer) and is_animated(item))
        or item.type in {"GREASEPENCIL", "GPENCIL"}
        or (item.type == "VOLUME" and item.data.is_sequence)
        or any(modifier.type in _SIMULATED for modifier in item.modifiers)
        or any(plays_pictures(slot.material.node_tree) for slot in item.material_slots if slot.material)
        or plays_pictures(getattr(item.data, "node_tree", None))
    )
