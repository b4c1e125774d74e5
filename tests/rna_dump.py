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
    lines: dict[str, str] = {}
    for collection in collections:
        blocks = getattr(bpy.data, collection)
        lines[f"{collection}.names"] = repr([b.name_full for b in blocks if b.name != "Render Result"])
        for block in blocks:
            if block.name != "Render Result" and block not in without:
                _struct(f"{collection}['{block.name_full}']", block, lines, {block.as_pointer()})
    return lines


def difference(before: dict[str, str], after: dict[str, str]) -> list[str]:
    """The properties that differ, each with both values."""
    paths = sorted(before.keys() | after.keys())
    return [f"{p}: {before.get(p)} -> {after.get(p)}" for p in paths if before.get(p) != after.get(p)]


def _struct(path: str, struct: Any, lines: dict[str, str], above: set[int]) -> None:
    for key in _custom_properties(struct):
        value = struct[key]
        plain = value.to_dict() if hasattr(value, "to_dict") else value
        lines[f"{path}[{key!r}]"] = repr(plain.to_list() if hasattr(plain, "to_list") else plain)
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in _VOLATILE:
            continue
        try:
            value = getattr(struct, name)
        except (AttributeError, RuntimeError):
            continue
        _value(f"{path}.{name}", value, prop, lines, above)


def _custom_properties(struct: Any) -> list[str]:
    try:
        return list(struct.keys())
    except (AttributeError, TypeError):  # a struct that cannot have any
        return []


def _value(path: str, value: Any, prop: Any, lines: dict[str, str], above: set[int]) -> None:
    if prop.type == "COLLECTION":
        for k, item in enumerate(value):
            if isinstance(item, bpy.types.ID):
                lines[f"{path}[{k}]"] = item.name_full
            elif item is not None and item.as_pointer() not in above:
                _struct(f"{path}[{k}]", item, lines, above | {item.as_pointer()})
    elif prop.type == "POINTER":
        if isinstance(value, bpy.types.NodeTree) and value.is_embedded_data:
            _struct(path, value, lines, above | {value.as_pointer()})
        elif isinstance(value, bpy.types.ID):
            lines[path] = value.name_full
        elif isinstance(value, bpy.types.NodeSocket):  # links refer to what the nodes hold
            lines[path] = f"{value.node.name} {value.is_output} {value.identifier}"
        elif isinstance(value, bpy.types.Node):
            lines[path] = value.name
        elif value is not None and value.as_pointer() not in above:
            _struct(path, value, lines, above | {value.as_pointer()})
        else:
            lines[path] = str(value is None)
    else:
        lines[path] = repr(tuple(value)) if getattr(prop, "is_array", False) else repr(value)
