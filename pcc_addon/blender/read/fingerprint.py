"""What a bake depends on, as one hash: another hash means that the bake is stale."""

from __future__ import annotations

import hashlib
from collections.abc import Container, Iterable
from dataclasses import fields
from enum import Enum
from functools import lru_cache
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ...core.errors import ProbeError
from ...core.picture_files import digest, picture_files
from ...core.probe import ProbeSpec, Source
from .. import marks
from .evaluated import evaluated, plays_pictures
from .scene import rendered_objects

_OBJECT_FLAGS = ("visible_glossy", "visible_diffuse", "visible_transmission", "visible_shadow", "is_shadow_catcher")
_CYCLES = (
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "volume_bounces",
    "transparent_max_bounces",
    "sample_clamp_direct",
    "sample_clamp_indirect",
    "caustics_reflective",
    "caustics_refractive",
    "blur_glossy",
    "use_fast_gi",
)
# Fields of a probe's record that its pictures depend on; the capture point stands for the box and the offset.
_CAPTURED = [
    field.name
    for field in fields(ProbeSpec)
    if field.name
    not in {"name", "box", "capture_offset", "padding", "falloff", "outside", "corrected", "hidden", "animated"}
    | {"source", "picture", "influence", "followed", "contact_hardening", "forced"}
]
_NOT_SEEN = {"EMPTY", "CAMERA", "SPEAKER", "ARMATURE", "LATTICE"}
_ID_BOOKKEEPING = {p.identifier for p in bpy.types.ID.bl_rna.properties}
_NODE_BOOKKEEPING = {p.identifier for p in bpy.types.Node.bl_rna.properties} - {"mute"}
_DRAWN = {"color_ramp", "mapping"}  # values of a node that are no inputs
_MODIFIER_BOOKKEEPING = {"is_active", "show_expanded", "show_in_editmode", "show_on_cage", "execution_time"}


class SceneFingerprint:
    """The part of the hash that all probes of a scene share; read once for a bake of many."""

    def __init__(self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
        self._objects = {
            item.name_full: _object(item)
            for item in rendered_objects(scene, view_layer)
            if not item.hide_render and (item.type not in _NOT_SEEN or item.instance_type != "NONE")
        }
        for name, made in evaluated(scene, view_layer).items():
            if name in self._objects:
                self._objects[name] += made
        self._seen = self._without(())
        lines = [f"cycles.{name} {getattr(scene.cycles, name)}" for name in _CYCLES]
        world = []
        if scene.world:
            world.append(f"world {scene.world.color[:]}")
            world += node_lines(scene.world.node_tree)
            world += [f"frame {scene.frame_current_final}"] * plays_pictures(scene.world.node_tree)
        lines += world
        self._world = "\n".join(world)
        self._setting = "\n".join(lines)

    def content_hash(self, probe: ProbeSpec) -> str:
        """A hexadecimal SHA-256 of all that the probe's pictures depend on.

        Raises:
            ProbeError: they are to come from an image that is not there.
        """
        if probe.source is Source.IMAGE:
            return _hash_of_image(probe)
        if probe.source is Source.WORLD:
            return self._hash_of_world(probe)
        digest = hashlib.sha256(self._setting.encode())
        settings = (getattr(probe, name) for name in _CAPTURED)
        plain = [setting.value if isinstance(setting, Enum) else setting for setting in settings]
        digest.update(repr((tuple(np.float32(probe.capture_point).tolist()), *plain)).encode())
        digest.update(self._seen if not probe.hidden else self._without(probe.hidden))
        return digest.hexdigest()

    def _without(self, hidden: Container[str]) -> bytes:
        return b"".join(self._objects[name] for name in sorted(self._objects) if name not in hidden)

    def _hash_of_world(self, probe: ProbeSpec) -> str:
        """The world, the settings of its renders, and the box's axes, which the picture has."""
        settings = (probe.engine.value, probe.resolution, probe.samples, probe.denoise)
        axes = (np.round(probe.box.face_normals, 5) + 0.0).tolist()  # no negative zeros
        return hashlib.sha256(f"world {settings} {axes}\n{self._world}".encode()).hexdigest()


def _hash_of_image(probe: ProbeSpec) -> str:
    files = picture_files(probe.name, probe.picture)
    try:
        stats = [file.stat() for file in files]
        held = _digest(files, tuple((stat.st_mtime_ns, stat.st_size) for stat in stats))
    except OSError as error:
        raise ProbeError(
            f"probe '{probe.name}': its picture '{files[0]}' cannot be read ({error.strerror}); choose another"
        ) from error
    return hashlib.sha256(f"image {probe.resolution} {held}".encode()).hexdigest()


@lru_cache(maxsize=256)
def _digest(files: tuple[Path, ...], written: tuple[tuple[int, int], ...]) -> str:
    """What files hold; read again only where one was written since."""
    return digest(files)


def _object(item: bpy.types.Object) -> bytes:
    digest = hashlib.sha256(f"{item.name_full} {item.type} {[getattr(item, f) for f in _OBJECT_FLAGS]}".encode())
    digest.update(np.array(item.matrix_world, np.float32).tobytes())
    for modifier in item.modifiers:
        digest.update("\n".join(_properties(modifier, _MODIFIER_BOOKKEEPING)).encode())
    data = item.data
    if isinstance(data, bpy.types.Mesh):
        _mesh(data, digest)
    elif data is not None:
        digest.update("\n".join(_properties(data, _ID_BOOKKEEPING)).encode())
        digest.update("\n".join(node_lines(getattr(data, "node_tree", None))).encode())
    for slot in item.material_slots:
        if slot.material:
            digest.update(marks.original(slot.material).name_full.encode())
            digest.update("\n".join(node_lines(slot.material.node_tree)).encode())
    return digest.digest()


_ATTRIBUTE_FIELDS = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "BOOLEAN": ("value", np.bool_, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "INT32_2D": ("value", np.int32, 2),
}
_SELECTION = (
    ".select_vert",
    ".select_edge",
    ".select_poly",
    ".hide_vert",
    ".hide_edge",
    ".hide_poly",
    ".vs.",
    ".es.",
    ".pn.",
)


def _mesh(mesh: bpy.types.Mesh, digest: Any) -> None:
    for attribute in mesh.attributes:
        if attribute.data_type in _ATTRIBUTE_FIELDS and not attribute.name.startswith(_SELECTION):
            field, dtype, width = _ATTRIBUTE_FIELDS[attribute.data_type]
            values = np.empty(len(attribute.data) * width, dtype)
            attribute.data.foreach_get(field, values)
            digest.update(f"{attribute.name} {attribute.domain}".encode() + values.tobytes())
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    digest.update(starts.tobytes())


_MATERIAL_BOOKKEEPING = _ID_BOOKKEEPING | {
    "cycles",
    "grease_pencil",
    "lineart",
    "paint_active_slot",
    "paint_clone_slot",
}


def material_lines(material: bpy.types.Material) -> list[str]:
    """Lines that change when a material changes, its name apart; what is ours in it is left out."""
    cycles = _properties(material.cycles, {"name", "emission_sampling"})
    return [*_properties(material, _MATERIAL_BOOKKEEPING), *cycles, *node_lines(material.node_tree)]


def node_lines(tree: bpy.types.NodeTree | None, seen: set[str] | None = None, *, values: bool = True) -> list[str]:
    """Lines that change when a shader changes; our own nodes and the choice of the output are left out.

    Args:
        tree: the shader's nodes; None gives no line.
        seen: names of trees that have had their lines.
        values: whether the values, ramps and curves of the tree's own nodes count; those within groups always do.
    """
    seen = set() if seen is None else seen
    if tree is None or tree.name_full in seen:
        return []
    seen.add(tree.name_full)
    lines = []
    for node in tree.nodes:
        if marks.role(node):
            continue
        lines.append(f"node {node.name} {node.bl_idname}")
        skipped = _NODE_BOOKKEEPING | {"is_active_output", "target"} | (set() if values else _DRAWN)
        lines += _properties(node, skipped)
        for socket in node.inputs if values else ():
            value = getattr(socket, "default_value", None)
            lines.append(f"  {socket.identifier} {_plain(value)}")
        inner = getattr(node, "node_tree", None)
        if inner is None or marks.role(inner) != marks.BY_HAND:  # captures see that black, whatever is in it
            lines += node_lines(inner, seen)
    lines += [
        f"link {link.from_node.name}.{link.from_socket.identifier} {link.to_node.name}.{link.to_socket.identifier}"
        f"{' muted' * link.is_muted}"
        for link in tree.links
        if not marks.role(link.from_node) and not marks.role(link.to_node)
    ]
    return lines


def _properties(struct: Any, without: Iterable[str]) -> list[str]:
    skipped = set(without) | {"rna_type"}
    return [
        f"  {p.identifier} {_plain(getattr(struct, p.identifier))}"
        for p in struct.bl_rna.properties
        if p.identifier not in skipped and p.type != "COLLECTION"
    ]


def _contents(struct: Any) -> list[str]:
    """The properties of a colour ramp or of curves, and those of their points."""
    lines = _properties(struct, {"select"})
    for p in struct.bl_rna.properties:
        if p.type == "COLLECTION":
            lines += [line for part in getattr(struct, p.identifier) for line in _contents(part)]
    return lines


def _plain(value: Any) -> str:
    if isinstance(value, bpy.types.ID):
        return value.name_full
    if isinstance(value, (bpy.types.ColorRamp, bpy.types.CurveMapping)):
        return repr(_contents(value))
    if isinstance(value, bpy.types.bpy_struct):
        return type(value).__name__
    if hasattr(value, "__len__") and not isinstance(value, (str, set)):
        return repr([round(v, 7) if isinstance(v, float) else str(v) for v in value])
    if isinstance(value, set):
        return repr(sorted(value))
    return repr(value)
