"""The settings of anything that Blender's RNA describes, as digests: data blocks by what they hold, names left out."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import bpy
import numpy as np

from .digests import Read, digest, numbers, plain
from .pictures import file

Refer = Callable[[bpy.types.ID, set[Read]], bytes]  # the digest of what a data block holds; adds what that reads

ID_BOOKKEEPING = frozenset(p.identifier for p in bpy.types.ID.bl_rna.properties) | {"animation_data"}
# What no struct is asked for: names, what is chosen and hidden in editors, and what simulations have stored.
_NOWHERE = frozenset(
    {"rna_type", "name", "select", "is_editmode", "hide", "character_index", "point_cache", "particles"}
    | {"child_particles", "density_grid", "flame_grid", "temperature_grid", "velocity_grid", "heat_grid", "color_grid"}
    | {"start_point", "cell_size", "domain_resolution"}
)
_DEEPEST = 6  # structs within structs; what points back to its owner is deeper
# Points that there may be thousands of, with the fields that shape something.
_MANY = {
    "SplinePoint": (("co", 4), ("tilt", 1), ("radius", 1), ("weight", 1)),
    "BezierSplinePoint": (("co", 3), ("handle_left", 3), ("handle_right", 3), ("tilt", 1), ("radius", 1)),
    "LatticePoint": (("co_deform", 3),),
    "ShapeKeyPoint": (("co", 3),),
    "ShapeKeyCurvePoint": (("co", 3), ("tilt", 1), ("radius", 1)),
    "ShapeKeyBezierPoint": (("co", 3), ("handle_left", 3), ("handle_right", 3), ("tilt", 1), ("radius", 1)),
    "ParticleHairKey": (("co_local", 3),),
}


def settings(
    struct: Any, refer: Refer, reads: set[Read], without: frozenset[str] = frozenset(), depth: int = 0
) -> bytes:
    """A digest of all properties of a struct, and of those of the structs in it.

    Args:
        struct: whose.
        refer: what stands for a data block that a property points to.
        reads: what those read is added here, and texts, which may be names of attributes.
        without: names of properties that do not count, but for the structs in it.
        depth: how many structs this one is in.
    """
    parts = []
    for name, kind in _properties(struct):
        if name not in without:
            parts.append(digest(name, _value(struct, name, kind, refer, reads, depth)))
    return digest(*parts)


def named(struct: Any, names: tuple[str, ...]) -> bytes:
    """A digest of some plain properties; one that this Blender lacks counts as None."""
    return repr([plain(getattr(struct, name, None)) for name in names]).encode()


def many(points: Any) -> bytes | None:
    """A digest of a collection of points, or None where it holds none that are known."""
    fields = _MANY.get(type(points[0]).__name__) if len(points) else None
    if fields is None:
        return None
    parts = []
    for name, width in fields:
        values = np.empty(len(points) * width, np.float32)
        points.foreach_get(name, values)
        parts.append(numbers(values))
    return digest(*parts)


def _value(struct: Any, name: str, kind: str, refer: Refer, reads: set[Read], depth: int) -> bytes:
    value = getattr(struct, name)
    if kind == "COLLECTION":
        found = many(value)
        if found is not None:
            return found
        return digest(*(_part(part, refer, reads, depth) for part in value))
    if kind == "POINTER":
        return _part(value, refer, reads, depth)
    if kind == "FILE_PATH":
        return file(value, struct.id_data.library)
    if kind == "STRING" and value:
        reads.add(("attribute", "GEOMETRY", value))
    return plain(value).encode()


def _part(value: Any, refer: Refer, reads: set[Read], depth: int) -> bytes:
    if value is None:
        return b"none"
    if isinstance(value, bpy.types.ID):
        return refer(value, reads)
    return settings(value, refer, reads, depth=depth + 1) if depth < _DEEPEST else b"deep"


def _properties(struct: Any) -> tuple[tuple[str, str], ...]:
    kind = type(struct)
    # A struct that Blender makes while it runs, as for the inputs of a modifier, may be another one of the same name.
    return _read(kind) if getattr(bpy.types, kind.__name__, None) is kind else _read.__wrapped__(kind)


@cache
def _read(kind: type) -> tuple[tuple[str, str], ...]:
    """Names and types, "FILE_PATH" for that of a file; what add-ons hang on Blender's own types is not seen."""
    foreign = getattr(bpy.types, kind.__name__, None) is kind and not issubclass(kind, bpy.types.PropertyGroup)
    found = ((p, p.subtype if p.type == "STRING" else "") for p in kind.bl_rna.properties)
    return tuple(
        (p.identifier, "FILE_PATH" if subtype == "FILE_PATH" else p.type)
        for p, subtype in found
        if p.identifier not in _NOWHERE and subtype != "DIR_PATH" and not (foreign and p.is_runtime)
    )
