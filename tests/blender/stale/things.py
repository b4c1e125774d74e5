"""What rows build: a scene to begin with, and things to put into it."""

from __future__ import annotations

from pathlib import Path

import bpy

from sample_blends.scenes import principled_node


def build() -> None:
    """A cube with a material, a lamp and a world: what every row begins with."""
    scene = bpy.context.scene
    item = thing("Thing")
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    lamp.location.z = 2.0
    scene.collection.objects.link(lamp)
    item.select_set(False)


def thing(name: str, link: bool = True) -> bpy.types.Object:
    """A cube of its own with UVs and a material of its own."""
    mesh = bpy.data.meshes.new(name)
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    uv = mesh.uv_layers.new(name="UV").uv
    for k, corner in enumerate(uv):
        corner.vector = (k % 4 / 4.0, k // 4 / 6.0)
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    if link:
        bpy.context.scene.collection.objects.link(item)
    return item


def the(name: str = "Thing") -> bpy.types.Object:
    return bpy.data.objects[name]


def material() -> bpy.types.Material:
    return bpy.data.materials["Thing"]


def tree() -> bpy.types.NodeTree:
    return material().node_tree


def surface() -> bpy.types.Node:
    return principled_node(material())


def node(kind: str, output: str | int = 0, to: str = "Base Color") -> bpy.types.Node:
    """A new node that feeds an input of the material's surface."""
    made = tree().nodes.new(kind)
    tree().links.new(made.outputs[output], surface().inputs[to])
    return made


def group(name: str = "Inner") -> bpy.types.NodeTree:
    """A group in the material that passes a colour through a node."""
    inner = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for way in ("INPUT", "OUTPUT"):
        inner.interface.new_socket("Color", in_out=way, socket_type="NodeSocketColor")
    source, sink = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
    middle = inner.nodes.new("ShaderNodeBrightContrast")
    inner.links.new(source.outputs[0], middle.inputs["Color"])
    inner.links.new(middle.outputs[0], sink.inputs[0])
    made = tree().nodes.new("ShaderNodeGroup")
    made.node_tree = inner
    tree().links.new(made.outputs[0], surface().inputs["Base Color"])
    return inner


def picture(folder: Path, name: str = "picture", value: float = 0.5, size: int = 4) -> Path:
    """A PNG of one grey."""
    path = folder / f"{name}.png"
    made = bpy.data.images.new(name, size, size)
    made.pixels.foreach_set([value, value, value, 1.0] * size * size)
    made.filepath_raw, made.file_format = str(path), "PNG"
    made.save()
    bpy.data.images.remove(made)
    return path


def texture(folder: Path) -> bpy.types.Image:
    """An image file that the material shows."""
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.load(str(picture(folder)))
    return made.image


def generated() -> bpy.types.Image:
    made = node("ShaderNodeTexImage")
    made.image = bpy.data.images.new("Made", 4, 4)
    return made.image


def collection(name: str = "Some", *items: bpy.types.Object, link: bool = True) -> bpy.types.Collection:
    """A collection of objects that are in no other."""
    made = bpy.data.collections.new(name)
    if link:
        bpy.context.scene.collection.children.link(made)
    for item in items:
        for other in list(item.users_collection):
            other.objects.unlink(item)
        made.objects.link(item)
    return made


def instances(*items: bpy.types.Object) -> bpy.types.Object:
    """An empty that shows objects which the scene itself has not."""
    empty = bpy.data.objects.new("Instances", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection("Instanced", *items, link=False)
    bpy.context.scene.collection.objects.link(empty)
    return empty


def geometry_nodes(item: bpy.types.Object) -> tuple[bpy.types.Modifier, bpy.types.NodeTree, bpy.types.Node]:
    """A modifier that moves an object's vertices by an input of its own; the tree and the node that moves them."""
    made = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    for way, kind, name in (
        ("INPUT", "NodeSocketGeometry", "Geometry"),
        ("OUTPUT", "NodeSocketGeometry", "Geometry"),
        ("INPUT", "NodeSocketVector", "Offset"),
        ("INPUT", "NodeSocketObject", "Object"),
    ):
        made.interface.new_socket(name, in_out=way, socket_type=kind)
    source, sink = made.nodes.new("NodeGroupInput"), made.nodes.new("NodeGroupOutput")
    move, join, info = (made.nodes.new(f"GeometryNode{n}") for n in ("SetPosition", "JoinGeometry", "ObjectInfo"))
    made.links.new(source.outputs["Geometry"], move.inputs["Geometry"])
    made.links.new(source.outputs["Offset"], move.inputs["Offset"])
    made.links.new(source.outputs["Object"], info.inputs["Object"])
    made.links.new(move.outputs["Geometry"], join.inputs[0])
    made.links.new(info.outputs["Geometry"], join.inputs[0])
    made.links.new(join.outputs[0], sink.inputs[0])
    modifier = item.modifiers.new("Nodes", "NODES")
    modifier.node_group = made
    return modifier, made, move


def set_input(modifier: bpy.types.Modifier, name: str, value: object) -> None:
    """Set an input of geometry nodes, in whatever way this Blender keeps it."""
    [identifier] = [
        i.identifier for i in modifier.node_group.interface.items_tree if i.name == name and i.in_out == "INPUT"
    ]
    if hasattr(modifier, "properties"):
        getattr(modifier.properties.inputs, identifier).value = value
    else:
        modifier[identifier] = value
    modifier.id_data.update_tag()


def scene() -> bpy.types.Scene:
    return bpy.context.scene


def world() -> bpy.types.World:
    return scene().world


def keyed() -> bpy.types.ShapeKey:
    the().shape_key_add(name="Basis")
    key = the().shape_key_add(name="Wide")
    key.data[0].co.x -= 0.2
    key.value = 0.5
    return key


def rig() -> bpy.types.Object:
    armature = bpy.data.objects.new("Armature", bpy.data.armatures.new("Armature"))
    scene().collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("Bone", "Idle"):
        made = armature.data.edit_bones.new(name)
        made.head, made.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    the().modifiers.new("Armature", "ARMATURE").object = armature
    the().vertex_groups.new(name="Bone").add(range(8), 1.0, "REPLACE")
    return armature


def lamp() -> bpy.types.Light:
    return bpy.data.lights["Lamp"]


def background() -> bpy.types.Node:
    return next(n for n in world().node_tree.nodes if n.bl_idname == "ShaderNodeBackground")


def placed(name: str, data: bpy.types.ID) -> bpy.types.Object:
    item = bpy.data.objects.new(name, data)
    scene().collection.objects.link(item)
    return item


def drawing() -> bpy.types.ID:
    bpy.ops.object.grease_pencil_add(type="EMPTY")
    made = bpy.context.object.data
    layer = made.layers[0] if len(made.layers) else made.layers.new("Layer")
    frame = layer.current_frame() or layer.frames.new(scene().frame_current)
    frame.drawing.add_strokes([3])
    made.materials.append(bpy.data.materials.new("Ink"))
    if not made.materials[-1].is_grease_pencil:
        bpy.data.materials.create_gpencil_data(made.materials[-1])
    return made


def probe() -> bpy.types.PropertyGroup:
    return the("Probe").pcc_probe
