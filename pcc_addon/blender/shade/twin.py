"""Reflecting twins: beside the user's nodes, a copy of the shader tree whose specular lobes are probes.

Nothing of the user's is changed: a second output node is made the active one, and removing it brings the first
back. The twin shares everything that is not a shader (textures, maps, values) with the original.

Only one output can be the active one. Where each engine has an output of its own, the twins are meant for one
engine each and the originals, until the twins are removed, for all, so that each engine prefers its twin.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ...core.effects.records import SurfaceEffects
from .. import marks
from ..read.surfaces import Scope, constant, group_output, leaf_effects, outputs, source
from . import groups

_TWIN_OF = "pcc_twin_of"
_TARGET = "pcc_target"
_ACTIVE = "pcc_active"
_SAMPLING = "pcc_emission_sampling"
_PROBE, _GLOW = "probe", "glow"  # roles of a twin's nodes that are looked for later
_COPIED_LATER = {"Base Color", "Metallic", "Specular IOR Level"}
_DROP = -600.0  # how far below the original its twin is drawn


@dataclass(frozen=True)
class Reflection:
    """What twins show.

    Attributes:
        probe_group: a probe's group, or None for the diffuse part alone (as captures need it).
        roughness_limit: rougher surfaces keep their own specular lobe.
    """

    probe_group: bpy.types.ShaderNodeTree | None
    roughness_limit: float


def add_twins(material: bpy.types.Material, reflection: Reflection) -> None:
    """Give every output in force of `material` a twin that shows `reflection`. It must not have twins yet."""
    tree = material.node_tree
    originals = outputs(material)
    for original, engine in zip(originals, ("CYCLES", "EEVEE"), strict=False):
        builder = _Builder(tree, Scope(tree), reflection, material.name)
        twin = builder.new("ShaderNodeOutputMaterial", original)
        twin.name = f"PCC {original.name}"
        twin.label = "Parallax Probe"
        twin[_TWIN_OF] = original.name
        for socket in original.inputs:
            shader = socket.type == "SHADER" and socket.name == "Surface"
            feeding = builder.twin(socket) if shader else source(socket)
            if feeding is not None:
                tree.links.new(feeding, twin.inputs[socket.name])
        twin[_ACTIVE] = original.is_active_output
        if len(originals) == 1:
            twin.target = original.target
            twin.is_active_output = True
        else:
            twin[_TARGET] = original.target
            twin.target, original.target = engine, "ALL"
    if reflection.probe_group is not None:
        _stop_lamp_sampling(material)


def remove_twins(material: bpy.types.Material) -> bool:
    """Remove every twin of `material` and what belongs to it; True where there was one."""
    tree = material.node_tree
    own = [n for n in tree.nodes if marks.role(n)] if tree else []
    if not own:
        return False
    originals = [(tree.nodes.get(n[_TWIN_OF]), n.get(_TARGET), n.get(_ACTIVE, True)) for n in own if _TWIN_OF in n]
    for node in own:
        if _SAMPLING in node:
            _restore_lamp_sampling(material, node[_SAMPLING])
    copies = {n.node_tree for n in own if n.bl_idname == "ShaderNodeGroup" and n.node_tree}
    for node in own:
        tree.nodes.remove(node)
    for copy in copies:
        _remove_copy(copy)
    for original, target, was_active in originals:
        if original is None:
            continue
        if target is not None:
            original.target = target
        if was_active:
            original.is_active_output = True
    return True


def shown_probe_group(material: bpy.types.Material) -> bpy.types.ShaderNodeTree | None:
    """The probe group that a material's twins show, or None where it has no twins."""
    shown = _nodes_with_role(material.node_tree, _PROBE)
    return shown[0].node_tree if shown else None


def reflection_nodes(material: bpy.types.Material) -> list[bpy.types.Node]:
    """The nodes of a material's twins that emit the reflection; muted, they leave the diffuse part."""
    return _nodes_with_role(material.node_tree, _GLOW)


def outputs_in_use(probe_group: bpy.types.ShaderNodeTree) -> set[str]:
    """The names of a probe group's outputs that some material reads."""
    nodes = [n for m in bpy.data.materials for n in _nodes_with_role(m.node_tree, _PROBE)]
    return {s.name for n in nodes if n.node_tree == probe_group for s in n.outputs if s.is_linked}


def _nodes_with_role(tree: bpy.types.ShaderNodeTree | None, wanted: str) -> list[bpy.types.Node]:
    found = []
    for node in tree.nodes if tree else ():
        if marks.role(node) == wanted:
            found.append(node)
        elif marks.role(node) and node.bl_idname == "ShaderNodeGroup" and marks.role(node.node_tree) == "copy":
            found += _nodes_with_role(node.node_tree, wanted)
    return found


def _remove_copy(tree: bpy.types.ShaderNodeTree) -> None:
    """Remove a copied group and the copies inside it; shared groups of ours stay."""
    if marks.role(tree) != "copy":
        return
    inner = {n.node_tree for n in tree.nodes if marks.role(n) and n.bl_idname == "ShaderNodeGroup"}
    bpy.data.node_groups.remove(tree)
    for copy in inner:
        if copy is not None:
            _remove_copy(copy)


def _stop_lamp_sampling(material: bpy.types.Material) -> None:
    """Keep Cycles from treating the reflection as a lamp, where the material is none of its own."""
    own_light = any(_glows(output.inputs["Surface"], Scope(material.node_tree)) for output in outputs(material))
    if own_light or material.cycles.emission_sampling == "NONE":
        return
    marker = next(n for n in material.node_tree.nodes if _TWIN_OF in n)
    was_set = material.cycles.is_property_set("emission_sampling")
    marker[_SAMPLING] = material.cycles.emission_sampling if was_set else ""
    material.cycles.emission_sampling = "NONE"


def _restore_lamp_sampling(material: bpy.types.Material, before: str) -> None:
    if before:
        material.cycles.emission_sampling = before
    else:
        material.cycles.property_unset("emission_sampling")


def _glows(socket: bpy.types.NodeSocket, scope: Scope) -> bool:
    """Whether a shader that feeds `socket` emits light of its own."""
    feeding = source(socket)
    if feeding is None or feeding.type != "SHADER" or feeding.node.mute:
        return False
    node = feeding.node
    if node.bl_idname in {"ShaderNodeEmission", "ShaderNodeBsdfPrincipled"}:
        color, strength = (
            ("Emission Color", "Emission Strength") if "Emission Color" in node.inputs else ("Color", "Strength")
        )
        dark = constant(node.inputs[color], scope)
        return constant(node.inputs[strength], scope) != 0.0 and (dark is None or any(dark[:3]))
    if node.bl_idname == "ShaderNodeGroup" and node.node_tree:
        inner = group_output(node.node_tree)
        if inner is not None and _glows(inner.inputs[list(node.outputs).index(feeding)], scope.inside(node)):
            return True
    return any(_glows(s, scope) for s in node.inputs if s.type == "SHADER")


class _Builder:
    """Builds the twins of one node tree."""

    def __init__(self, tree: bpy.types.ShaderNodeTree, scope: Scope, reflection: Reflection, material: str) -> None:
        self.tree, self.scope, self.reflection, self.material = tree, scope, reflection, material
        self._twins: dict[tuple[int, str], bpy.types.NodeSocket] = {}
        self._geometry: bpy.types.Node | None = None

    def new(self, kind: str, beside: bpy.types.Node, right: float = 0.0, down: float = 0.0) -> bpy.types.Node:
        """A node of ours, drawn below `beside`."""
        node = self.tree.nodes.new(kind)
        node.select = False
        marks.tag(node, "twin")
        place = beside.location_absolute if hasattr(beside, "location_absolute") else beside.location
        node.location = (place.x + right, place.y + _DROP - down)
        return node

    def twin(self, socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
        """The output that does for a twin what the source of `socket` does for the original."""
        feeding = source(socket)
        if feeding is None or feeding.type != "SHADER":
            return feeding
        key = (feeding.node.as_pointer(), feeding.identifier)
        if key not in self._twins:
            self._twins[key] = self._twin_of(feeding)
        return self._twins[key]

    def _twin_of(self, feeding: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        node = feeding.node
        if node.mute:
            return feeding
        if node.bl_idname == "ShaderNodeBsdfPrincipled":
            effects = leaf_effects(node, self.scope, self.reflection.roughness_limit)
            return self._surface(node, effects) if effects else feeding
        is_group = node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None
        if not is_group and not any(s.type == "SHADER" for s in node.inputs):
            return feeding
        copy = self._copy(node)
        if is_group:
            copy.node_tree = self._group(node)
            self._fill(node, copy)
        return copy.outputs[list(node.outputs).index(feeding)]

    def _copy(self, node: bpy.types.Node) -> bpy.types.Node:
        copy = self.new(node.bl_idname, node)
        copy.name = f"PCC {node.name}"
        if node.bl_idname != "ShaderNodeGroup":
            _copy_settings(node, copy)
            self._fill(node, copy)
        return copy

    def _fill(self, node: bpy.types.Node, copy: bpy.types.Node, without: set[str] = frozenset()) -> None:
        """Feed the inputs of `copy` as those of `node` are fed, shaders by their twins."""
        for old, new in zip(node.inputs, copy.inputs, strict=True):
            if old.name in without:
                continue
            feeding = self.twin(old) if old.type == "SHADER" else source(old)
            if feeding is not None:
                self.tree.links.new(feeding, new)
            elif hasattr(old, "default_value"):
                new.default_value = old.default_value

    def _group(self, node: bpy.types.ShaderNodeGroup) -> bpy.types.ShaderNodeTree:
        """A copy of a group's tree whose shaders are twins."""
        inside = self.scope.inside(node)
        tree = node.node_tree.copy()
        tree.name = f"PCC {node.node_tree.name}, {self.material}"
        marks.tag(tree, "copy")
        sink = group_output(tree)
        if sink is None:
            return tree
        builder = _Builder(tree, Scope(tree, inside.nodes), self.reflection, self.material)
        for socket in [s for s in sink.inputs if s.type == "SHADER"]:
            feeding = builder.twin(socket)
            if feeding is not None:
                tree.links.new(feeding, socket)
        return tree

    def _surface(self, node: bpy.types.ShaderNodeBsdfPrincipled, effects: SurfaceEffects) -> bpy.types.NodeSocket:
        """A Principled surface without its specular lobe, plus what the probe reflects in its place."""
        links = self.tree.links
        diffuse = self.new("ShaderNodeBsdfPrincipled", node)
        diffuse.name = f"PCC {node.name}"
        _copy_settings(node, diffuse)
        self._fill(node, diffuse, without=_COPIED_LATER)
        diffuse.inputs["Metallic"].default_value = 0.0
        diffuse.inputs["Specular IOR Level"].default_value = 0.0

        lit = self.new("ShaderNodeGroup", node, right=-220.0)
        lit.node_tree = groups.surface_group(effects)
        lit.name, lit.label = f"PCC Surface of {node.name}", "Split-Sum Reflectance"
        normal = source(node.inputs["Normal"]) or self._geometry_of(node).outputs["Normal"]
        for socket in lit.inputs:
            if socket.name == "Normal":
                links.new(normal, socket)
            elif socket.name == "Incoming":
                links.new(self._geometry_of(node).outputs["Incoming"], socket)
            elif socket.name != "Radiance":
                self._feed(node.inputs[socket.name], socket)
        links.new(lit.outputs["Diffuse Color"], diffuse.inputs["Base Color"])
        if self.reflection.probe_group is None:
            return diffuse.outputs[0]

        probe = self.new("ShaderNodeGroup", node, right=-440.0)
        probe.node_tree = self.reflection.probe_group
        probe.name, probe.label = f"PCC Probe of {node.name}", "Parallax Probe"
        marks.tag(probe, _PROBE)
        links.new(normal, probe.inputs["Normal"])
        links.new(probe.outputs[groups.level_output(effects.roughness)], lit.inputs["Radiance"])
        glow = self.new("ShaderNodeEmission", node, right=280.0, down=160.0)
        marks.tag(glow, _GLOW)
        links.new(lit.outputs["Reflection"], glow.inputs["Color"])
        self._feed(node.inputs["Alpha"], glow.inputs["Strength"])
        total = self.new("ShaderNodeAddShader", node, right=480.0)
        links.new(diffuse.outputs[0], total.inputs[0])
        links.new(glow.outputs[0], total.inputs[1])
        return total.outputs[0]

    def _feed(self, old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
        feeding = source(old)
        if feeding is not None:
            self.tree.links.new(feeding, new)
            return
        value = old.default_value
        wide = hasattr(new.default_value, "__len__")
        new.default_value = tuple(value)[: len(new.default_value)] if wide else value

    def _geometry_of(self, node: bpy.types.Node) -> bpy.types.Node:
        if self._geometry is None:
            self._geometry = self.new("ShaderNodeNewGeometry", node, right=-660.0)
        return self._geometry


def _copy_settings(node: bpy.types.Node, copy: bpy.types.Node) -> None:
    """Copy what is special to the node's type, such as a distribution; not its name or place."""
    common = {p.identifier for p in bpy.types.Node.bl_rna.properties}
    for prop in node.bl_rna.properties:
        if prop.identifier not in common and not prop.is_readonly:
            setattr(copy, prop.identifier, getattr(node, prop.identifier))
