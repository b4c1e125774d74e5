"""What objects are made of: meshes, curves, lamps and so on with their shape keys, before modifiers."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ... import compat
from . import attributes
from .attributes import Layer
from .digests import FRAME, Read, digest, numbers, plain, unordered
from .nodes import Trees
from .pictures import file, held
from .properties import ID_BOOKKEEPING, many, named, settings
from .weights import Weights

_FIXED = ID_BOOKKEEPING | {"materials", "cycles", "shape_keys", "attributes", "color_attributes"}
_CURVE = _FIXED | {
    "path_duration", "use_path", "use_path_follow", "use_path_clamp", "eval_time", "edit_format",
    "is_select_bold", "is_select_italic", "is_select_underline", "is_select_smallcaps", "has_selection",
    "use_fast_edit", "active_textbox",
}  # fmt: skip
_VOLUME = _FIXED | {"filepath", "packed_file", "grids", "display"}
_DRAWN = _FIXED | {
    "layers", "layer_groups", "root_nodes", "use_autolock_layers", "ghost_before_range", "ghost_after_range",
    "use_ghost_custom_colors", "before_color", "after_color", "onion_mode", "onion_keyframe_type", "use_onion_fade",
    "use_onion_loop", "onion_factor",
}  # fmt: skip
_LAMP = _FIXED | {"node_tree", "use_nodes", "show_cone", "temperature_color"}
# Of lamps: what Cycles does not look at, and EEVEE not.
_EEVEE_LAMP = frozenset(
    {"diffuse_factor", "specular_factor", "transmission_factor", "volume_factor", "use_custom_distance"}
    | {"cutoff_distance", "shadow_filter_radius", "shadow_maximum_resolution", "use_shadow_jitter"}
    | {"shadow_jitter_overblur", "use_absolute_resolution", "shadow_cascade_max_distance", "shadow_cascade_count"}
    | {"shadow_cascade_exponent", "shadow_cascade_fade", "shadow_buffer_clip_start"}
)
_CYCLES_LAMP = ("max_bounces", "cast_shadow", "use_multiple_importance_sampling", "is_portal", "is_caustics_light")
_TEXTURE_SPACE = ("use_auto_texspace", "auto_texspace")
_BONE = ("use_deform", "bbone_segments", "envelope_distance", "head_radius", "tail_radius", "envelope_weight")
_KEYED = {"position"}  # what shape keys say instead of the mesh


class Geometry:
    """What data blocks hold, each read once."""

    def __init__(self, trees: Trees, is_eevee: bool, known: dict[int, Any]) -> None:
        """Known: what was read of meshes already, by their addresses, whatever the engine."""
        self.weights = Weights()
        self._trees, self._is_eevee, self._known = trees, is_eevee, known

    def own(self, item: bpy.types.Object, reads: set[Read], is_changed: bool) -> bytes:
        """What an object is made of.

        Args:
            item: the object.
            reads: what its shaders and modifiers read; more is added.
            is_changed: whether modifiers may read all that there is.
        """
        data = item.data
        if data is None:
            return b""
        if isinstance(data, bpy.types.Mesh):
            return self._mesh(item, data, reads, is_changed)
        if isinstance(data, bpy.types.Light):
            return self._lamp(data, reads)
        if isinstance(data, bpy.types.Armature):
            return self._pose(item)
        refer = self._trees.refer
        parts = [self._keys(item)]
        if isinstance(data, bpy.types.Volume):
            parts.append(settings(data, refer, reads, _VOLUME))
            parts.append(held(data.packed_file) if data.packed_file else file(data.filepath, data.library))
            if data.is_sequence:
                reads.add(FRAME)
        elif isinstance(data, (bpy.types.Camera, bpy.types.Speaker)):
            return b""
        elif hasattr(data, "layers"):
            parts += [settings(data, refer, reads, _DRAWN), *self._drawings(data, reads)]
        elif hasattr(data, "attributes"):
            parts.append(self._points(data, reads))
        else:
            parts.append(settings(data, refer, reads, _CURVE))
        return digest(*parts)

    def layers(self, item: bpy.types.Object) -> tuple[Layer, ...]:
        """The attributes of a mesh object."""
        return self._read(item)[0]

    def used_slots(self, item: bpy.types.Object) -> frozenset[int]:
        """The material slots that the faces of a mesh object ask for."""
        return self._read(item)[1]

    def _read(self, item: bpy.types.Object) -> tuple[tuple[Layer, ...], frozenset[int]]:
        key = item.data.as_pointer()
        if key not in self._known:
            self._known[key] = _read_mesh(item)
        return self._known[key]

    def _mesh(self, item: bpy.types.Object, mesh: bpy.types.Mesh, reads: set[Read], is_changed: bool) -> bytes:
        names = {read[2] for read in reads if read[0] == "attribute" and read[1] != "VIEW_LAYER"}
        keys = self._keys(item)
        without = (_KEYED if keys else set()) | (set() if is_changed else {"uv_seam"})
        parts = [attributes.together(self.layers(item), names, is_changed, without), keys]
        if not mesh.use_auto_texspace:
            parts.append(plain((mesh.texspace_location, mesh.texspace_size)))
        for other in (mesh.texco_mesh, mesh.texture_mesh):
            if other is not None:
                parts.append(unordered(layer.digest for layer in attributes.of_mesh(other)))
        if is_changed:
            for layer in mesh.skin_vertices:
                radii = np.empty(2 * len(layer.data), np.float32)
                layer.data.foreach_get("radius", radii)
                parts.append(numbers(radii))
        return digest(*parts)

    def _lamp(self, lamp: bpy.types.Light, reads: set[Read]) -> bytes:
        without = _LAMP if self._is_eevee else _LAMP | _EEVEE_LAMP
        parts = [settings(lamp, self._trees.refer, reads, without)]
        if not self._is_eevee:
            parts.append(named(lamp.cycles, _CYCLES_LAMP))
        if compat.lamp_uses_nodes(lamp):
            output = lamp.node_tree.get_output_node("EEVEE" if self._is_eevee else "CYCLES")
            if output is not None:
                found = self._trees.reaching(output)
                parts.append(found.digest)
                reads |= found.reads
        return digest(*parts)

    def _points(self, data: Any, reads: set[Read]) -> bytes:
        parts = [attributes.together(attributes.of_others(data.attributes), (), True)]
        offsets = getattr(data, "curve_offset_data", ())
        if len(offsets):
            values = np.empty(len(offsets), np.int32)
            offsets.foreach_get("value", values)
            parts.append(numbers(values))
        return digest(*parts)

    def _drawings(self, data: Any, reads: set[Read]) -> list[bytes]:
        parts = []
        for layer in data.layers:
            frame = layer.current_frame()
            if len(layer.frames) > 1:
                reads.add(FRAME)
            without = ID_BOOKKEEPING | {"frames", "parent", "parent_group", "next_node", "prev_node", "lock_frame"}
            own = settings(layer, self._trees.refer, reads, without)
            drawn = self._points(frame.drawing, reads) if frame is not None else b""
            parts.append(digest(own, plain(layer.hide), drawn))
        return parts

    def _keys(self, item: bpy.types.Object) -> bytes:
        """What shape keys make of an object."""
        keys = getattr(item.data, "shape_keys", None)
        if keys is None:
            return b""
        blocks = list(keys.key_blocks)
        if item.show_only_shape_key:
            return digest("only", _shape(blocks[item.active_shape_key_index]))
        if not keys.use_relative:
            return digest(
                plain(keys.eval_time), *(digest(plain((k.frame, k.interpolation)), _shape(k)) for k in blocks)
            )
        parts = [_shape(keys.reference_key)]
        for block in blocks:
            if block != keys.reference_key and block.value and not block.mute:
                part = self.weights.of(item, block.vertex_group)
                parts.append(digest(plain(block.value), _shape(block), _shape(block.relative_key), part))
        return digest(*parts)

    @staticmethod
    def _pose(item: bpy.types.Object) -> bytes:
        """Where the bones are that may move something."""
        return unordered(bone(item, pose) for pose in item.pose.bones) if item.pose else b""


def bone(armature: bpy.types.Object, pose: bpy.types.PoseBone) -> bytes:
    """Where a bone is, where it rests, and how it bends what it moves."""
    rest = pose.bone
    parts = [plain((pose.matrix, rest.matrix_local, rest.length)).encode(), named(rest, _BONE)]
    if rest.bbone_segments > 1:
        parts.append(named(pose, tuple(p.identifier for p in pose.bl_rna.properties if "bbone" in p.identifier)))
    return digest(*parts)


def _read_mesh(item: bpy.types.Object) -> tuple[tuple[Layer, ...], frozenset[int]]:
    if not item.data.is_editmode:
        return attributes.of_mesh(item.data), attributes.materials_of_faces(item.data)
    item.update_from_editmode()
    mesh = item.to_mesh()  # attributes cannot be read while a mesh is edited, but those of its copy
    try:
        return attributes.of_mesh(mesh), attributes.materials_of_faces(mesh)
    finally:
        item.to_mesh_clear()


def _shape(block: bpy.types.ShapeKey) -> bytes:
    points = block.points if len(block.points) else block.data
    if not len(points):
        return b""
    kinds = {type(point).__name__ for point in points} if points is block.data else {type(points[0]).__name__}
    if len(kinds) == 1:
        return many(points) or b""
    return digest(*(plain([getattr(p, "co", None), getattr(p, "handle_left", None)]) for p in points))
