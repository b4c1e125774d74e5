"""Materials and worlds by what they show, as an engine reads them."""

from __future__ import annotations

from typing import Any

import bpy

from ... import compat, marks
from ..nodes import output_of
from .digests import MATERIAL_INDEX, Found, Read, digest, plain
from .nodes import Trees
from .properties import ID_BOOKKEEPING, named, settings

_BOTH = ("displacement_method", "use_transparent_shadow")
_EEVEE = (
    "surface_render_method", "use_transparency_overlap", "use_backface_culling", "use_backface_culling_shadow",
    "use_backface_culling_lightprobe_volume", "use_raytrace_refraction", "thickness_mode", "use_thickness_from_shadow",
    "volume_intersection_method", "max_vertex_displacement",
)  # fmt: skip
# Not how emission is sampled: that is noise, and injecting changes it.
_CYCLES = (
    "use_bump_map_correction", "volume_sampling", "volume_interpolation", "volume_step_rate", "homogeneous_volume",
)  # fmt: skip
_PLAIN = ("diffuse_color", "metallic", "roughness", "specular_intensity", "specular_color")
_WORLD_EEVEE = (
    "probe_resolution", "sun_threshold", "sun_angle", "use_sun_shadow", "sun_shadow_maximum_resolution",
    "sun_shadow_filter_radius", "use_sun_shadow_jitter", "sun_shadow_jitter_overblur", "use_eevee_finite_volume",
)  # fmt: skip
_WORLD_CYCLES = (
    "max_bounces", "volume_sampling", "volume_interpolation", "volume_step_size", "homogeneous_volume", "use_shadows",
    "is_caustics_light",
)  # fmt: skip
# Captures let cameras see what glossy rays see.
_WORLD_RAYS = ("diffuse", "glossy", "transmission", "scatter", "shadow")


class Materials:
    """The materials of a file, each read once for an engine."""

    def __init__(self, trees: Trees, is_eevee: bool) -> None:
        self._trees, self._is_eevee = trees, is_eevee
        self._known: dict[int, Found] = {}

    def of(self, worn: bpy.types.Material) -> Found:
        """What a material shows; a copy of ours shows what the user's own does."""
        material = marks.original(worn)
        key = material.as_pointer()
        if key not in self._known:
            self._known[key] = self._read(material)
        return self._known[key]

    def world(self, world: bpy.types.World | None) -> Found:
        """What a world shows."""
        if world is None:
            return Found(b"no world")
        parts = [plain(world.color)]
        reads: frozenset[Read] = frozenset()
        output = world.node_tree.get_output_node(self._engine) if compat.uses_nodes(world) else None
        if output is not None:
            found = self._trees.reaching(output)
            parts.append(found.digest)
            reads = found.reads
        if self._is_eevee:
            parts.append(named(world, _WORLD_EEVEE))
        else:
            parts += [named(world.cycles, _WORLD_CYCLES), named(world.cycles_visibility, _WORLD_RAYS)]
        return Found(digest(*parts), reads)

    @property
    def _engine(self) -> str:
        return "EEVEE" if self._is_eevee else "CYCLES"

    def _read(self, material: bpy.types.Material) -> Found:
        parts: list[Any] = [named(material, _BOTH)]
        parts.append(named(material, _EEVEE) if self._is_eevee else named(material.cycles, _CYCLES))
        reads: frozenset[Read] = frozenset()
        if material.is_grease_pencil:
            own: set[Read] = set()
            parts.append(settings(material.grease_pencil, self._trees.refer, own, ID_BOOKKEEPING))
            reads = frozenset(own)
        if not compat.uses_nodes(material):
            parts.append(named(material, _PLAIN))
        else:
            output = output_of(material, self._engine)
            if output is not None:
                found = self._trees.reaching(output)
                parts.append(found.digest)
                reads |= found.reads
        if MATERIAL_INDEX in reads:
            parts.append(plain(material.pass_index))
        return Found(digest(*parts), reads - {MATERIAL_INDEX})
