"""What changes from frame to frame is seen wherever it comes from; what does not, does not count."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import pytest

from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import probe_spec
from tests.blender.helpers import ROOM, principled_node, small_room


def seen(scene: bpy.types.Scene, frame: int) -> str:
    scene.frame_set(frame)
    return SceneFingerprint(scene, bpy.context.view_layer).content_hash(probe_spec(bpy.data.objects["Probe"]))


def animate(owner: object, path: str, values: tuple[object, object], index: int = -1) -> None:
    """Let a property have one value at frame 1 and another at frame 3."""
    for frame, value in zip((1, 3), values, strict=True):
        if index >= 0:
            getattr(owner, path)[index] = value
        else:
            setattr(owner, path, value)
        owner.keyframe_insert(path, index=index, frame=frame)


def cube(name: str = "Cube") -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=0.3, location=ROOM.centre)
    item = bpy.context.object
    item.name = name
    return item


def moved() -> None:
    animate(cube(), "location", (0.0, 0.5), 0)


def parent_moved() -> None:
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    cube().parent = parent
    animate(parent, "location", (0.0, 0.5), 0)


def hidden() -> None:
    animate(cube(), "hide_render", (False, True))


def shape_key() -> None:
    item = cube()
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Wide")
    key.data[0].co.x -= 0.2
    animate(key, "value", (0.0, 1.0))


def bone() -> None:
    armature = bpy.data.objects.new("Armature", bpy.data.armatures.new("Armature"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    made = armature.data.edit_bones.new("Bone")
    made.head, made.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    item = cube()
    item.modifiers.new("Armature", "ARMATURE").object = armature
    item.vertex_groups.new(name="Bone").add(range(8), 1.0, "REPLACE")
    armature.pose.bones["Bone"].rotation_mode = "XYZ"
    animate(armature.pose.bones["Bone"], "rotation_euler", (0.0, 1.0), 0)


def displaced_by_another() -> None:
    item, other = cube(), cube("Other")
    other.hide_render = True
    wrap = item.modifiers.new("Hook", "HOOK")
    wrap.object = other
    wrap.vertex_indices_set(range(4))
    animate(other, "location", (0.0, 0.5), 2)


def instances_moved() -> None:
    collection = bpy.data.collections.new("Instanced")
    item = cube()
    bpy.context.scene.collection.objects.unlink(item)
    collection.objects.link(item)
    empty = bpy.data.objects.new("Instancer", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    animate(item, "location", (0.0, 0.5), 0)


def material_value() -> None:
    socket = principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Strength"]
    animate(socket, "default_value", (1.0, 0.0))


def material_driver() -> None:
    socket = principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Strength"]
    socket.driver_add("default_value").driver.expression = "frame / 10"


def lamp_energy() -> None:
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    bpy.context.scene.collection.objects.link(lamp)
    animate(lamp.data, "energy", (1.0, 0.0))


def world_strength() -> None:
    nodes = bpy.context.scene.world.node_tree.nodes
    background = next(n for n in nodes if n.bl_idname == "ShaderNodeBackground")
    animate(background.inputs["Strength"], "default_value", (0.0, 1.0))


def probe_moved() -> None:
    animate(bpy.data.objects["Probe"], "location", (3.0, 3.5), 0)


def film_on_a_wall() -> None:
    tree = bpy.data.materials["Glow +X"].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Film", 4, 4)
    node.image.source = "SEQUENCE"
    tree.links.new(node.outputs["Color"], principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Color"])


def animated_but_disabled_in_viewports() -> None:
    item = cube()
    animate(item, "location", (0.0, 0.5), 0)
    item.hide_viewport = True


def simulated() -> None:
    cube().modifiers.new("Cloth", "CLOTH")


CHANGES = [
    moved, parent_moved, hidden, shape_key, bone, displaced_by_another, instances_moved, material_value,
    material_driver, lamp_energy, world_strength, probe_moved, film_on_a_wall, animated_but_disabled_in_viewports,
    simulated,
]  # fmt: skip


@pytest.mark.parametrize("change", CHANGES, ids=lambda f: f.__name__)
def test_a_change_from_frame_to_frame_is_seen(scene, change: Callable[[], None]) -> None:
    small_room()
    change()
    assert seen(scene, 1) != seen(scene, 3)
    assert seen(scene, 1) == seen(scene, 1)


def nothing() -> None:
    pass


def camera_moved() -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    animate(camera, "location", (0.0, 1.0), 0)


def unrendered_moved() -> None:
    item = cube()
    item.hide_render = True
    animate(item, "location", (0.0, 1.0), 0)


def hidden_in_viewports_and_still() -> None:
    cube().hide_viewport = True


def still_modifier() -> None:
    cube().modifiers.new("Subdivision", "SUBSURF")


def box_scaled() -> None:
    animate(bpy.data.objects["Probe"], "scale", (2.0, 2.5), 0)


UNCHANGED = [nothing, camera_moved, unrendered_moved, hidden_in_viewports_and_still, still_modifier, box_scaled]


@pytest.mark.parametrize("change", UNCHANGED, ids=lambda f: f.__name__)
def test_what_the_picture_does_not_show_makes_no_frame_another(scene, change: Callable[[], None]) -> None:
    small_room()
    change()
    assert seen(scene, 1) == seen(scene, 3)
