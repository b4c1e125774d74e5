"""Which probes are baked: what makes a bake stale, what does not, and the scopes."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from sample_blends.scenes import add_box, principled, principled_node
from tests.blender.helpers import ROOM, paint_wall, pictures_of, save, small_probe, small_room


def run(scope: str) -> None:
    assert bpy.ops.pcc.bake(scope=scope) == {"FINISHED"}


def move_wall() -> None:
    bpy.data.objects["Wall +X"].location.x += 0.1


def brighten_lamp() -> None:
    bpy.data.lights["Lamp"].energy += 1.0


def move_vertex() -> None:
    bpy.data.meshes["Wall +X"].vertices[0].co.x += 0.1


def move_probe() -> None:
    bpy.data.objects["Probe"].location.x += 0.1


def change_resolution() -> None:
    bpy.data.objects["Probe"].pcc_probe.resolution = 18


def change_offset() -> None:
    bpy.data.objects["Probe"].pcc_probe.capture_offset.x = 0.5


def delete_file() -> None:
    pictures_of(bpy.data.objects["Probe"])[0].unlink()


def hide_wall() -> None:
    bpy.data.objects["Wall +X"].hide_render = True


def hide_from_capture() -> None:
    bpy.data.objects["Probe"].pcc_probe.hidden_objects.add().object = bpy.data.objects["Wall +X"]


def new_object() -> None:
    mesh = bpy.data.meshes.new("New")
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("New", mesh))


def brighten_world() -> None:
    nodes = bpy.context.scene.world.node_tree.nodes
    next(n for n in nodes if n.bl_idname == "ShaderNodeBackground").inputs["Strength"].default_value = 1.0


def paint_picture() -> None:
    bpy.data.images["Picture"].pixels[0] = 0.75


def cull_backfaces_for_eevee() -> None:
    bpy.data.materials["Glow +X"].use_backface_culling = not bpy.data.materials["Glow +X"].use_backface_culling


CHANGES = [
    paint_picture, move_wall, brighten_lamp, paint_wall, move_vertex, move_probe, change_resolution, change_offset,
    delete_file, hide_wall, hide_from_capture, new_object, brighten_world,
]  # fmt: skip


def widen_box() -> None:
    bpy.data.objects["Probe"].scale *= 1.5


def change_falloff() -> None:
    bpy.data.objects["Probe"].pcc_probe.falloff = 1.0


def harden() -> None:
    bpy.data.objects["Probe"].pcc_probe.contact_hardening = True


def inject() -> None:
    assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"}


def inject_and_remove() -> None:
    inject()
    assert bpy.ops.pcc.remove(scope="SCENE") == {"FINISHED"}


def select_all() -> None:
    for item in bpy.context.scene.objects:
        item.select_set(True)


def move_camera() -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def reopen() -> None:
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)


def add_output_for_each_engine() -> None:
    tree = bpy.data.materials["Floor"].node_tree
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    output.target = "CYCLES"
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    other.target = "EEVEE"
    tree.links.new(principled_node(bpy.data.materials["Floor"]).outputs[0], other.inputs["Surface"])
    run("STALE")
    inject()


def rename_all() -> None:
    for kind in ("objects", "meshes", "materials", "images", "lights", "worlds", "scenes", "collections"):
        for item in getattr(bpy.data, kind):
            item.name = f"Other {item.name}"


NOT_CHANGES = [
    rename_all, cull_backfaces_for_eevee, widen_box, change_falloff, harden, inject, inject_and_remove, select_all,
    move_camera, reopen, add_output_for_each_engine,
]  # fmt: skip


def lit_room(folder: Path) -> None:
    """A saved file with a room, a lamp and a baked probe."""
    small_room()
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = ROOM.world(0.5, 0.5, 0.5)
    bpy.context.scene.collection.objects.link(lamp)
    glow = bpy.data.materials["Glow -Y"]
    picture = glow.node_tree.nodes.new("ShaderNodeTexImage")
    picture.image = bpy.data.images.new("Picture", 4, 4)
    glow.node_tree.links.new(picture.outputs["Color"], principled_node(glow).inputs["Emission Color"])
    save(folder / "room.blend")
    run("STALE")


@pytest.mark.sweep
@pytest.mark.parametrize("change", CHANGES, ids=lambda f: f.__name__)
def test_a_stale_bake_is_baked_again_once(scene, tmp_path: Path, renders, change) -> None:
    lit_room(tmp_path)
    assert renders == ["Probe"] * 6
    run("STALE")
    assert len(renders) == 6, "nothing had changed"
    change()
    run("STALE")
    assert len(renders) == 12, "the change was not seen"
    run("STALE")
    assert len(renders) == 12, "the second bake does not hold"


@pytest.mark.sweep
@pytest.mark.parametrize("change", NOT_CHANGES, ids=lambda f: f.__name__)
def test_what_does_not_change_the_picture_does_not_make_it_stale(scene, tmp_path: Path, renders, change) -> None:
    lit_room(tmp_path)
    change()
    before = len(renders)
    run("STALE")
    assert len(renders) == before


def test_each_scope_bakes_its_probes(scene, renders) -> None:
    small_room()
    second = small_probe("Second", half_extents=(1.0, 1.0, 0.5))
    add_box(ROOM, "Vase", (0.0, 0.0, 0.0), (0.1, 0.1, 0.1), principled("Vase", Roughness=0.1))
    run("ALL")
    assert set(renders) == {"Probe", "Second"}
    renders.clear()
    second.location.x += 0.1
    run("STALE")
    assert set(renders) == {"Second"}
    renders.clear()
    for item in bpy.context.view_layer.objects:
        item.select_set(item.name == "Probe")
    run("SELECTED")
    assert set(renders) == {"Probe"}
    renders.clear()
    run("ALL")
    assert set(renders) == {"Probe", "Second"}


def test_baking_a_scene_without_probes_is_refused_with_what_to_do(scene) -> None:
    with pytest.raises(RuntimeError, match="add one"):
        bpy.ops.pcc.bake()
