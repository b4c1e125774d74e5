"""Objects, collections, instances, frames."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, settings_rows, stale
from tests.blender.stale.things import (
    collection,
    group,
    instances,
    material,
    node,
    scene,
    surface,
    the,
    thing,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE

settings_rows(
    True, "object", the, "{}", CYCLES, hide_render=True, visible_diffuse=False, visible_glossy=False,
    visible_transmission=False, visible_volume_scatter=False, visible_shadow=False, is_shadow_catcher=True,
    location=(0.1, 0.0, 0.0), rotation_euler=(0.0, 0.1, 0.0), scale=(1.0, 1.0, 1.1),
)  # fmt: skip


@stale("object", "its parent moved")
def _(folder: Path) -> Steps:
    parent = bpy.data.objects.new("Parent", None)
    scene().collection.objects.link(parent)
    the().parent = parent
    yield
    parent.location.x = 0.5


@stale("object", "the target of a constraint moved")
def _(folder: Path) -> Steps:
    target = bpy.data.objects.new("Target", None)
    scene().collection.objects.link(target)
    the().constraints.new("COPY_LOCATION").target = target
    yield
    target.location.x = 0.5


@stale("object", "another one")
def _(folder: Path) -> Steps:
    yield
    thing("New")


@stale("object", "a second one that is the same in the same place")
def _(folder: Path) -> Steps:
    yield
    scene().collection.objects.link(the().copy())


@stale("object", "one less")
def _(folder: Path) -> Steps:
    yield
    bpy.data.objects.remove(the())


@stale("object", "another material in its slot")
def _(folder: Path) -> Steps:
    other = material().copy()
    other.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9
    yield
    the().material_slots[0].material = other


@stale("object", "its colour, where a shader reads it")
def _(folder: Path) -> Steps:
    node("ShaderNodeObjectInfo", "Color")
    yield
    the().color = (1.0, 0.0, 0.0, 1.0)


@stale("object", "its pass index, where a shader reads it within a group")
def _(folder: Path) -> Steps:
    inner = group()
    info = inner.nodes.new("ShaderNodeObjectInfo")
    inner.links.new(info.outputs["Object Index"], inner.nodes["Brightness/Contrast"].inputs["Bright"])
    yield
    the().pass_index = 3


@stale("object", "the pass index of its material, where a shader reads it")
def _(folder: Path) -> Steps:
    node("ShaderNodeObjectInfo", "Material Index")
    yield
    material().pass_index = 3


@stale("object", "its name, where a shader reads Random")
def _(folder: Path) -> Steps:
    node("ShaderNodeObjectInfo", "Random")
    yield
    the().name = "Renamed"


@stale("object", "the name of what makes instances, where a shader reads Random")
def _(folder: Path) -> Steps:
    node("ShaderNodeObjectInfo", "Random")
    empty = instances(the())
    yield
    empty.name = "Renamed"


@stale("object", "a custom property that a shader reads")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeAttribute")
    made.attribute_type, made.attribute_name = "OBJECT", "wet"
    the()["wet"] = 0.25
    yield
    the()["wet"] = 0.5


@stale("object", "a custom property of what makes instances, that a shader reads")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeAttribute")
    made.attribute_type, made.attribute_name = "INSTANCER", "wet"
    empty = instances(the())
    empty["wet"] = 0.25
    yield
    empty["wet"] = 0.5


@stale("object", "a custom property of the scene that a shader reads")
def _(folder: Path) -> Steps:
    made = node("ShaderNodeAttribute")
    made.attribute_type, made.attribute_name = "VIEW_LAYER", "wet"
    scene()["wet"] = 0.25
    yield
    scene()["wet"] = 0.5


@stale("object", "where an object is whose coordinates a shader reads")
def _(folder: Path) -> Steps:
    empty = bpy.data.objects.new("Empty", None)
    scene().collection.objects.link(empty)
    node("ShaderNodeTexCoord", "Object").object = empty
    yield
    empty.location.x = 0.5


@stale("object", "whether EEVEE's volume probes see it", EEVEE)
def _(folder: Path) -> Steps:
    yield
    the().hide_probe_volume = True


@stale("collections", "one excluded from the view layer")
def _(folder: Path) -> Steps:
    collection("Some", the())
    yield
    bpy.context.view_layer.layer_collection.children["Some"].exclude = True


@stale("collections", "one hidden in renders")
def _(folder: Path) -> Steps:
    made = collection("Some", the())
    yield
    made.hide_render = True


@stale("collections", "one within another that is hidden in renders")
def _(folder: Path) -> Steps:
    outer = bpy.data.collections.new("Outer")
    scene().collection.children.link(outer)
    outer.children.link(collection("Some", the(), link=False))
    yield
    outer.hide_render = True


@stale("instances", "what makes them moved")
def _(folder: Path) -> Steps:
    empty = instances(the())
    yield
    empty.location.x = 0.5


@stale("instances", "an object in the collection moved")
def _(folder: Path) -> Steps:
    instances(the())
    yield
    the().location.x = 0.5


@stale("instances", "the mesh of an object in the collection")
def _(folder: Path) -> Steps:
    instances(the())
    yield
    the().data.vertices[0].co.x += 0.1


@stale("instances", "an object more in the collection")
def _(folder: Path) -> Steps:
    empty = instances(the())
    yield
    empty.instance_collection.objects.link(thing("New", link=False))


@stale("instances", "the offset of the collection")
def _(folder: Path) -> Steps:
    empty = instances(the())
    yield
    empty.instance_collection.instance_offset.x = 0.5


@stale("instances", "a collection within a collection hidden in renders")
def _(folder: Path) -> Steps:
    empty = instances()
    inner = collection("Inner", the(), link=False)
    empty.instance_collection.children.link(inner)
    yield
    inner.hide_render = True


@stale("instances", "which collection")
def _(folder: Path) -> Steps:
    empty, other = instances(the()), thing("Other")
    other.data.vertices[0].co.x += 0.1
    made = collection("Others", other, link=False)
    yield
    empty.instance_collection = made


@stale("instances", "at the vertices of an object")
def _(folder: Path) -> Steps:
    carrier = thing("Carrier")
    the().parent = carrier
    yield
    carrier.instance_type = "VERTS"


@stale("linked data", "an object of a library moved")
def _(folder: Path) -> Steps:
    path = folder / "library.blend"
    other = thing("Linked", link=False)
    bpy.data.libraries.write(str(path), {other})
    bpy.data.objects.remove(other)
    with bpy.data.libraries.load(str(path), link=True) as (_, to):
        to.objects = ["Linked"]
    linked = bpy.data.objects["Linked"]
    assert linked.library is not None
    scene().collection.objects.link(linked)
    yield
    linked.location.x += 1.0


@stale("frame", "another one, where an object moves")
def _(folder: Path) -> Steps:
    for frame, x in ((1, 0.0), (10, 1.0)):
        the().location.x = x
        the().keyframe_insert("location", frame=frame)
    scene().frame_set(1)
    yield
    scene().frame_set(5)


@stale("frame", "another one, where a value is driven")
def _(folder: Path) -> Steps:
    surface().inputs["Roughness"].driver_add("default_value").driver.expression = "frame / 100"
    scene().frame_set(1)
    yield
    scene().frame_set(5)
