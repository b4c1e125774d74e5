"""Reflecting twins: beside the user's nodes, a copy of the shader tree whose specular lobes are probes.

Nothing of the user's is changed: a second output node is made the active one, and removing it brings the first
back. The twin shares everything that is not a shader (textures, maps, values) with the original.

Only one output can be the active one. Where each engine has an output of its own, the twins are meant for one
engine each and the originals, until the twins are removed, for all, so that each engine prefers its twin.
"""

from __future__ import annotations

from contextlib import ExitStack

import bpy

from .. import compat, marks
from ..read.nodes import Scope, outputs, own_outputs, source
from .node_layout import spread
from .sketch import placed
from .surface_builder import CAPTURED, GLOW, PROBE
from .twin_builder import TwinBuilder
from .twin_order import TwinOrder

_OUTPUT = "output"  # role of a twin's output node


def add_twins(material: bpy.types.Material, order: TwinOrder) -> None:
    """Give every output in force of `material` a twin that shows what is ordered. It must not have twins yet."""
    tree = material.node_tree
    originals = outputs(material)
    own = own_outputs(tree)
    before = tuple(marks.OriginalOutput(o.name, own.index(o), o.target, o.is_active_output) for o in originals)
    for original, engine in zip(originals, ("CYCLES", "EEVEE"), strict=False):
        builder = TwinBuilder(tree, Scope(tree), order, material.name)
        twin = builder.sketch.new("ShaderNodeOutputMaterial", original, right=1000.0)
        marks.tag(twin, _OUTPUT)
        twin.label = f"{original.label or original.name}, Parallax Probe"
        fed = {}
        for socket in original.inputs:
            shader = socket.type == "SHADER" and socket.name == "Surface"
            fed[socket.name] = builder.twin(socket) if shader else source(socket)
        builder.sketch.join()
        for name, feeding in fed.items():
            if feeding is not None:
                tree.links.new(feeding, twin.inputs[name])
        if not order.surfaces:
            builder.keep_probes(original)
        if len(originals) == 1:
            twin.target = original.target
            twin.is_active_output = True
        else:
            twin.target, original.target = engine, "ALL"
    spread(tree, placed(tree))
    sampling = _stop_lamp_sampling(material) if order.probes and not order.emits else None
    marks.note_before(material, marks.Before(before, sampling))


def remove_twins(material: bpy.types.Material) -> bool:
    """Remove every twin of `material` and what belongs to it; True where there was one."""
    tree = material.node_tree
    own = [n for n in tree.nodes if marks.role(n)] if tree else []
    before = marks.noted_before(material)
    if not own and before is None:
        return False
    with ExitStack() as stack:
        if own:
            compat.use_all_inputs(stack, tree)
        for node in own:
            tree.nodes.remove(node)
    if before is not None:
        _restore(material, before)
        marks.forget_before(material)
    return True


def _restore(material: bpy.types.Material, before: marks.Before) -> None:
    """Bring back which outputs are in force, and whether the material is sampled as a lamp."""
    for node, original in _originals(material, before):
        if node.target != original.target:
            node.target = original.target
        if original.active:
            node.is_active_output = True
    if before.sampling == "":
        material.cycles.property_unset("emission_sampling")
    elif before.sampling is not None:
        material.cycles.emission_sampling = before.sampling


def _originals(
    material: bpy.types.Material, before: marks.Before
) -> list[tuple[bpy.types.ShaderNodeOutputMaterial, marks.OriginalOutput]]:
    """The outputs that twins stand in for, as far as they are still there, and what they were."""
    candidates, found = own_outputs(material.node_tree), []
    for original in before.outputs:
        node = next((n for n in candidates if n.name == original.name), None)
        if node is None and original.index < len(candidates):
            node = candidates[original.index]
        if node is not None:
            found.append((node, original))
    return found


def let_stand_in(material: bpy.types.Material, stand_in: bool) -> None:
    """Let the twins of a material stand in for its own outputs, as they do from their making on, or let them stay.

    Nothing else changes, and nothing at all where it is so already or where there are no twins.
    """
    before = marks.noted_before(material)
    if before is None:
        return
    twins = [node for node in material.node_tree.nodes if marks.role(node) == _OUTPUT]
    originals = _originals(material, before)
    if len(twins) != len(originals):  # the user deleted one: there is nothing to choose from
        return
    pairs = list(zip(twins, originals, ("CYCLES", "EEVEE"), strict=False))
    for twin, (node, original), engine in pairs if len(pairs) > 1 else ():
        _aim(twin, engine if stand_in else "ALL")
        _aim(node, "ALL" if stand_in else original.target)
    if len(pairs) == 1:
        twin, (node, _), _ = pairs[0]
        _activate(twin if stand_in else node)
    else:  # of an engine's own output and one for all, the engine takes its own
        first = [node for _, (node, original), _ in pairs if original.target == "ALL"] if not stand_in else []
        for node in first or [node for _, (node, original), _ in pairs if original.active]:
            _activate(node)


def _aim(node: bpy.types.ShaderNodeOutputMaterial, target: str) -> None:
    if node.target != target:
        node.target = target


def _activate(node: bpy.types.ShaderNodeOutputMaterial) -> None:
    if not node.is_active_output:
        node.is_active_output = True


def shown_probe_groups(material: bpy.types.Material) -> tuple[bpy.types.ShaderNodeTree, ...]:
    """The probe groups that a material's twins show, each once, in the order of their making; empty without twins."""
    groups = (node.node_tree for node in _nodes_with_role(material.node_tree, PROBE))
    return tuple(dict.fromkeys(group for group in groups if group is not None))


def has_twins(material: bpy.types.Material) -> bool:
    """Whether anything of ours is in a material."""
    return marks.noted_before(material) is not None or any(
        marks.role(n) for n in (material.node_tree.nodes if material.node_tree else ())
    )


def is_torn(material: bpy.types.Material) -> bool:
    """Whether a group that its twins need was deleted."""
    return any(_has_hole(node) for node in material.node_tree.nodes) if material.node_tree else False


def _has_hole(node: bpy.types.Node) -> bool:
    if not marks.role(node) or node.bl_idname != "ShaderNodeGroup":
        return False
    copied = node.node_tree is not None and marks.role(node.node_tree) == marks.TWIN_GROUP
    return node.node_tree is None or (copied and any(_has_hole(inner) for inner in node.node_tree.nodes))


def reflection_nodes(material: bpy.types.Material) -> list[bpy.types.Node]:
    """The nodes of a material's twins that emit the reflection; muted, they leave what captures see."""
    return _nodes_with_role(material.node_tree, GLOW)


def capture_inputs(material: bpy.types.Material) -> list[bpy.types.NodeSocket]:
    """The inputs of a material's twins that are to be 1 while probes are captured."""
    return [node.inputs["Captured"] for node in _nodes_with_role(material.node_tree, CAPTURED)]


def _nodes_with_role(tree: bpy.types.ShaderNodeTree | None, wanted: str) -> list[bpy.types.Node]:
    found = []
    for node in tree.nodes if tree else ():
        if marks.role(node) == wanted:
            found.append(node)
        elif marks.role(node) and (inner := getattr(node, "node_tree", None)) and marks.role(inner) == marks.TWIN_GROUP:
            found += _nodes_with_role(inner, wanted)
    return found


def _stop_lamp_sampling(material: bpy.types.Material) -> str | None:
    """Keep Cycles from treating the reflection as a lamp; returns the setting before, "" for the default."""
    if material.cycles.emission_sampling == "NONE":
        return None
    before = material.cycles.emission_sampling if material.cycles.is_property_set("emission_sampling") else ""
    material.cycles.emission_sampling = "NONE"
    return before
