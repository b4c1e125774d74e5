"""What modifiers and particle systems do to an object, by their settings and by what these point to.

Settings and not results: viewports may show less than renders do, and what is hidden there is not evaluated at all.
"""

from __future__ import annotations

from typing import Any

import bpy

from ... import compat
from .digests import EVALUATED, FRAME, Found, Read, digest, plain, unordered
from .geometry import Geometry, bone
from .nodes import Trees
from .properties import ID_BOOKKEEPING, many, settings

_BOOKKEEPING = frozenset(
    {p.identifier for p in bpy.types.Modifier.bl_rna.properties} - {"type", "use_apply_on_spline"}
    | {"show_only_control_edges", "levels", "sculpt_levels", "viewport_resolution", "preview_resolution"}
    | {p.identifier for p in bpy.types.ParticleSystem.bl_rna.properties if p.identifier.startswith("active_")}
)  # fmt: skip
_SIMULATED = frozenset({"FLUID", "CLOTH", "SOFT_BODY", "DYNAMIC_PAINT", "OCEAN", "EXPLODE", "PARTICLE_INSTANCE"})
# What Blender can make of them at a frame without rendering.
_PLAYED = frozenset({"BUILD", "WAVE", "MESH_CACHE", "MESH_SEQUENCE_CACHE", "MULTIRES"})
_DRAWN_OVER_TIME = frozenset({"GREASE_PENCIL_BUILD", "GREASE_PENCIL_TIME", "GREASE_PENCIL_NOISE", "LINEART"})
_PARTICLES = ID_BOOKKEEPING | {
    "show_guide_hairs", "show_hair_grid", "show_velocity", "show_size", "show_health", "show_number", "display_method",
    "display_color", "display_size", "display_step", "display_percentage", "color_maximum",
    "active_texture", "active_texture_index", "active_instanceweight", "active_instanceweight_index", "child_percent",
}  # fmt: skip


class Modifiers:
    """What the modifiers of objects say."""

    def __init__(self, trees: Trees, geometry: Geometry, scene: bpy.types.Scene) -> None:
        self._trees, self._geometry, self._scene = trees, geometry, scene

    def of(self, item: bpy.types.Object, reads: set[Read]) -> bytes:
        """All that renders heed, in their order; adds what they read of the object."""
        shown = [modifier for modifier in item.modifiers if modifier.show_render]
        parts = [self._one(item, modifier, reads) for modifier in shown]
        if any(modifier.type in _SIMULATED | {"PARTICLE_SYSTEM"} for modifier in shown):
            parts.append(self._forces(reads))
        return digest(*parts) if parts else b""

    def _one(self, item: bpy.types.Object, modifier: bpy.types.Modifier, reads: set[Read]) -> bytes:
        if modifier.type in _SIMULATED | _DRAWN_OVER_TIME:
            reads.add(FRAME)
        if modifier.type in _PLAYED:
            reads.add(EVALUATED)
        if modifier.type == "NODES":
            return self._nodes(item, modifier, reads)
        if modifier.type == "ARMATURE":
            return self._armature(item, modifier, reads)
        groups = _groups(item, modifier)
        parts = [settings(modifier, self._trees.refer, reads, _BOOKKEEPING | {"particle_system"} | groups.keys())]
        parts += self._weights(item, groups)
        if modifier.type == "PARTICLE_SYSTEM":
            parts.append(self._particles(item, modifier.particle_system, reads))
        return digest(*parts)

    def _nodes(self, item: bpy.types.Object, modifier: bpy.types.Modifier, reads: set[Read]) -> bytes:
        tree = modifier.node_group
        if tree is None:
            return b""
        found = self._trees.group(tree)
        reads |= found.reads
        parts = [found.digest]
        typed = compat.typed_inputs_and_outputs(modifier)
        if typed:
            parts += self._inputs(typed[0], found, reads)
            parts.append(settings(typed[1], self._trees.refer, reads))
        else:
            parts += self._custom(modifier, found, reads)
        parts += [digest(group.name, self._geometry.weights.of(item, group.name)) for group in item.vertex_groups]
        return digest(*parts)

    def _inputs(self, inputs: Any, found: Found, reads: set[Read]) -> list[bytes]:
        """The values of a tree's inputs where they have types of their own."""
        return [
            digest(name, settings(getattr(inputs, name), self._trees.refer, reads))
            for name in sorted(found.inputs)
            if inputs.bl_rna.properties.get(name) is not None
        ]

    def _custom(self, modifier: bpy.types.Modifier, found: Found, reads: set[Read]) -> list[bytes]:
        """The values of a tree's inputs where they are custom properties, and the names of attributes."""
        parts = []
        for key in sorted(modifier.keys()):
            name = key.removesuffix("_use_attribute").removesuffix("_attribute_name")
            if name not in found.inputs and not key.endswith("_attribute_name"):
                continue
            value = modifier[key]
            if isinstance(value, str):
                reads.add(("attribute", "GEOMETRY", value))
            is_block = isinstance(value, bpy.types.ID)
            parts.append(digest(key, self._trees.refer(value, reads) if is_block else plain(value)))
        return parts

    def _armature(self, item: bpy.types.Object, modifier: bpy.types.Modifier, reads: set[Read]) -> bytes:
        """Bones by the weights that their groups have; those that move nothing do not count."""
        groups = _groups(item, modifier)
        parts = [settings(modifier, self._trees.refer, reads, _BOOKKEEPING | {"object"} | groups.keys())]
        parts += self._weights(item, groups)
        armature = modifier.object
        if armature is None or armature.pose is None:
            return digest(*parts)
        parts.append(plain((armature.matrix_world, armature.data.pose_position)).encode())
        moving = []
        for pose in armature.pose.bones:
            held = self._geometry.weights.of(item, pose.name) if modifier.use_vertex_groups else b""
            if held or modifier.use_bone_envelopes:
                moving.append(digest(held, bone(armature, pose)))
        return digest(*parts, unordered(moving))

    def _particles(self, item: bpy.types.Object, system: bpy.types.ParticleSystem, reads: set[Read]) -> bytes:
        made = system.settings
        if made.type != "HAIR" or system.use_hair_dynamics:
            reads.add(FRAME)
        groups = _groups(item, system)
        without = ID_BOOKKEEPING | _BOOKKEEPING | {"settings", "cloth", "parent", "dt_frac"} | groups.keys()
        parts = [
            settings(system, self._trees.refer, reads, frozenset(without)),
            settings(made, self._trees.refer, reads, _PARTICLES | {"boids", "fluid"}),
        ]
        parts += self._weights(item, groups)
        if system.is_edited and made.type == "HAIR":
            parts += [many(hair.hair_keys) or b"" for hair in system.particles]
        return digest(*parts)

    def _weights(self, item: bpy.types.Object, groups: dict[str, str]) -> list[bytes]:
        return [digest(name, self._geometry.weights.of(item, groups[name])) for name in sorted(groups)]

    def _forces(self, reads: set[Read]) -> bytes:
        """What pushes simulated things, wherever it is in the scene."""
        fields = [item for item in self._scene.objects if item.field is not None and item.field.type != "NONE"]
        pushing = [digest(plain(item.matrix_world), settings(item.field, self._trees.refer, reads)) for item in fields]
        return digest(plain((self._scene.use_gravity, self._scene.gravity)), unordered(pushing))


def _groups(item: bpy.types.Object, struct: Any) -> dict[str, str]:
    """By property the vertex groups that something names."""
    texts = {p.identifier: getattr(struct, p.identifier) for p in struct.bl_rna.properties if p.type == "STRING"}
    return {name: text for name, text in texts.items() if name != "name" and item.vertex_groups.find(text) >= 0}
