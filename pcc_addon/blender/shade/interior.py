"""Window materials: a group that shows rooms behind a pane, and the material around it. Neither needs the add-on."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial

import bpy

from ...core.effects import interior as formula
from ...core.effects.interior import Cells, Interior, RoomPicture
from ...core.errors import PccError
from ...core.sidecar import Sidecar
from ...core.window import Side, room_of
from .. import marks, unrecorded
from ..read.probes import bake_record
from ..store.levels import picture_rows
from ..store.pictures import check_pixels
from . import playback
from .groups import formula_group
from .node_builder import Surroundings, declare_sockets, emit

MOST_ROOMS = 8  # EEVEE reads thirty pictures in a material, and panes may show a probe as well
_RECORD = "record"  # note on a group: what it computes
_COLOURS = frozenset({"Radiance", "Tint A", "Tint B"})


@dataclass(frozen=True)
class Socket:
    """An input of the group: what it is called, holds at first, may hold at most, and means."""

    name: str
    default: float | tuple[float, ...]
    meaning: str
    low: float = 0.0
    high: float = 1.0
    subtype: str = "NONE"


_LENGTH = {"low": 0.001, "high": 1e4, "subtype": "DISTANCE"}
SOCKETS = (
    Socket("Width", 4.0, "Of a room: how often rooms repeat along the pane", **_LENGTH),
    Socket("Height", 3.0, "Of a room: how often rooms repeat up the pane", **_LENGTH),
    Socket("Depth", 4.0, "Of a room, behind the pane", **_LENGTH),
    Socket("Offset", (0.0, 0.0, 0.0), "Shifts the rooms to the left (X) and down (Y), in rooms", -1e4, 1e4),
    Socket("Up", (0.0, 0.0, 1.0), "What is up in the object's own axes; panes that lie have +Y above", -1.0, 1.0),
    Socket("Real Size", 1.0, "1: sizes are metres whatever the object's scale. 0: they are scaled with the object"),
    Socket("Seed", 0.0, "Another number, other rooms", -1e4, 1e4),
    Socket("Per Object", 1.0, "1: objects and instances have rooms of their own. 0: all have the same", 0.0, 1.0),
    Socket("Turns", 0.0, "Quarter turns. 0: none; 0.5: none or one; 1: none to three, each as likely"),
    Socket("Mirrored", 0.5, "Share of the rooms that are mirrored left to right", subtype="FACTOR"),
    Socket("Lit", 1.0, "Share of the rooms that are lit", subtype="FACTOR"),
    Socket("Strength", 1.0, "Of the light from lit rooms", high=1e6),
    Socket("Dark Strength", 0.05, "Of the light from the others", high=1e6),
    Socket("Tint A", (1.0, 1.0, 1.0, 1.0), "Each room's light has a colour between this"),
    Socket("Tint B", (1.0, 1.0, 1.0, 1.0), "and this"),
    Socket("Middle", 1.0, "Share of the rooms that have the middle layer", subtype="FACTOR"),
    Socket("Middle Depth", 0.5, "Where it stands: 0 at the pane, 1 at the back wall", subtype="FACTOR"),
    Socket("Curtains", 0.5, "Share of the rooms that have the curtains", subtype="FACTOR"),
    Socket("Curtain Depth", 0.02, "Where they hang: 0 at the pane, 1 at the back wall", subtype="FACTOR"),
    Socket("IOR", 1.5, "Of the glass, which lets less through at grazing angles. 1: no glass", 1.0, 4.0),
)
_OUTPUTS = {
    "Radiance": "The light of the room behind the pane",
    "Cell": "Which room it is: its numbers along and up the pane, and what its variety comes from",
    "Random": "Three random numbers of the room, for anything else that varies",
    "Is Lit": "1 where the room is lit, else 0",
}


@dataclass(frozen=True)
class RoomImage:
    """A picture to choose rooms from.

    Attributes:
        picture: what it shows.
        image: equirectangular.
        uid, side: of the probe that it was baked by; None for other pictures.
    """

    picture: RoomPicture
    image: bpy.types.Image
    uid: str | None = None
    side: Side = Side.MINUS_Y


@dataclass(frozen=True)
class Window:
    """What a window material is made of.

    Attributes:
        rooms: the pictures of rooms, one to `MOST_ROOMS`.
        cells: what divides its panes.
        middle, curtains: flat pictures with alpha, or None.
    """

    rooms: tuple[RoomImage, ...]
    cells: Cells = Cells.OBJECT
    middle: bpy.types.Image | None = None
    curtains: bpy.types.Image | None = None

    @property
    def record(self) -> Interior:
        """What its group computes."""
        pictures = tuple(room.picture for room in self.rooms)
        return Interior(pictures, self.cells, self.middle is not None, self.curtains is not None)

    @property
    def images(self) -> dict[str, bpy.types.Image]:
        """The pictures by the names that the formula gives them."""
        found = {f"Room {k}": room.image for k, room in enumerate(self.rooms)}
        layers = {formula.MIDDLE_PICTURE: self.middle, formula.CURTAIN_PICTURE: self.curtains}
        return found | {name: image for name, image in layers.items() if image is not None}


def room_of_probe(probe: bpy.types.Object, side: Side = Side.MINUS_Y) -> RoomImage:
    """The room that a baked probe shows through a wall of its box.

    Raises:
        PccError: it has no bake, or its record or picture is damaged.
    """
    record = bake_record(probe)
    if record is None:
        raise PccError(f"probe '{probe.name}' has no bake to show behind a window; bake it first")
    return _room(probe, record, side)


def _room(probe: bpy.types.Object, record: Sidecar, side: Side) -> RoomImage:
    level = next((level for level in probe.pcc_probe.levels if level.roughness == 0.0), None)
    rows = check_pixels(probe.name, None) if level is None else picture_rows(probe, level)
    return RoomImage(room_of(record, side, rows), level.image, record.uid, side)


def window_material(name: str, window: Window, values: Mapping[str, float | Sequence[float]]) -> bpy.types.Material:
    """A material of black glass in which one sees rooms; `values` are inputs of its group.

    Raises:
        PccError: there are no rooms, or more than a material can read.
    """
    if not 1 <= len(window.rooms) <= MOST_ROOMS:
        raise PccError(f"material '{name}': {len(window.rooms)} rooms to choose from; give 1 to {MOST_ROOMS}")
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    glass = next(n for n in nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    rooms = nodes.new("ShaderNodeGroup")
    rooms.node_tree = window_group(name, window)
    rooms.name = rooms.label = "Interior"
    rooms.location, rooms.width = (glass.location.x - 300.0, glass.location.y), 200.0
    for key, value in values.items():
        rooms.inputs[key].default_value = value
    for key, value in (("Base Color", (0.0, 0.0, 0.0, 1.0)), ("Roughness", 0.0), ("Emission Strength", 1.0)):
        glass.inputs[key].default_value = value
    glass.inputs["IOR"].default_value = rooms.inputs["IOR"].default_value
    links.new(rooms.outputs["Radiance"], glass.inputs["Emission Color"])
    material.cycles.emission_sampling = "NONE"  # a façade of lamps would be noise
    return material


def interior_node(material: bpy.types.Material) -> bpy.types.Node | None:
    """The node of a material's own tree that shows rooms, or None."""
    nodes = material.node_tree.nodes if material.node_tree else ()
    groups = (n for n in nodes if n.bl_idname == "ShaderNodeGroup" and n.node_tree is not None)
    return next((node for node in groups if marks.role(node.node_tree) == marks.WINDOW), None)


def window_group(name: str, window: Window) -> bpy.types.ShaderNodeTree:
    """A new group that shows a window's rooms, its inputs documented and with the values that `SOCKETS` says."""
    tree = unrecorded.new_group(f"PCC Interior {name}")
    marks.tag(tree, marks.WINDOW)
    kinds = {s.name: _kind(s) for s in SOCKETS if s.name in formula.interior(window.record).inputs}
    declare_sockets(tree, "INPUT", kinds)
    _build(tree, window)
    for item in tree.interface.items_tree:
        if item.in_out == "OUTPUT":
            item.description = _OUTPUTS[item.name]
    for socket in SOCKETS:
        if socket.name in kinds:
            _describe(tree, socket)
    return tree


def follow_bake(probe: bpy.types.Object) -> None:
    """Let windows that show a probe show its newest bake. Those in other files show theirs until taken anew."""
    record = bake_record(probe)
    for tree in bpy.data.node_groups:
        if record is None or marks.role(tree) != marks.WINDOW or tree.library:
            continue
        rooms = json.loads(marks.noted(tree, marks.ROOMS))
        if any(room["uid"] == record.uid for room in rooms):
            window = _window_of(tree)
            fresh = [_room(probe, record, shown.side) if shown.uid == record.uid else shown for shown in window.rooms]
            _build(tree, replace(window, rooms=tuple(fresh)))


def _window_of(tree: bpy.types.ShaderNodeTree) -> Window:
    """What a group was built from."""
    record = json.loads(marks.noted(tree, _RECORD))
    images = {node.name: node.image for node in tree.nodes if hasattr(node, "image")}
    rooms = []
    for k, (picture, origin) in enumerate(
        zip(record["rooms"], json.loads(marks.noted(tree, marks.ROOMS)), strict=True)
    ):
        x, y, z = (tuple(edge) for edge in picture["half_edges"])
        shown = RoomPicture((x, y, z), tuple(picture["capture"]), picture["rows"])
        rooms.append(RoomImage(shown, images[f"Room {k}"], origin["uid"], Side(origin["side"])))
    layers = (images.get(name) for name in (formula.MIDDLE_PICTURE, formula.CURTAIN_PICTURE))
    return Window(tuple(rooms), Cells(record["cells"]), *layers)


def _build(tree: bpy.types.ShaderNodeTree, window: Window) -> None:
    record = window.record
    given = _given(tree)
    outputs = formula.interior(record).outputs
    emit(tree, outputs, Surroundings(given, window.images, formula_group, _COLOURS))
    playback.stop(tree)
    for probe in (o for o in bpy.data.objects if o.pcc_probe.uid):
        shown = {room.image for room in window.rooms if room.uid == probe.pcc_probe.uid}
        baked = bake_record(probe) if shown else None
        if baked is not None:
            playback.play(tree, baked, shown)
    plain = asdict(record)
    marks.note(tree, _RECORD, json.dumps({**plain, "cells": record.cells.value}))
    marks.note(tree, marks.ROOMS, json.dumps([{"uid": room.uid, "side": room.side.value} for room in window.rooms]))


def _kind(socket: Socket) -> str:
    if isinstance(socket.default, float):
        return "NodeSocketFloat"
    return "NodeSocketColor" if socket.name in _COLOURS else "NodeSocketVector"


def _describe(tree: bpy.types.ShaderNodeTree, socket: Socket) -> None:
    item = next(i for i in tree.interface.items_tree if i.in_out == "INPUT" and i.name == socket.name)
    item.description = socket.meaning
    if item.socket_type == "NodeSocketFloat":
        item.subtype = socket.subtype
    if item.socket_type != "NodeSocketColor":
        item.min_value, item.max_value = socket.low, socket.high
    item.default_value = socket.default


def _given(tree: bpy.types.ShaderNodeTree) -> dict[str, Callable[[], bpy.types.NodeSocket]]:
    """What feeds the inputs that a pane itself has: where it is, which way it looks, who it belongs to."""
    made: dict[str, bpy.types.Node] = {}

    def node(kind: str) -> bpy.types.Node:
        if kind not in made:
            made[kind] = tree.nodes.new(kind)
        return made[kind]

    def transform(kind: str, source: str, target: str) -> bpy.types.Node:
        found = tree.nodes.new("ShaderNodeVectorTransform")
        found.vector_type, found.convert_from, found.convert_to = kind, source, target
        return found

    def in_object_space(output: str, kind: str) -> bpy.types.NodeSocket:
        found = transform(kind, "WORLD", "OBJECT")
        tree.links.new(node("ShaderNodeNewGeometry").outputs[output], found.inputs[0])
        return found.outputs[0]

    def scale() -> bpy.types.NodeSocket:
        lengths = tree.nodes.new("ShaderNodeCombineXYZ")
        lengths.name = lengths.label = "Object Scale"
        for axis in range(3):
            edge = transform("VECTOR", "OBJECT", "WORLD")
            edge.inputs[0].default_value = [float(axis == k) for k in range(3)]
            length = tree.nodes.new("ShaderNodeVectorMath")
            length.operation = "LENGTH"
            tree.links.new(edge.outputs[0], length.inputs[0])
            tree.links.new(length.outputs["Value"], lengths.inputs[axis])
        return lengths.outputs[0]

    return {
        "Position": lambda: node("ShaderNodeTexCoord").outputs["Object"],
        "UV": lambda: node("ShaderNodeTexCoord").outputs["UV"],
        "Incoming": partial(in_object_space, "Incoming", "VECTOR"),
        "Normal": partial(in_object_space, "Normal", "NORMAL"),
        "Object Scale": scale,
        "Object Random": lambda: node("ShaderNodeObjectInfo").outputs["Random"],
    }
