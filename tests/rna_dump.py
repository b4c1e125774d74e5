"""A complete, comparable picture of Blender's data: every property of every data block that can be read."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import bpy

# Left out: what Blender changes by itself (evaluated copies, previews, storage), and the elements of meshes.
_VOLATILE = {
    "rna_type", "bl_rna", "original", "preview", "depsgraph", "execution_time", "is_evaluated", "session_uid",
    "tag", "users", "pixels", "storage_type", "vertices", "edges", "loops", "polygons", "loop_triangles",
    "corner_normals", "polygon_normals", "vertex_normals", "attributes", "color_attributes", "uv_layers",
}  # fmt: skip
_COLLECTIONS = (
    "scenes", "objects", "materials", "node_groups", "images", "cameras", "lights", "meshes", "worlds", "collections",
    "texts", "actions",
)  # fmt: skip


def dump(collections: Sequence[str] = _COLLECTIONS, without: Collection[bpy.types.ID] = ()) -> dict[str, str]:
    """Every readable property by its path, for all data blocks of the file: of some kinds, without some of them."""
    dumped = _Dump()
    for collection in collections:
        blocks = getattr(bpy.data, collection)
        dumped.lines[f"{collection}.names"] = repr([b.name_full for b in blocks if b.name != "Render Result"])
        for block in blocks:
            if block.name != "Render Result" and block not in without:
                dumped.struct(f"{collection}['{block.name_full}']", block, {block.as_pointer()})
    return dumped.lines


def difference(before: dict[str, str], after: dict[str, str]) -> list[str]:
    """The properties that differ, each with both values."""
    paths = sorted(before.keys() | after.keys())
    return [f"{p}: {before.get(p)} -> {after.get(p)}" for p in paths if before.get(p) != after.get(p)]


class _Dump:
    """The lines so far. Properties of types are asked for once: Blender is slow to list them, and add-ons add some."""

    def __init__(self) -> None:
        self.lines: dict[str, str] = {}
        self._properties: dict[type, list[tuple[str, str, bool]]] = {}

    def struct(self, path: str, struct: Any, above: set[int]) -> None:
        for key in _custom_properties(struct):
            value = struct[key]
            plain = value.to_dict() if hasattr(value, "to_dict") else value
            self.lines[f"{path}[{key!r}]"] = repr(plain.to_list() if hasattr(plain, "to_list") else plain)
        for name, kind, is_array in self._properties_of(struct):
            try:
                value = getattr(struct, name)
            except (AttributeError, RuntimeError):
                continue
            if kind == "COLLECTION":
                self._collection(f"{path}.{name}", value, above)
            elif kind == "POINTER":
                self._pointer(f"{path}.{name}", value, above)
            else:
                self.lines[f"{path}.{name}"] = repr(tuple(value)) if is_array else repr(value)

    def _properties_of(self, struct: Any) -> list[tuple[str, str, bool]]:
        """Identifier, type and whether it is an array, of each property that is not left out."""
        kind = type(struct)
        if kind not in self._properties:
            self._properties[kind] = [
                (p.identifier, p.type, getattr(p, "is_array", False))
                for p in struct.bl_rna.properties
                if p.identifier not in _VOLATILE
            ]
        return self._properties[kind]

    def _collection(self, path: str, items: Any, above: set[int]) -> None:
        for k, item in enumerate(items):
            if isinstance(item, bpy.types.ID):
                self.lines[f"{path}[{k}]"] = item.name_full
            elif item is not None and item.as_pointer() not in above:
                self.struct(f"{path}[{k}]", item, above | {item.as_pointer()})

    def _pointer(self, path: str, value: Any, above: set[int]) -> None:
        if isinstance(value, bpy.types.NodeTree) and value.is_embedded_data:
            self.struct(path, value, above | {value.as_pointer()})
        elif isinstance(value, bpy.types.ID):
            self.lines[path] = value.name_full
        elif isinstance(value, bpy.types.NodeSocket):  # links refer to what the nodes hold
            self.lines[path] = f"{value.node.name} {value.is_output} {value.identifier}"
        elif isinstance(value, bpy.types.Node):
            self.lines[path] = value.name
        elif value is not None and value.as_pointer() not in above:
            self.struct(path, value, above | {value.as_pointer()})
        else:
            self.lines[path] = str(value is None)


def _custom_properties(struct: Any) -> list[str]:
    try:
        return list(struct.keys())
    except (AttributeError, TypeError):  # a struct that cannot have any
        return []
