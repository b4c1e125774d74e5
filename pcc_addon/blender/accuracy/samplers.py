"""How many of the GPU's samplers materials take: EEVEE allows 32 a material, and takes two for itself."""

from __future__ import annotations

import bpy

from ...core.probe import Engine
from ..read.nodes import group_output, source

_OF_EEVEE = 2
_PICTURES = {"ShaderNodeTexImage", "ShaderNodeTexEnvironment"}


def fullest() -> int:
    """Of the material of the file with the most among those that anything wears."""
    return _OF_EEVEE + max((len(_pictures(m)) for m in bpy.data.materials if m.users), default=0)


def _pictures(material: bpy.types.Material) -> set[tuple]:
    """What a material reads: an image with how it is read, each once, as EEVEE shares samplers."""
    output = material.node_tree.get_output_node(Engine.EEVEE.value) if material.node_tree else None
    return _reached(output) if output is not None else set()


def _reached(sink: bpy.types.Node) -> set[tuple]:
    """What feeds a node, in groups too."""
    found: set[tuple] = set()
    waiting, passed = [sink], set()
    while waiting:
        node = waiting.pop()
        if node.name in passed or (node.mute and node is not sink):
            continue
        passed.add(node.name)
        if node.bl_idname in _PICTURES and node.image is not None:
            found.add((node.image.name_full, node.interpolation, getattr(node, "extension", ""), node.projection))
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
            inner = group_output(node.node_tree)
            found |= _reached(inner) if inner is not None else set()
        waiting += [feeding.node for feeding in map(source, node.inputs) if feeding is not None]
    return found
