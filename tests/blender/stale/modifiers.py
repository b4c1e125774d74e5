"""Shape keys, modifiers, geometry nodes."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, fresh, stale
from tests.blender.stale.things import (
    geometry_nodes,
    keyed,
    rig,
    scene,
    set_input,
    the,
    thing,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


@stale("shape keys", "a value")
def _(folder: Path) -> Steps:
    key = keyed()
    yield
    key.value = 0.6


@stale("shape keys", "a point of one that is shown")
def _(folder: Path) -> Steps:
    key = keyed()
    yield
    key.data[1].co.y += 0.1


@stale("shape keys", "one muted")
def _(folder: Path) -> Steps:
    key = keyed()
    yield
    key.mute = True


@stale("shape keys", "a weight of its vertex group")
def _(folder: Path) -> Steps:
    key, made = keyed(), the().vertex_groups.new(name="Some")
    key.vertex_group = "Some"
    yield
    made.add([0], 0.5, "REPLACE")


@stale("modifiers", "one added")
def _(folder: Path) -> Steps:
    yield
    the().modifiers.new("Bevel", "BEVEL")


@stale("modifiers", "a value")
def _(folder: Path) -> Steps:
    bevel = the().modifiers.new("Bevel", "BEVEL")
    yield
    bevel.width += 0.01


@stale("modifiers", "one that renders leave out")
def _(folder: Path) -> Steps:
    bevel = the().modifiers.new("Bevel", "BEVEL")
    yield
    bevel.show_render = False


@stale("modifiers", "their order")
def _(folder: Path) -> Steps:
    the().modifiers.new("Bevel", "BEVEL"), the().modifiers.new("Array", "ARRAY")
    yield
    the().modifiers.move(0, 1)


@stale("modifiers", "levels of subdivision in renders")
def _(folder: Path) -> Steps:
    made = the().modifiers.new("Subdivision", "SUBSURF")
    yield
    made.render_levels = 4


@stale("modifiers", "a weight of a vertex group that one uses")
def _(folder: Path) -> Steps:
    made = the().vertex_groups.new(name="Some")
    made.add([0, 1], 0.5, "REPLACE")
    the().modifiers.new("Displace", "DISPLACE").vertex_group = "Some"
    yield
    made.add([0], 0.75, "REPLACE")


@stale("modifiers", "an object moved that one points to")
def _(folder: Path) -> Steps:
    other = bpy.data.objects.new("Other", None)
    scene().collection.objects.link(other)
    the().modifiers.new("Mirror", "MIRROR").mirror_object = other
    yield
    other.location.x = 0.5


@stale("modifiers", "the mesh of an object that one cuts with, hidden in renders")
def _(folder: Path) -> Steps:
    other = thing("Other")
    other.hide_render = True
    the().modifiers.new("Boolean", "BOOLEAN").object = other
    yield
    other.data.vertices[0].co.x -= 0.1


@stale("modifiers", "an object in a lattice whose point moved")
def _(folder: Path) -> Steps:
    lattice = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    scene().collection.objects.link(lattice)
    the().modifiers.new("Lattice", "LATTICE").object = lattice
    yield
    lattice.data.points[0].co_deform.x += 0.1


@stale("modifiers", "a bone turned")
def _(folder: Path) -> Steps:
    armature = rig()
    yield
    armature.pose.bones["Bone"].rotation_quaternion = (0.8, 0.6, 0.0, 0.0)


@stale("modifiers", "a texture that displaces")
def _(folder: Path) -> Steps:
    noise = bpy.data.textures.new("Clouds", "CLOUDS")
    the().modifiers.new("Displace", "DISPLACE").texture = noise
    yield
    noise.noise_scale += 0.1


@stale("geometry nodes", "a value in the tree")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    made.links.remove(move.inputs["Offset"].links[0])
    yield
    move.inputs["Offset"].default_value[0] = 0.5


@stale("geometry nodes", "a link in the tree")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    yield
    made.links.remove(move.inputs["Offset"].links[0])


@stale("geometry nodes", "an input of the modifier")
def _(folder: Path) -> Steps:
    modifier, _, _ = geometry_nodes(the())
    yield
    set_input(modifier, "Offset", (0.5, 0.0, 0.0))


@stale("geometry nodes", "an object moved that an input names")
def _(folder: Path) -> Steps:
    other = thing("Other")
    other.hide_render = True
    set_input(geometry_nodes(the())[0], "Object", other)
    yield
    other.location.x += 0.5


@stale("geometry nodes", "the material of an object that they bring in")
def _(folder: Path) -> Steps:
    other = thing("Other")
    other.hide_render = True
    set_input(geometry_nodes(the())[0], "Object", other)
    yield
    bpy.data.materials["Other"].node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9


@stale("geometry nodes", "a material that they assign")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    assign = made.nodes.new("GeometryNodeSetMaterial")
    assign.inputs["Material"].default_value = other = bpy.data.materials.new("Assigned")
    if other.node_tree is None:
        other.use_nodes = True
    sink = next(n for n in made.nodes if n.bl_idname == "NodeGroupOutput")
    made.links.new(move.outputs[0], assign.inputs["Geometry"])
    made.links.new(assign.outputs[0], sink.inputs[0])
    yield
    other.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9


@stale("geometry nodes", "an attribute that they store")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    store = made.nodes.new("GeometryNodeStoreNamedAttribute")
    store.inputs["Name"].default_value = "wet"
    sink = next(n for n in made.nodes if n.bl_idname == "NodeGroupOutput")
    made.links.new(move.outputs[0], store.inputs["Geometry"])
    made.links.new(store.outputs[0], sink.inputs[0])
    yield
    store.inputs["Value"].default_value = 0.5


@stale("geometry nodes", "how often a zone is repeated")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    begin, end = made.nodes.new("GeometryNodeRepeatInput"), made.nodes.new("GeometryNodeRepeatOutput")
    begin.pair_with_output(end)
    sink = next(n for n in made.nodes if n.bl_idname == "NodeGroupOutput")
    made.links.new(move.outputs[0], end.inputs["Geometry"])
    made.links.new(end.outputs["Geometry"], sink.inputs[0])
    times = made.nodes.new("FunctionNodeInputInt")
    made.links.new(times.outputs[0], begin.inputs["Iterations"])
    yield
    times.integer = 3


@stale("geometry nodes", "the distance of instances")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    points, on = made.nodes.new("GeometryNodeMeshLine"), made.nodes.new("GeometryNodeInstanceOnPoints")
    sink = next(n for n in made.nodes if n.bl_idname == "NodeGroupOutput")
    made.links.new(points.outputs[0], on.inputs["Points"])
    made.links.new(move.outputs[0], on.inputs["Instance"])
    made.links.new(on.outputs[0], sink.inputs[0])
    yield
    points.inputs["Offset"].default_value[2] = 2.0


@stale("geometry nodes", "the frame, where they read it")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    time = made.nodes.new("GeometryNodeInputSceneTime")
    made.links.new(time.outputs["Frame"], move.inputs["Offset"])
    yield
    scene().frame_set(scene().frame_current + 5)


@stale("geometry nodes", "the frame, where an attribute follows it")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    time, store = made.nodes.new("GeometryNodeInputSceneTime"), made.nodes.new("GeometryNodeStoreNamedAttribute")
    store.inputs["Name"].default_value = "wet"
    sink = next(n for n in made.nodes if n.bl_idname == "NodeGroupOutput")
    made.links.new(move.outputs[0], store.inputs["Geometry"])
    made.links.new(time.outputs["Frame"], store.inputs["Value"])
    made.links.new(store.outputs[0], sink.inputs[0])
    yield
    scene().frame_set(scene().frame_current + 5)


@fresh("geometry nodes", "the frame, where they read it and make the same of it")
def _(folder: Path) -> Steps:
    _, made, move = geometry_nodes(the())
    time, least = made.nodes.new("GeometryNodeInputSceneTime"), made.nodes.new("ShaderNodeMath")
    least.operation = "MINIMUM"
    made.links.new(time.outputs["Frame"], least.inputs[0])
    made.links.new(least.outputs[0], move.inputs["Offset"])
    yield
    scene().frame_set(scene().frame_current + 5)
