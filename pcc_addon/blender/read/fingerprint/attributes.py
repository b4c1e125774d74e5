"""The attributes of meshes, hair curves, point clouds and drawings, each as a digest of its numbers."""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .digests import digest, numbers, plain, unordered

_FIELDS = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int32, 1),
    "BOOLEAN": ("value", np.bool_, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "INT16_2D": ("value", np.int32, 2),
    "INT32_2D": ("value", np.int32, 2),
    "QUATERNION": ("value", np.float32, 4),
    "FLOAT4X4": ("value", np.float32, 16),
}
# What is chosen or hidden in an editor, what Blender derives from the rest, and marks that no render shows.
_UNSEEN = (
    ".select_", ".hide_", ".vs.", ".es.", ".pn.", ".uv_select", ".sculpt", ".corner_edge", "freestyle_", ".selection",
)  # fmt: skip
_WITHOUT = {"sharp_face", "sharp_edge", "uv_seam", "material_index"}  # zeros are the same as none
_UV, _COLOR = "UV", "colour"


@dataclass(frozen=True)
class Layer:
    """An attribute.

    Attributes:
        name: what shaders may call it.
        kind: "UV" and "colour" for those that are found without their name too.
        is_default: whether it is the one that is found then.
        digest: of its domain, type and numbers.
    """

    name: str
    kind: str
    is_default: bool
    digest: bytes


def of_mesh(mesh: bpy.types.Mesh) -> tuple[Layer, ...]:
    """All attributes of a mesh, its faces among them."""
    uv = next((layer.name for layer in mesh.uv_layers if layer.active_render), "")
    colors, shown = mesh.color_attributes, mesh.color_attributes.render_color_index
    color = colors[shown].name if 0 <= shown < len(colors) else ""
    names = {layer.name for layer in mesh.uv_layers}, {layer.name for layer in colors}
    found = [Layer(".faces", "", False, _faces(mesh))]
    for attribute in _counted(mesh.attributes):
        name = attribute.name
        kind = _UV if name in names[0] else _COLOR if name in names[1] else ""
        found.append(Layer(name, kind, name == (uv if kind == _UV else color), _numbers(attribute)))
    return tuple(found)


def of_others(attributes: Any) -> tuple[Layer, ...]:
    """All attributes of anything else."""
    return tuple(Layer(each.name, "", False, _numbers(each)) for each in _counted(attributes))


def together(layers: Iterable[Layer], read: Container[str], all_uvs: bool, without: Container[str] = ()) -> bytes:
    """A digest of attributes as somebody sees them.

    Args:
        layers: which.
        read: the names that somebody reads; another name than these says nothing where the kind says enough.
        all_uvs: whether UV maps count that are neither read by name nor without one.
        without: names of attributes that do not count.
    """
    parts = []
    for layer in layers:
        is_named = not layer.kind or layer.name in read
        if layer.name in without or (layer.kind == _UV and not (is_named or layer.is_default or all_uvs)):
            continue
        parts.append(digest(layer.name if is_named else "", layer.kind, str(layer.is_default), layer.digest))
    return unordered(parts)


def materials_of_faces(mesh: bpy.types.Mesh) -> frozenset[int]:
    """The numbers of the material slots that faces of a mesh ask for."""
    attribute = mesh.attributes.get("material_index")
    if attribute is None or attribute.domain != "FACE" or attribute.data_type != "INT":
        return frozenset({0} if len(mesh.polygons) else ())
    return frozenset(np.unique(_values(attribute)).tolist())


def _counted(attributes: Any) -> Iterable[bpy.types.Attribute]:
    for attribute in attributes:
        if attribute.name.startswith(_UNSEEN):
            continue
        if attribute.name in _WITHOUT and attribute.data_type in _FIELDS and not _values(attribute).any():
            continue
        yield attribute


def _numbers(attribute: bpy.types.Attribute) -> bytes:
    kind = f"{attribute.domain} {attribute.data_type}"
    if attribute.data_type in _FIELDS:
        return digest(kind, numbers(_values(attribute)))
    fields = [p.identifier for p in attribute.data[0].bl_rna.properties][1:] if len(attribute.data) else []
    return digest(kind, plain([[getattr(each, name) for name in fields] for each in attribute.data]))


def _values(attribute: bpy.types.Attribute) -> np.ndarray:
    field, dtype, width = _FIELDS[attribute.data_type]
    values = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(field, values)
    return values


def _faces(mesh: bpy.types.Mesh) -> bytes:
    """Where each face begins; where all are triangles their number says it."""
    if len(mesh.loops) == 3 * len(mesh.polygons):
        return f"{len(mesh.polygons)} triangles".encode()
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return numbers(starts)
