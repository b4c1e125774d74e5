"""What Blender makes of objects at a frame where their settings do not tell: caches, shapes that follow the time."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

from . import attributes
from .digests import unordered

_WITH_SHAPES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


class Shapes:
    """The evaluated shapes of a view layer and the instances that objects make; read when one is asked for."""

    def __init__(self, view_layer: bpy.types.ViewLayer) -> None:
        self._view_layer = view_layer
        self._found: dict[str, bytes] | None = None

    def of(self, item: bpy.types.Object) -> bytes | None:
        """A digest of the mesh and the instances of an object; None where viewports leave it out."""
        if item.name_full not in self._instances():
            return None
        shape = _shape(item.evaluated_get(self._view_layer.depsgraph)) if item.type in _WITH_SHAPES else b""
        return hashlib.blake2b(shape + self._instances()[item.name_full], digest_size=20).digest()

    def _instances(self) -> dict[str, bytes]:
        """By object what it makes instances of and where, or nothing; objects that are not evaluated are not there."""
        if self._found is None:
            self._found = {}
            for instance in self._view_layer.depsgraph.object_instances:
                name = instance.object.original.name_full
                if instance.is_instance:
                    parent = instance.parent.original.name_full
                    placed = np.array(instance.matrix_world, np.float32).tobytes() + instance.object.type.encode()
                    self._found[parent] = hashlib.blake2b(self._found.get(parent, b"") + placed).digest()
                else:
                    self._found.setdefault(name, b"")
        return self._found


def _shape(item: bpy.types.Object) -> bytes:
    """The attributes of an evaluated object's mesh, places of vertices and faces among them."""
    mesh = item.to_mesh()
    if mesh is None:
        return b""
    try:
        return unordered(layer.name.encode() + layer.digest for layer in attributes.of_mesh(mesh))
    finally:
        item.to_mesh_clear()
