"""A scene as readings: what a render shows and where, cameras, what is animated, image files that are missing."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix, Vector

from pcc_addon.blender.read.scene import missing_textures, read_scene, rendered_objects
from pcc_addon.core.readings import CameraReading, SceneReading
from sample_blends.scenes import empty_scene
from tests.blender.helpers import pretend_bake, put_in, save, small_probe
from tests.blender.materials import image_texture, new, shiny, show

pytestmark = pytest.mark.usefixtures("scene")

PLACE = (
    Matrix.Translation((3.0, -2.0, 0.5)) @ Euler((0.3, -0.4, 0.9)).to_matrix().to_4x4() @ Matrix.Diagonal((1, 2, 3, 1))
)


def reading() -> SceneReading:
    bpy.context.view_layer.update()
    return read_scene(bpy.context.scene, bpy.context.view_layer)


def box(name: str, *names: str) -> bpy.types.Object:
    """An object whose bounds along its own axes are (1, 2, 3) to (4, 6, 8), which wears materials of these names."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(1, 2, 3), (4, 2, 3), (1, 6, 8)], [], [(0, 1, 2)])
    for material in names:
        mesh.materials.append(bpy.data.materials.get(material) or shiny(material))
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    return item


def corners(matrix: Matrix) -> np.ndarray:
    low, high = np.array([1, 2, 3]), np.array([4, 6, 8])
    return np.array([matrix @ Vector(np.where(corner, high, low).tolist()) for corner in np.ndindex(2, 2, 2)])


def test_an_object_stands_where_the_corners_of_its_own_bounds_are() -> None:
    box("Box", "B", "A").matrix_world = PLACE
    found = reading()
    [placement] = found.placements
    assert (placement.object, placement.materials) == ("Box", ("A", "B"))
    np.testing.assert_allclose(placement.corners, corners(PLACE), atol=1e-5)
    assert [material.name for material in found.materials] == ["A", "B"]
    assert found.materials[0].surfaces and found.name == "Scene"


def test_instances_count_where_they_are_and_what_no_render_shows_does_not() -> None:
    room = bpy.data.collections.new("Room")
    shape, lamp = box("Box", "Shown"), bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    bpy.context.scene.collection.objects.unlink(shape)
    room.objects.link(shape)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection, instance.matrix_world = "COLLECTION", room, PLACE
    for item in (instance, lamp):
        bpy.context.scene.collection.objects.link(item)
    box("Off", "Hidden").hide_render = True
    [placement] = reading().placements
    assert placement.object == "Box"
    np.testing.assert_allclose(placement.corners, corners(PLACE), atol=1e-5)
    assert [material.name for material in reading().materials] == ["Shown"]
    found = rendered_objects(bpy.context.scene, bpy.context.view_layer)
    assert [item.name for item in found] == ["Box", "Instance", "Lamp", "Off"]


def test_materials_that_only_an_object_or_only_geometry_nodes_assign_are_shown() -> None:
    item = box("Box", "Slot", "Replaced")
    item.data.materials.append(None)
    item.material_slots[1].link, item.material_slots[1].material = "OBJECT", shiny("Own")
    tree = bpy.data.node_groups.new("Paint", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    source, paint, sink = (tree.nodes.new(k) for k in ("NodeGroupInput", "GeometryNodeSetMaterial", "NodeGroupOutput"))
    paint.inputs["Material"].default_value = shiny("Made")
    tree.links.new(source.outputs[0], paint.inputs["Geometry"])
    tree.links.new(paint.outputs[0], sink.inputs[0])
    item.modifiers.new("Paint", "NODES").node_group = tree
    assert {"Own", "Made"} <= set(reading().placements[0].materials)


def camera(name: str) -> bpy.types.Object:
    item = bpy.data.objects.new(name, bpy.data.cameras.new(name))
    item.location = (len(name), 2.0, 3.0)
    bpy.context.scene.collection.objects.link(item)
    return item


def test_the_cameras_that_render_are_the_scenes_and_those_of_markers() -> None:
    assert reading().cameras == ()
    main, other, moved = camera("Main"), camera("Other"), camera("Moved")
    camera("Unused")
    bpy.context.scene.camera = main
    for item in (other, moved, None, main):
        bpy.context.scene.timeline_markers.new("M", frame=1).camera = item
    moved.keyframe_insert("location", frame=1)
    bpy.context.scene.camera = main
    found = reading()
    assert found.cameras == (
        CameraReading("Main", (4.0, 2.0, 3.0)), CameraReading("Moved", None), CameraReading("Other", (5.0, 2.0, 3.0))
    )  # fmt: skip
    assert found.animated == {"Moved"}


def test_probes_come_with_their_bake_or_their_fault() -> None:
    bpy.context.scene.pcc.roughness_limit = 0.25
    baked, damaged, flat = (
        small_probe("Baked", capture_offset=(0.5, 0.0, 0.0)),
        small_probe("Damaged"),
        small_probe("Flat"),
    )
    small_probe("New")
    pretend_bake(baked)
    damaged.pcc_probe.bake_record, flat.scale.z = "{", 0.0
    found = reading()
    assert found.roughness_limit == 0.25
    assert [probe.name for probe in found.probes] == ["Baked", "Damaged", "Flat", "New"]
    shown, broken, without, new = found.probes
    assert shown.fault == new.fault == "" and new.captured_at is None and shown.spec.name == "Baked"
    assert shown.captured_at == pytest.approx(shown.spec.capture_point)
    assert broken.spec is not None and "bake record of 'Damaged'" in broken.fault
    assert without.spec is None and "'Flat'" in without.fault


def missing() -> list[str]:
    return missing_textures(bpy.context.view_layer, bpy.context.scene.world)


def from_file(material: bpy.types.Material, path: Path) -> bpy.types.Image:
    """An image of a file that is there, as a texture of a material."""
    image = bpy.data.images.new(path.stem, 4, 4)
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    image.source = "FILE"
    image_texture(material).image = image
    return image


def test_image_files_that_are_missing_are_named_once(tmp_path: Path) -> None:
    material, world = shiny(), bpy.context.scene.world
    show(material), show(material, "Again"), show(bpy.data.materials.new("Without Nodes"), "Third")
    image_texture(material)  # painted in Blender: it has no file
    image = from_file(material, tmp_path / "wood.png")
    group, inner = new(material, "ShaderNodeGroup"), bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    group.node_tree = inner
    inner.nodes.new("ShaderNodeTexImage").image = image
    sky, ring = world.node_tree.nodes.new("ShaderNodeTexEnvironment"), inner.nodes.new("ShaderNodeTexImage")
    sky.image, ring.image = from_file(shiny("Unused"), tmp_path / "sky.png"), from_file(shiny(), tmp_path / "ring.png")
    from_file(material, tmp_path / "packed.png").pack()
    assert missing() == []
    for path in tmp_path.iterdir():
        path.unlink()
    assert missing() == [
        f"image '{name}': its file '{tmp_path / name}.png' is missing; relink it or pack it"
        for name in ("ring", "sky", "wood")
    ]
    assert len(missing_textures(bpy.context.view_layer, None)) == 2


def test_a_librarys_image_files_are_looked_for_beside_the_library(tmp_path: Path) -> None:
    material = shiny("Linked")
    from_file(material, tmp_path / "wood.png").filepath_raw = "//wood.png"
    material.use_fake_user = True
    save(tmp_path / "library.blend")
    empty_scene()
    own = shiny()
    from_file(own, tmp_path / "elsewhere.png").name = "wood"
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.materials = ["Linked"]
    show(own), show(wanted.materials[0], "Second")
    assert missing() == []
    (tmp_path / "wood.png").unlink(), (tmp_path / "elsewhere.png").unlink()
    assert [line.split("; ")[0] for line in missing()] == [
        f"image 'wood': its file '{tmp_path / name}.png' is missing" for name in ("elsewhere", "wood")
    ]


def test_a_probes_own_pictures_are_no_textures(probe) -> None:
    material = shiny()
    show(material)
    put_in()
    for level in probe.pcc_probe.levels:
        level.image.unpack(method="REMOVE")
    assert not any(Path(level.image.filepath).is_file() for level in probe.pcc_probe.levels)
    assert missing() == []
