"""Whether anything scatters light: where nothing does, a picture shows nothing but what lies before it.

Proved from what is known to emit or to let light straight through; whatever else there is ends the proof.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

import bpy

from ... import compat, marks
from ..nodes import Scope, constant, output_of
from .nodes import is_by_hand

_SHADERS = {
    "ShaderNodeEmission", "ShaderNodeBsdfTransparent", "ShaderNodeHoldout", "ShaderNodeMixShader",
    "ShaderNodeAddShader",
}  # fmt: skip
# Nodes that know the surface, the camera and data alone; not what asks for things around, or for the path of a ray.
_VALUES = {
    "NodeReroute", "NodeFrame", "NodeGroupInput", "NodeGroupOutput", "ShaderNodeAttribute", "ShaderNodeBlackbody",
    "ShaderNodeBrightContrast", "ShaderNodeBump", "ShaderNodeCameraData", "ShaderNodeClamp", "ShaderNodeCombineColor",
    "ShaderNodeCombineXYZ", "ShaderNodeFloatCurve", "ShaderNodeFresnel", "ShaderNodeGamma", "ShaderNodeGroup",
    "ShaderNodeHueSaturation", "ShaderNodeInvert", "ShaderNodeLayerWeight", "ShaderNodeMapRange", "ShaderNodeMapping",
    "ShaderNodeMath", "ShaderNodeMix", "ShaderNodeMixRGB", "ShaderNodeNewGeometry", "ShaderNodeNormal",
    "ShaderNodeNormalMap", "ShaderNodeObjectInfo", "ShaderNodeRGB", "ShaderNodeRGBCurve", "ShaderNodeRGBToBW",
    "ShaderNodeSeparateColor", "ShaderNodeSeparateXYZ", "ShaderNodeTangent", "ShaderNodeTexBrick",
    "ShaderNodeTexChecker", "ShaderNodeTexCoord", "ShaderNodeTexEnvironment", "ShaderNodeTexGabor",
    "ShaderNodeTexGradient", "ShaderNodeTexImage", "ShaderNodeTexMagic", "ShaderNodeTexNoise", "ShaderNodeTexVoronoi",
    "ShaderNodeTexWave", "ShaderNodeTexWhiteNoise", "ShaderNodeUVMap", "ShaderNodeValToRGB", "ShaderNodeValue",
    "ShaderNodeVectorCurve", "ShaderNodeVectorMath", "ShaderNodeVectorRotate", "ShaderNodeVectorTransform",
    "ShaderNodeVertexColor", "ShaderNodeWavelength",
}  # fmt: skip
_PRINCIPLED = "ShaderNodeBsdfPrincipled"
# Inputs of a Principled BSDF that mean nothing where all others are 0; emission and alpha scatter nothing.
_FREE = {
    "Roughness", "IOR", "Alpha", "Thin Wall", "Normal", "Weight", "Diffuse Roughness", "Subsurface Radius",
    "Subsurface Scale", "Subsurface IOR", "Subsurface Anisotropy", "Specular Tint", "Anisotropic",
    "Anisotropic Rotation", "Tangent", "Coat Roughness", "Coat IOR", "Coat Tint", "Coat Normal", "Sheen Roughness",
    "Sheen Tint", "Emission Color", "Emission Strength", "Thin Film IOR",
}  # fmt: skip
_SPECULAR = "Specular IOR Level"  # captures switch it off where a probe stands for the lobe
# Modifiers that bring in neither materials nor instances.
_MODIFIERS = {
    "ARMATURE", "ARRAY", "BEVEL", "BUILD", "CAST", "CORRECTIVE_SMOOTH", "CURVE", "DECIMATE", "DISPLACE", "EDGE_SPLIT",
    "HOOK", "LAPLACIANSMOOTH", "LATTICE", "MASK", "MESH_DEFORM", "MIRROR", "MULTIRES", "NORMAL_EDIT", "REMESH",
    "SCREW", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SOLIDIFY", "SUBSURF", "SURFACE_DEFORM", "TRIANGULATE",
    "UV_PROJECT", "UV_WARP", "WAVE", "WEIGHTED_NORMAL", "WELD", "WIREFRAME",
}  # fmt: skip

Matt = Mapping[str, Collection[tuple[str, ...]]]
"""By a material's full name the surfaces, by path, whose specular lobe captures do not see."""


class Unlit:
    """Decides for a view layer by Cycles; each material is looked at once."""

    def __init__(self, view_layer: bpy.types.ViewLayer, matt: Matt) -> None:
        self._override, self._matt = view_layer.material_override, matt
        self._known: dict[int, bool] = {}

    def proved(self, items: Iterable[bpy.types.Object]) -> bool:
        """Whether none of some objects scatters any light."""
        return all(self._object(item) for item in items)

    def world(self, world: bpy.types.World | None) -> bool:
        """Whether a world scatters none."""
        if world is None or not compat.uses_nodes(world):
            return True
        output = world.node_tree.get_output_node("CYCLES")
        return output is None or not output.inputs["Volume"].is_linked

    def _object(self, item: bpy.types.Object) -> bool:
        if item.type == "LIGHT":
            return True
        plain = item.type == "MESH" and item.instance_type in {"NONE", "COLLECTION"} and not item.is_shadow_catcher
        if not plain or any(modifier.type not in _MODIFIERS for modifier in item.modifiers):
            return False
        slots = [slot.material for slot in item.material_slots]
        if self._override is not None:
            slots = [self._override]
        return bool(slots) and all(worn is not None and self._material(worn) for worn in slots)

    def _material(self, worn: bpy.types.Material) -> bool:
        key = worn.as_pointer()
        if key not in self._known:
            material = marks.original(worn)
            matt = self._matt.get(material.name_full, ()) if material == worn else ()
            self._known[key] = _emits_at_most(material, matt)
        return self._known[key]


def _emits_at_most(material: bpy.types.Material, matt: Collection[tuple[str, ...]]) -> bool:
    if not compat.uses_nodes(material) or material.is_grease_pencil:
        return False
    output = output_of(material, "CYCLES")
    if output is None:
        return True
    if output.inputs["Volume"].is_linked or output.inputs["Displacement"].is_linked:
        return False
    scope = Scope(material.node_tree)
    waiting, seen = _feeding(output.inputs["Surface"], scope), set()
    while waiting:
        node, scope = waiting.pop()
        key = scope.path(node)
        if key in seen:
            continue
        seen.add(key)
        if not _is_known(node, scope, matt):
            return False
        for socket in node.inputs:
            waiting += _feeding(socket, scope)
        inner = getattr(node, "node_tree", None)
        if inner is not None:
            inside = scope.inside(node)
            waiting += [(end, inside) for end in inner.nodes if end.bl_idname == "NodeGroupOutput"]
    return True


def _feeding(socket: bpy.types.NodeSocket, scope: Scope) -> list[tuple[bpy.types.Node, Scope]]:
    return [(link.from_node, scope) for link in socket.links]


def _is_known(node: bpy.types.Node, scope: Scope, matt: Collection[tuple[str, ...]]) -> bool:
    if node.bl_idname in _SHADERS:
        return True
    if node.bl_idname != _PRINCIPLED:
        return node.bl_idname in _VALUES and not is_by_hand(node)
    free = _FREE | {_SPECULAR} if scope.path(node) in matt else _FREE
    return all(socket.name in free or _is_nothing(constant(socket, scope)) for socket in node.inputs)


def _is_nothing(value: float | tuple[float, ...] | None) -> bool:
    """Whether an input is 0, or black, everywhere and always."""
    return value == 0.0 or (isinstance(value, tuple) and not any(value[:3]))
