"""Names and orders."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, fresh
from tests.blender.stale.things import (
    collection,
    geometry_nodes,
    group,
    instances,
    keyed,
    lamp,
    material,
    scene,
    texture,
    the,
    thing,
    tree,
    world,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


@fresh("names", "of objects, data, materials, lamps, the world and the scene")
def _(folder: Path) -> Steps:
    yield
    for item in (the(), the().data, material(), the("Lamp"), lamp(), world(), scene(), bpy.context.view_layer):
        item.name = "Renamed"


@fresh("names", "of a collection")
def _(folder: Path) -> Steps:
    made = collection("Some", the())
    yield
    made.name = "Renamed"


@fresh("names", "of instanced objects, their collection and what makes them")
def _(folder: Path) -> Steps:
    empty = instances(the(), thing("Other"))
    yield
    the("Other").name = "A"
    empty.instance_collection.name, empty.name = "B", "C"


@fresh("names", "of an image and its file")
def _(folder: Path) -> Steps:
    made = texture(folder)
    yield
    made.name = "Renamed"
    (folder / "picture.png").rename(folder / "other.png")
    made.filepath = str(folder / "other.png")


@fresh("names", "of nodes and groups")
def _(folder: Path) -> Steps:
    inner = group()
    yield
    inner.name = "Renamed"
    for owner in (inner, tree()):
        for made in owner.nodes:
            made.name = f"Renamed {made.name}"


@fresh("names", "of a UV map that nobody reads by name")
def _(folder: Path) -> Steps:
    yield
    the().data.uv_layers[0].name = "Renamed"


@fresh("names", "of a modifier, a shape key and a vertex group")
def _(folder: Path) -> Steps:
    key = keyed()
    the().vertex_groups.new(name="Some").add([0], 0.5, "REPLACE")
    made = the().modifiers.new("Displace", "DISPLACE")
    made.vertex_group = "Some"
    yield
    key.name, made.name = "Renamed", "Renamed"
    the().vertex_groups[0].name = "Renamed"
    made.vertex_group = "Renamed"


@fresh("names", "of an object that geometry nodes read")
def _(folder: Path) -> Steps:
    _, made, _ = geometry_nodes(the())
    other = thing("Other")
    next(n for n in made.nodes if n.bl_idname == "GeometryNodeObjectInfo").inputs["Object"].default_value = other
    yield
    other.name, made.name = "Renamed", "Renamed"


@fresh("names", "two objects that exchange theirs")
def _(folder: Path) -> Steps:
    other = thing("Other")
    other.location.x = 3.0
    yield
    the().name, other.name = "Between", "Thing"
    the("Between").name = "Other"
