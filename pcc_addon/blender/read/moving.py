"""What may be elsewhere, or of another shape, at another frame or in a render."""

from __future__ import annotations

import bpy


def is_animated(item: bpy.types.Object | None) -> bool:
    """Whether keyframes, drivers, constraints, a bone or the like may move an object, or one of its parents may."""
    if item is None:
        return False
    return _has_curves(item) or len(item.constraints) > 0 or item.parent_type != "OBJECT" or is_animated(item.parent)


def is_moving(item: bpy.types.Object) -> bool:
    """Whether an object, or what its surface is made of, may be elsewhere at another frame or in a render."""
    return _is_moving(item, frozenset())


def _is_moving(item: bpy.types.Object, above: frozenset[str]) -> bool:
    if item.name_full in above:
        return False
    above |= {item.name_full}
    keys = getattr(item.data, "shape_keys", None)
    if _is_simulated(item) or is_animated(item) or any(_has_curves(owner) for owner in (item.data, keys) if owner):
        return True
    if any(_displaces(slot.material) for slot in item.material_slots if slot.material):
        return True
    return any(_bends(modifier, above) for modifier in item.modifiers)


def _is_simulated(item: bpy.types.Object | None) -> bool:
    """Whether an object, or one of its parents, is a rigid body that falls."""
    if item is None:
        return False
    return (item.rigid_body is not None and item.rigid_body.type == "ACTIVE") or _is_simulated(item.parent)


def _bends(modifier: bpy.types.Modifier, above: frozenset[str]) -> bool:
    """Whether a modifier may give something else at another frame, by itself or by an object that it looks at."""
    if modifier.type in _BENDING or (modifier.type == "NODES" and _may_move(modifier.node_group, frozenset())):
        return True
    pointers = (p.identifier for p in modifier.bl_rna.properties if p.type == "POINTER")
    seen = (getattr(modifier, name) for name in pointers)
    return any(isinstance(other, bpy.types.Object) and _is_moving(other, above) for other in seen)


def _displaces(material: bpy.types.Material) -> bool:
    """Whether renders may move a surface of a material to where no mesh shows it."""
    if material.displacement_method == "BUMP" or material.node_tree is None:
        return False
    outputs = (node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    return any(node.inputs["Displacement"].is_linked for node in outputs)


_BENDING = {"ARMATURE", "HOOK", "LATTICE", "MESH_DEFORM", "SURFACE_DEFORM", "MESH_CACHE", "MESH_SEQUENCE_CACHE"} | {
    "CLOTH",
    "SOFT_BODY",
    "FLUID",
    "PARTICLE_SYSTEM",
    "OCEAN",
    "WAVE",
    "BUILD",
    "EXPLODE",
    "DYNAMIC_PAINT",
}  # by what may move without a curve of the object's own


_OF_TIME = {
    "GeometryNodeInputSceneTime",
    "GeometryNodeSimulationInput",
    "GeometryNodeObjectInfo",
    "GeometryNodeCollectionInfo",
}  # nodes that may give something else at another frame


def _may_move(tree: bpy.types.NodeTree | None, above: frozenset[str]) -> bool:
    """Whether what geometry nodes make may be elsewhere at another frame."""
    if tree is None or tree.name_full in above:
        return False
    above |= {tree.name_full}
    inner = (getattr(node, "node_tree", None) for node in tree.nodes)
    return (
        _has_curves(tree)
        or any(node.bl_idname in _OF_TIME for node in tree.nodes)
        or any(_may_move(one, above) for one in inner)
    )


def _has_curves(owner: bpy.types.ID) -> bool:
    data = owner.animation_data
    return data is not None and (data.action is not None or len(data.drivers) + len(data.nla_tracks) > 0)
