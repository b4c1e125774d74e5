"""Which Principled surfaces of a material a probe can light, and why not the others."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ...core.effects.records import SurfaceEffects
from ...core.effects.reflectance import dielectric_lobe
from .. import compat, marks

ROUGHNESS_DIGITS = 4  # a level's roughness is told apart to this many digits
_LOBES_NOT_HANDLED = {
    "Transmission Weight": "transmits light",
    "Coat Weight": "has a coat",
    "Sheen Weight": "has sheen",
    "Anisotropic": "is anisotropic",
    "Thin Film Thickness": "has a thin film",
}


class Unhandled(Exception):
    """Why a material is left as it is; the text follows the material's name."""


@dataclass(frozen=True)
class Scope:
    """A node tree as one material uses it: with the chain of group nodes that led there, innermost last."""

    tree: bpy.types.ShaderNodeTree
    nodes: tuple[bpy.types.ShaderNodeGroup, ...] = ()

    def inside(self, node: bpy.types.ShaderNodeGroup) -> Scope:
        return Scope(node.node_tree, (*self.nodes, node))


def source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The output socket that feeds an input, through reroutes, or None where nothing does."""
    while socket.is_linked and not socket.links[0].is_muted:
        feeding = socket.links[0].from_socket
        if feeding.node.bl_idname != "NodeReroute":
            return feeding
        socket = feeding.node.inputs[0]
    return None


def constant(socket: bpy.types.NodeSocket, scope: Scope) -> float | tuple[float, ...] | None:
    """The value of an input that is the same all over the surface, or None where it varies."""
    feeding = source(socket)
    if feeding is None:
        value = socket.default_value
        return tuple(value) if hasattr(value, "__len__") else float(value)
    if feeding.node.bl_idname == "ShaderNodeValue" and feeding.id_data.animation_data is None:
        return float(feeding.default_value)
    if feeding.node.bl_idname == "NodeGroupInput" and scope.nodes:
        outer = Scope(scope.nodes[-1].id_data, scope.nodes[:-1])
        index = list(feeding.node.outputs).index(feeding)
        return constant(scope.nodes[-1].inputs[index], outer)
    return None


def outputs(material: bpy.types.Material) -> list[bpy.types.ShaderNodeOutputMaterial]:
    """The user's output nodes that engines read, without our own: one for both, or Cycles' and then EEVEE's."""
    nodes = material.node_tree.nodes
    own = [n for n in nodes if n.bl_idname == "ShaderNodeOutputMaterial" and not marks.role(n)]
    twinned = {n.get("pcc_twin_of") for n in nodes if marks.role(n)}
    chosen = []
    for engine in ("CYCLES", "EEVEE"):
        # As Blender chooses: one for this engine before one for all, then the active one, then the first.
        candidates = [n for n in own if n.target in {engine, "ALL"}]
        ranks = [(n.target == engine, n.is_active_output or n.name in twinned) for n in candidates]
        if candidates and candidates[ranks.index(max(ranks))] not in chosen:
            chosen.append(candidates[ranks.index(max(ranks))])
    return chosen


def leaf_effects(
    node: bpy.types.ShaderNodeBsdfPrincipled, scope: Scope, roughness_limit: float
) -> SurfaceEffects | None:
    """What one Principled BSDF calls for, or None where it reflects nothing or is rougher than the limit.

    Raises:
        Unhandled: a probe cannot stand in for its specular lobe.
    """
    inputs = node.inputs
    for name, what in _LOBES_NOT_HANDLED.items():
        if name in inputs and constant(inputs[name], scope) != 0.0:
            raise Unhandled(f"{what} ('{node.name}')")
    metallic = constant(inputs["Metallic"], scope)
    level = constant(inputs["Specular IOR Level"], scope)
    ior = constant(inputs["IOR"], scope)
    tint = constant(inputs["Specular Tint"], scope)
    tinted = tint is None or tint[:3] != (1.0, 1.0, 1.0)
    if ior is None:
        raise Unhandled(f"has a varying IOR ('{node.name}')")
    if ior < 1.0:
        raise Unhandled(f"has an IOR below 1 ('{node.name}')")
    dielectric = None if metallic is not None and metallic >= 1.0 else dielectric_lobe(ior, level, tinted)
    metal = metallic is None or metallic > 0.0
    if dielectric is None and not metal:
        return None
    roughness = constant(inputs["Roughness"], scope)
    if roughness is None:
        raise Unhandled(f"has a textured roughness ('{node.name}')")
    if roughness > roughness_limit + 0.5 * 10**-ROUGHNESS_DIGITS:
        return None
    return SurfaceEffects(
        roughness=round(min(max(roughness, 0.0), 1.0), ROUGHNESS_DIGITS),
        dielectric=dielectric,
        metal=metal,
        multiscatter=node.distribution == "MULTI_GGX",
        tinted=tinted and metal,
    )


def effects(material: bpy.types.Material, roughness_limit: float) -> set[SurfaceEffects]:
    """What all Principled surfaces of a material call for; empty where nothing reflects sharply enough.

    Raises:
        Unhandled: the material must be left as it is.
    """
    if material.library:
        raise Unhandled(f"is linked from '{material.library.filepath}': inject it there, or make it local")
    if not compat.uses_nodes(material):
        raise Unhandled("uses no nodes")
    if material.grease_pencil:
        raise Unhandled("is a grease pencil material")
    found: set[SurfaceEffects] = set()
    for output in outputs(material):
        found |= _walk(output.inputs["Surface"], Scope(material.node_tree), roughness_limit, set())
    return found


def _walk(socket: bpy.types.NodeSocket, scope: Scope, limit: float, seen: set[tuple]) -> set[SurfaceEffects]:
    feeding = source(socket)
    if feeding is None or feeding.type != "SHADER" or feeding.node.mute:
        return set()
    node = feeding.node
    key = (tuple(n.as_pointer() for n in scope.nodes), node.as_pointer(), feeding.identifier)
    if key in seen:
        return set()
    seen.add(key)
    if node.bl_idname == "ShaderNodeBsdfPrincipled":
        leaf = leaf_effects(node, scope, limit)
        return {leaf} if leaf else set()
    found: set[SurfaceEffects] = set()
    if node.bl_idname == "ShaderNodeGroup" and node.node_tree:
        inner = group_output(node.node_tree)
        if inner is not None:
            inside = inner.inputs[list(node.outputs).index(feeding)]
            found |= _walk(inside, scope.inside(node), limit, seen)
    for shader in (s for s in node.inputs if s.type == "SHADER"):
        found |= _walk(shader, scope, limit, seen)
    return found


def group_output(tree: bpy.types.ShaderNodeTree) -> bpy.types.Node | None:
    """The output node of a group that is in force."""
    candidates = [n for n in tree.nodes if n.bl_idname == "NodeGroupOutput"]
    return next((n for n in candidates if n.is_active_output), candidates[0] if candidates else None)
