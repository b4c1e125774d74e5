"""Objects and their instances by what they are, where they are and how they look: which of them does not count."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ..moving import is_animated
from ..probes import is_disabled
from .bounds import Bounds
from .digests import COLOR, EVALUATED, FRAME, INDEX, RANDOM, Found, Read, digest, plain, unordered
from .evaluated import Shapes
from .geometry import Geometry
from .materials import Materials
from .modifiers import Modifiers
from .nodes import Trees
from .pictures import file, held
from .properties import ID_BOOKKEEPING, named, settings
from .rendered import of_collection, rendered

_RAYS = ("visible_diffuse", "visible_glossy", "visible_transmission", "visible_volume_scatter", "visible_shadow")
_FLAGS = (
    "is_shadow_catcher", "visible_raycast", "show_instancer_for_render", "add_rest_position_attribute",
    "shadow_terminator_geometry_offset", "shadow_terminator_shading_offset", "shadow_terminator_normal_offset",
)  # fmt: skip
_CYCLES = (
    "use_camera_cull", "use_distance_cull", "ao_distance", "is_caustics_caster", "is_caustics_receiver",
    "use_adaptive_subdivision", "dicing_rate",
)  # fmt: skip
_EEVEE = ("hide_probe_volume", "hide_probe_sphere", "hide_probe_plane")
_INSTANCES = ("instance_type", "use_instance_vertices_rotation", "use_instance_faces_scale", "instance_faces_scale")
_BY_SHAPE = {"VERTS", "FACES"}  # instances at the vertices or faces of an object
_NOT_SEEN = {"EMPTY", "CAMERA", "SPEAKER", "ARMATURE", "LATTICE"}


@dataclass(frozen=True, eq=False)
class Placed:
    """An object, with the instances of a collection that it makes.

    Attributes:
        digest: of what it shows.
        boxes: (n, 8, 3) float64: corners of boxes around all of that, world space; None where nobody can tell.
    """

    digest: bytes
    boxes: np.ndarray | None


class Objects:
    """The objects of a scene at its frame, as one engine shows them; each is read once."""

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        is_eevee: bool,
        meshes: dict[int, Any],
        shapes: Shapes,
    ) -> None:
        """What a scene shows.

        Args:
            scene, view_layer: what is rendered.
            is_eevee: by which engine.
            meshes: what is known of meshes whatever the engine; more is added.
            shapes: what Blender makes of objects at this frame.
        """
        self._scene, self._view_layer, self._is_eevee, self._shapes = scene, view_layer, is_eevee, shapes
        self._frame = f"frame {scene.frame_current_final}".encode()
        self._trees = Trees(self._refer, scene.frame_current)
        self.materials = Materials(self._trees, is_eevee)
        self._geometry = Geometry(self._trees, is_eevee, meshes)
        self._modifiers = Modifiers(self._trees, self._geometry, scene)
        self._bounds = Bounds(view_layer)
        self._known: dict[int, Found] = {}
        self._shaped: dict[int, tuple[bytes, frozenset[Read]]] = {}
        self._begun: set[int] = set()  # what is being read: whatever points back to it stops there
        self._met = 0  # how often something did
        self._shown = tuple(rendered(scene, view_layer))

    def seen(self, hidden: Set[str]) -> bytes:
        """A digest of all that a capture shows which leaves objects of these names out."""
        return unordered(found.digest for found in self._all(self._shown, hidden))

    def extras(self, found: Found) -> list[bytes]:
        """What a shader that belongs to no object reads: the frame, and attributes of the view layer."""
        owners = (self._view_layer, self._scene, self._scene.world)
        parts = [self._frame] if FRAME in found.reads else []
        return parts + [
            _attribute(owners, read[2]) for read in sorted(found.reads) if read[:2] == ("attribute", "VIEW_LAYER")
        ]

    def each(self, hidden: Set[str]) -> Iterator[bpy.types.Object]:
        """The objects of `seen`, and those that they make instances of."""
        for item in self._shown:
            yield from (leaf for leaf, _ in self._leaves(item, hidden, None))

    def placed(self, hidden: Set[str]) -> Iterator[Placed]:
        """All of `seen` one by one, with where it is."""
        for item in self._shown:
            leaves = list(self._leaves(item, hidden, np.eye(4)))
            if leaves:
                boxes = [self._bounds.of(leaf, place) for leaf, place in leaves]
                known = None if any(box is None for box in boxes) else np.stack(boxes)
                yield Placed(digest(*(found.digest for found in self._all((item,), hidden))), known)

    def _all(self, items: Iterable[bpy.types.Object], hidden: Set[str]) -> Iterator[Found]:
        """What objects show, and the instances that they make."""
        for item in items:
            if item.hide_render or item.name in hidden:
                continue
            if self._is_seen(item):
                yield self._object(item)
            if item.instance_type == "COLLECTION" and item.instance_collection is not None:
                yield self._instances(item, hidden)

    def _leaves(
        self, item: bpy.types.Object, hidden: Set[str], place: np.ndarray | None
    ) -> Iterator[tuple[bpy.types.Object, np.ndarray | None]]:
        """An object and the instances of collections that it makes; and (4, 4) where their own matrices lead to.

        The latter is None where nobody can tell.
        """
        if item.hide_render or item.name in hidden:
            return
        if self._is_seen(item):
            yield item, place
        collection = item.instance_collection
        if item.instance_type == "COLLECTION" and collection is not None:
            inner = None if place is None else self._bounds.of_instances(item, place)
            for each in of_collection(collection):
                yield from self._leaves(each, hidden, inner)

    def _is_seen(self, item: bpy.types.Object) -> bool:
        return (item.type not in _NOT_SEEN or item.instance_type in _BY_SHAPE) and self._is_lit(item)

    def _is_lit(self, item: bpy.types.Object) -> bool:
        """Whether anything but a camera sees an object; captures see what glossy rays see."""
        if item.type == "LIGHT_PROBE":
            return self._is_eevee
        return any(getattr(item, name) for name in _RAYS) or (self._is_eevee and item.type == "LIGHT")

    def _instances(self, item: bpy.types.Object, hidden: Set[str]) -> Found:
        collection = item.instance_collection
        found = list(self._all(of_collection(collection), hidden))
        reads = frozenset().union(*(each.reads for each in found))
        parts = [
            "instances",
            plain((item.matrix_world, collection.instance_offset)),
            named(item, _RAYS),
            # What renderers make of a name and a place in the list is another number in another order.
            digest(*(each.digest for each in found)) if RANDOM in reads else unordered(each.digest for each in found),
            *self._read_of(item, reads, "INSTANCER"),
        ]
        return Found(digest(*parts), reads)

    def _object(self, item: bpy.types.Object) -> Found:
        key = item.as_pointer()
        if key not in self._known:
            begun, self._begun = self._begun, {key}
            self._known[key] = self._read(item)
            self._begun = begun
        return self._known[key]

    def _read(self, item: bpy.types.Object) -> Found:
        looks, reads = self._looks(item)
        shape, more = self._shape(item, reads)
        reads |= more
        parts = [
            item.type,
            plain(item.matrix_world),
            named(item, _RAYS + _FLAGS + (_EEVEE if self._is_eevee else ())),
            looks,
            shape,
        ]
        if not self._is_eevee:
            parts.append(named(item.cycles, _CYCLES))
        parts.append(self._lighting(item))
        if item.instance_type in _BY_SHAPE:
            children = [child for child in item.children if not child.hide_render]
            parts += [named(item, _INSTANCES), unordered(self._object(child).digest for child in children)]
        if item.type == "META":
            parts.append(self._family(item))
        parts += self._read_of(item, reads, "OBJECT")
        return Found(digest(*parts), frozenset(reads))

    def _read_of(self, item: bpy.types.Object, reads: Set[Read], kind: str) -> list[bytes]:
        """What shaders read of an object beside its shape."""
        parts = []
        if RANDOM in reads:  # renderers make it of the name
            parts.append(digest("random", item.name))
        if COLOR in reads:
            parts.append(digest("colour", plain(item.color)))
        if INDEX in reads:
            parts.append(digest("index", plain(item.pass_index)))
        if FRAME in reads:
            parts.append(self._frame)
        for read in sorted(reads):
            if read[0] == "attribute" and read[1] in {kind, "INSTANCER"}:
                parts.append(digest(*read, _attribute((item, item.data), read[2])))
            if read[:2] == ("attribute", "VIEW_LAYER"):
                owners = (self._view_layer, self._scene, self._scene.world)
                parts.append(digest(*read, _attribute(owners, read[2])))
        return parts

    def _looks(self, item: bpy.types.Object) -> tuple[bytes, set[Read]]:
        """The materials that an object shows; slots that no face asks for do not count."""
        override = self._view_layer.material_override
        slots = [slot.material for slot in item.material_slots]
        if override is not None and item.type not in {"LIGHT", "LIGHT_PROBE"}:
            slots = [override] * max(len(slots), 1)
        used = set(range(len(slots)))
        if isinstance(item.data, bpy.types.Mesh) and not item.modifiers and slots:
            used = {min(max(slot, 0), len(slots) - 1) for slot in self._geometry.used_slots(item)}
        parts, reads = [], set()
        for k in sorted(used):
            material = slots[k]
            found = self.materials.of(material) if material else Found(b"no material")
            parts.append(digest(str(k), found.digest))
            reads |= found.reads
        return digest(*parts), reads

    def _shape(
        self, item: bpy.types.Object, wanted: Set[Read] = frozenset(), whole: bool = False
    ) -> tuple[bytes, set[Read]]:
        """What an object is made of, for who reads of it what is wanted, or possibly the whole."""
        reads = set(wanted)
        changed = self._modifiers.of(item, reads)
        own = self._geometry.own(item, reads, whole or bool(changed))
        parts = [changed, own]
        if _is_left_behind(item, self._view_layer):
            reads.add(FRAME)
        if EVALUATED in reads:
            reads.discard(EVALUATED)
            parts.append(self._shapes.of(item) or self._frame)
        if FRAME in reads:
            parts.append(self._frame)
        return digest(*parts), reads

    def _family(self, item: bpy.types.Object) -> bytes:
        """Metaballs whose names have the same beginning flow together, and the one without a number says how."""
        beginning = item.name.partition(".")[0]
        family = [o for o in self._shown if o.type == "META" and o.name.partition(".")[0] == beginning]
        members = [
            digest(plain((o.name == beginning, o.matrix_world)), self._shape(o)[0]) for o in family if not o.hide_render
        ]
        return unordered(members)

    def _lighting(self, item: bpy.types.Object) -> bytes:
        """Which objects a lamp lights, and which throw shadows of it."""
        linking = item.light_linking
        parts = []
        for collection in (linking.receiver_collection, linking.blocker_collection):
            if collection is None:
                parts.append(b"all")
                continue
            members = [
                digest(linked.light_linking.link_state, self._refer(member, set()))
                for of, links in (
                    (collection.objects, collection.collection_objects),
                    (collection.children, collection.collection_children),
                )
                for member, linked in zip(of, links, strict=True)
            ]
            parts.append(unordered(members))
        return digest(*parts)

    def _refer(self, item: bpy.types.ID, reads: set[Read]) -> bytes:
        """The digest of a data block that something points to."""
        if isinstance(item, bpy.types.Object):
            return self._reference(item, reads)
        if isinstance(item, bpy.types.Material):
            found = self.materials.of(item)
            reads |= found.reads
            return found.digest
        if isinstance(item, bpy.types.Image):
            return self._trees.image(item)
        if isinstance(item, bpy.types.Collection):
            return unordered(self._reference(each, reads) for each in of_collection(item) if not each.hide_render)
        if isinstance(item, bpy.types.NodeTree):
            found = self._trees.group(item)
            reads |= found.reads
            return found.digest
        if isinstance(item, bpy.types.Text):
            return item.as_string().encode()
        if isinstance(item, (bpy.types.VectorFont, bpy.types.Sound)):
            return held(item.packed_file) if item.packed_file else file(item.filepath, item.library)
        if isinstance(item, (bpy.types.Texture, bpy.types.ParticleSettings, bpy.types.CacheFile)):
            return settings(item, self._refer, reads, ID_BOOKKEEPING)
        return type(item).__name__.encode()

    def _reference(self, item: bpy.types.Object, reads: set[Read]) -> bytes:
        """Where an object is that something points to, and what it is made of."""
        key = item.as_pointer()
        if key in self._shaped:
            found = self._shaped[key]
        elif key in self._begun:
            self._met += 1
            return b"itself"
        else:
            met = self._met
            self._begun.add(key)
            looks, more = self._looks(item)
            shape, own = self._shape(item, frozenset(), True)
            self._begun.discard(key)
            found = digest(plain(item.matrix_world), looks, shape), frozenset(more | own)
            if met == self._met:  # it is the same whoever asks
                self._shaped[key] = found
        whole, more = found
        reads |= {read for read in more if read[0] != "attribute"}
        return whole


def _is_left_behind(item: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> bool:
    """Whether animation moves an object in renders and not in what can be read."""
    return is_disabled(item, view_layer) and is_animated(item)


def _attribute(owners: Iterable[Any], name: str) -> bytes:
    """What an Attribute node finds by a name: the first custom property or property path of some owners."""
    for owner in owners:
        if owner is None:
            continue
        if name in owner:
            return plain(owner[name]).encode()
        try:
            return plain(owner.path_resolve(name)).encode()
        except ValueError:
            continue
    return b"none"
