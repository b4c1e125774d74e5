"""Where nothing scatters light, a bake is stale and baked again face by face; where anything may, it is whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake import capture
from pcc_addon.blender.bake.completing import completed
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.shade.captured import seen_matt
from pcc_addon.blender.status import ProbeStatus
from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACE_NAMES, find_faces
from sample_blends.scenes import EMISSIVE_COLORS, add_box, add_wall, emissive, emissive_checker, principled
from tests.blender.helpers import ROOM, bake, glow, picture, put_in, small_probe, small_room
from tests.blender.test_faces import WITHOUT_BELOW, add_ball, bake_stale, found, levels_of, rendered

__all__ = ["rendered"]
BLACK = (0.0, 0.0, 0.0, 1.0)
HALF = (0.1, 0.1, 0.1)
FRESH = [ProbeStatus("Probe", "baked")]


@pytest.fixture
def probe(scene, monkeypatch) -> bpy.types.Object:
    """That of a room where all glows, in which a mirror ball stands that it does not see."""
    probe = glowing_room(monkeypatch)
    add_wall(ROOM, "-Z", emissive_checker("Glow -Z", (0.7, 0.6, 0.5), (0.1, 0.2, 0.3)))
    add_ball(probe)
    return probe


@pytest.fixture
def over_black(scene, monkeypatch) -> bpy.types.Object:
    """That of a room where all glows but the floor, which is a black mirror."""
    probe = glowing_room(monkeypatch)
    add_wall(ROOM, "-Z", principled("Floor", Base_Color=BLACK, Roughness=0.0))
    bpy.context.view_layer.update()
    return probe


def glowing_room(monkeypatch) -> bpy.types.Object:
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 0)  # faces are rendered one by one
    for side, (bright, dark) in EMISSIVE_COLORS.items():
        add_wall(ROOM, side, emissive_checker(f"Glow {side}", bright, dark))
    probe = small_probe(capture_offset=(0.0, 0.0, 0.05))
    probe.pcc_probe.resolution = 64
    return probe


def hashes(probe: bpy.types.Object) -> tuple[str, ...]:
    scene, layer = bpy.context.scene, bpy.context.view_layer
    return SceneFingerprint(scene, layer, seen_matt(plan_scene(scene, layer))).face_hashes(probe_spec(probe))


def changed(probe: bpy.types.Object, before: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(name for name, old, new in zip(FACE_NAMES, before, hashes(probe), strict=True) if old != new)


def recolour(wall: str) -> None:
    checker = next(n for n in bpy.data.materials[f"Glow {wall}"].node_tree.nodes if n.type == "TEX_CHECKER")
    checker.inputs["Color1"].default_value = (0.1, 0.9, 0.4, 1.0)


def lamp_box(x: float, y: float, z: float) -> bpy.types.Object:
    box = add_box(ROOM, "Box", (x, y, z), HALF, glow("Box", (4.0, 2.0, 1.0)))
    bpy.context.view_layer.update()
    return box


def move(item: bpy.types.Object, x: float, y: float, z: float) -> None:
    item.matrix_world.translation = ROOM.world(x, y, z)
    bpy.context.view_layer.update()


def of_faces(pixels: np.ndarray) -> dict[str, np.ndarray]:
    """The texels of each face."""
    height, width = pixels.shape[:2]
    directions = equirect.directions(width, height).reshape(-1, 3)
    return {FACE_NAMES[k]: pixels.reshape(-1, 3)[chosen] for k, chosen, _, _ in find_faces(directions)}


def test_a_wall_that_one_face_sees_is_baked_again_alone_and_as_if_all_were(probe, rendered) -> None:
    bake(probe)
    assert found() == FRESH and len(set(bake_record(probe).face_hashes)) == 6
    before = picture(probe).copy()
    recolour("+X")
    assert found() == [ProbeStatus("Probe", "stale", "what its face +X sees changed since its bake")]
    rendered.clear()
    [result] = bake_stale(probe)
    assert result.error is None and rendered == ["+X"] and result.faces == ("+X",)
    assert found() == FRESH and bake_record(probe).faces == FACE_NAMES
    partly, record = levels_of(probe), bake_record(probe)
    rendered.clear()
    bake(probe)
    assert rendered == list(FACE_NAMES)
    whole = levels_of(probe)
    assert len(whole) == 8 and all(np.array_equal(partly[roughness], whole[roughness]) for roughness in whole)
    assert record.content_hash == bake_record(probe).content_hash
    assert record.face_hashes == bake_record(probe).face_hashes
    same = {name for name, texels in of_faces(before).items() if np.array_equal(texels, of_faces(whole[0.0])[name])}
    assert same == set(FACE_NAMES) - {"+X"}


@pytest.mark.heavy
def test_denoised_faces_are_taken_over_too(probe, rendered) -> None:
    probe.pcc_probe.denoise = True
    bake(probe)
    recolour("+X")
    rendered.clear()
    bake_stale(probe)
    assert rendered == ["+X", "+X"], "once as it is and once for faults that the denoiser hides"
    partly = picture(probe).copy()
    bake(probe)
    assert np.array_equal(partly, picture(probe))


def test_faces_that_one_render_gives_are_taken_over_too(probe, rendered, monkeypatch) -> None:
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 10**9)
    bake(probe)
    before = of_faces(picture(probe))
    recolour("+X")
    [result] = bake_stale(probe)
    assert result.faces == ("+X",) and found() == FRESH
    after = of_faces(picture(probe))
    assert [name for name in FACE_NAMES if not np.array_equal(before[name], after[name])] == ["+X"]


def test_a_wall_counts_in_every_face_that_sees_it(probe, rendered) -> None:
    bake(probe)
    recolour("+Y")
    assert found()[0].why == "what its faces +X, -X and +Y see changed since its bake"
    rendered.clear()
    bake_stale(probe)
    assert rendered == ["+X", "-X", "+Y"]


def test_what_moves_from_one_face_to_another_counts_in_both(probe, rendered) -> None:
    box = lamp_box(1.5, 0.0, 0.0)
    bake(probe)
    move(box, 0.0, -1.2, 0.0)
    assert found()[0].why == "what its faces +X and -Y see changed since its bake"
    rendered.clear()
    bake_stale(probe)
    assert rendered == ["+X", "-Y"]
    partly = picture(probe).copy()
    bake(probe)
    assert np.array_equal(partly, picture(probe))


def test_what_is_gone_counts_where_it_was(probe) -> None:
    box = lamp_box(1.5, 0.0, 0.0)
    before = hashes(probe)
    box.hide_render = True
    assert changed(probe, before) == ("+X",)


def test_a_texture_counts_where_it_is_seen(probe, rendered) -> None:
    image = bpy.data.images.new("Tiles", 4, 4)
    material, emission = emissive("Tiled")
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    bpy.data.objects["Wall -X"].data.materials[0] = material
    bake(probe)
    image.pixels = [0.2, 0.4, 0.9, 1.0] * 16
    assert found()[0].why == "what its face -X sees changed since its bake"
    rendered.clear()
    bake_stale(probe)
    assert rendered == ["-X"]


def hide_from(probe: bpy.types.Object, item: bpy.types.Object) -> None:
    probe.pcc_probe.hidden_objects.add().object = item


def show_cameras_only(probe: bpy.types.Object, item: bpy.types.Object) -> None:
    for rays in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(item, f"visible_{rays}", False)


@pytest.mark.parametrize("hide", [hide_from, show_cameras_only])
def test_what_no_capture_shows_counts_nowhere_and_may_scatter(probe, hide) -> None:
    box = add_box(ROOM, "Grey", (1.5, 0.0, 0.0), HALF, principled("Grey"))
    bpy.context.view_layer.update()
    assert hashes(probe) == ()
    hide(probe, box)
    before = hashes(probe)
    assert before
    move(box, 0.0, 1.2, 0.0)
    assert hashes(probe) == before


def test_a_setting_of_the_probe_or_the_world_counts_in_all(probe) -> None:
    before = hashes(probe)
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5
    assert changed(probe, before) == FACE_NAMES
    before = hashes(probe)
    probe.pcc_probe.samples += 1
    assert changed(probe, before) == FACE_NAMES


# What takes the proof away, or counts everywhere.


def fed_by(kind: str, output: str) -> bpy.types.Material:
    """A material whose emission another node decides."""
    material, emission = emissive("Own")
    node = material.node_tree.nodes.new(kind)
    material.node_tree.links.new(node.outputs[output], emission.inputs["Strength"])
    return material


def principled_with(**inputs: object) -> bpy.types.Material:
    return principled("Own", **{"Base_Color": BLACK, "Specular_IOR_Level": 0.0, **inputs})


def linked_base() -> bpy.types.Material:
    material = principled_with()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    rgb = nodes.new("ShaderNodeRGB")
    links.new(rgb.outputs[0], next(n for n in nodes if n.type == "BSDF_PRINCIPLED").inputs["Base Color"])
    return material


def animated_base() -> bpy.types.Material:
    material = principled_with()
    node = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    node.inputs["Base Color"].keyframe_insert("default_value", frame=1)
    return material


def within_group() -> bpy.types.Material:
    tree = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    end, diffuse = tree.nodes.new("NodeGroupOutput"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(diffuse.outputs[0], end.inputs[0])
    material, _ = emissive("Own")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    group = nodes.new("ShaderNodeGroup")
    group.node_tree = tree
    links.new(group.outputs[0], next(n for n in nodes if n.type == "OUTPUT_MATERIAL").inputs["Surface"])
    return material


def reaching(socket: str, kind: str) -> bpy.types.Material:
    material, _ = emissive("Own")
    node = material.node_tree.nodes.new(kind)
    output = next(n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    material.node_tree.links.new(node.outputs[0], output.inputs[socket])
    return material


SCATTERING: dict[str, Callable[[], bpy.types.Material | None]] = {
    "none": lambda: None,
    "grey": lambda: principled_with(Base_Color=(0.1, 0.1, 0.1, 1.0)),
    "specular": lambda: principled_with(Specular_IOR_Level=0.5, Roughness=1.0),
    "metal": lambda: principled_with(Metallic=1.0),
    "coat": lambda: principled_with(Coat_Weight=0.1),
    "sheen": lambda: principled_with(Sheen_Weight=0.1),
    "glass": lambda: principled_with(Transmission_Weight=0.1),
    "skin": lambda: principled_with(Subsurface_Weight=0.1),
    "film": lambda: principled_with(Thin_Film_Thickness=300.0),
    "base that is linked": linked_base,
    "base that is animated": animated_base,
    "diffuse": lambda: reaching("Surface", "ShaderNodeBsdfDiffuse"),
    "diffuse within a group": within_group,
    "ambient occlusion": lambda: fed_by("ShaderNodeAmbientOcclusion", "AO"),
    "bevel": lambda: fed_by("ShaderNodeBevel", "Normal"),
    "light path": lambda: fed_by("ShaderNodeLightPath", "Is Camera Ray"),
    "volume": lambda: reaching("Volume", "ShaderNodeVolumePrincipled"),
    "displacement": lambda: reaching("Displacement", "ShaderNodeDisplacement"),
}


@pytest.mark.parametrize("name", SCATTERING)
def test_whatever_may_scatter_light_ends_the_proof(probe, name) -> None:
    assert hashes(probe)
    box = lamp_box(1.5, 0.0, 0.0)
    assert hashes(probe)
    box.data.materials[0] = SCATTERING[name]()
    bpy.context.view_layer.update()
    assert hashes(probe) == ()


def add_text() -> None:
    text = bpy.data.objects.new("Text", bpy.data.curves.new("Text", "FONT"))
    text.data.materials.append(bpy.data.materials["Box"])
    bpy.context.scene.collection.objects.link(text)


def add_geometry_nodes() -> None:
    modifier = bpy.data.objects["Box"].modifiers.new("Nodes", "NODES")
    modifier.node_group = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")


def add_particles() -> None:
    bpy.data.objects["Box"].modifiers.new("Dust", "PARTICLE_SYSTEM")


def catch_shadows() -> None:
    bpy.data.objects["Box"].is_shadow_catcher = True


def instance_at_vertices() -> None:
    bpy.data.objects["Box"].instance_type = "VERTS"


def override_all() -> None:
    bpy.context.view_layer.material_override = principled("All")


def fill_world() -> None:
    tree = bpy.context.scene.world.node_tree
    node = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(node.outputs[0], tree.nodes["World Output"].inputs["Volume"])


def use_eevee() -> None:
    bpy.data.objects["Probe"].pcc_probe.engine = "EEVEE"


def instance_grey() -> None:
    collection = bpy.data.collections.new("Kit")
    box = add_box(ROOM, "Grey", (0.0, 0.0, 0.0), HALF, principled("Grey"))
    bpy.context.scene.collection.objects.unlink(box)
    collection.objects.link(box)
    instance(collection)


ENDING = [
    add_text, add_geometry_nodes, add_particles, catch_shadows, instance_at_vertices, override_all, fill_world,
    use_eevee, instance_grey,
]  # fmt: skip


@pytest.mark.parametrize("end", ENDING)
def test_whatever_may_be_made_otherwise_ends_the_proof(probe, end) -> None:
    lamp_box(1.5, 0.0, 0.0)
    assert hashes(probe)
    end()
    bpy.context.view_layer.update()
    assert hashes(probe) == ()


def add_lamp() -> None:
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = ROOM.world(1.0, 0.0, 0.0)
    bpy.context.scene.collection.objects.link(lamp)


def add_grey() -> None:
    add_box(ROOM, "Grey", (1.5, 0.0, 0.0), HALF, principled("Grey"))


@pytest.mark.parametrize("add", [add_lamp, add_grey])
def test_a_lamp_or_a_diffuse_object_makes_all_faces_stale(probe, rendered, add) -> None:
    bake(probe)
    add()
    bpy.context.view_layer.update()
    assert found()[0].why == "the scene or the probe changed since its bake"
    rendered.clear()
    bake_stale(probe)
    assert rendered == list(FACE_NAMES) and found() == FRESH
    assert (bake_record(probe).face_hashes == ()) == (add == add_grey)
    recolour("+X")
    rendered.clear()
    bake_stale(probe)
    assert rendered == (["+X"] if add == add_lamp else list(FACE_NAMES))


def test_a_floor_that_is_not_black_is_no_proof_and_all_is_as_before(scene, rendered, monkeypatch) -> None:
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 0)
    probe = small_room()
    bake(probe)
    assert bake_record(probe).face_hashes == ()


# Bounds that nobody knows.


def subdivide(box: bpy.types.Object) -> None:
    box.modifiers.new("Smooth", "SUBSURF").render_levels = 3


def disable(box: bpy.types.Object) -> None:
    box.hide_viewport = True


def add_shape(box: bpy.types.Object) -> None:
    box.shape_key_add(name="Basis")
    box.shape_key_add(name="Wide").value = 0.5


@pytest.mark.parametrize("change", [subdivide, disable, add_shape])
def test_what_renders_may_show_elsewhere_counts_in_every_face(probe, change) -> None:
    box = lamp_box(1.5, 0.0, 0.0)
    change(box)
    bpy.context.view_layer.update()
    before = hashes(probe)
    bpy.data.materials["Box"].node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 9.0
    assert changed(probe, before) == FACE_NAMES


# A black mirror on the floor, of which captures see nothing.


def test_what_only_a_face_sees_that_is_not_captured_leaves_a_bake_fresh(over_black, rendered) -> None:
    below = lamp_box(0.0, 0.0, -3.0)
    bake(over_black)
    assert bake_record(over_black).faces == WITHOUT_BELOW and bake_record(over_black).face_hashes
    content = bake_record(over_black).content_hash
    move(below, 0.1, 0.0, -3.0)
    scene, layer = bpy.context.scene, bpy.context.view_layer
    assert SceneFingerprint(scene, layer).content_hash(probe_spec(over_black)) != content
    assert found() == FRESH and bake_stale(over_black) == []


def test_a_face_that_changed_and_one_that_is_needed_now_are_baked_at_once(over_black, rendered) -> None:
    bake(over_black)
    add_ball(over_black)
    recolour("-X")
    rendered.clear()
    bake_stale(over_black)
    assert rendered == ["-X", "-Z"] and bake_record(over_black).faces == FACE_NAMES and found() == FRESH
    partly = picture(over_black).copy()
    bake(over_black)
    assert np.array_equal(partly, picture(over_black))


def test_a_face_that_is_guessed_is_guessed_anew_from_all_others(over_black, rendered) -> None:
    bake(over_black)
    recolour("+X")
    assert found()[0].why == "what its face +X sees changed since its bake"
    rendered.clear()
    bake_stale(over_black)
    assert tuple(rendered) == WITHOUT_BELOW


def test_a_black_mirror_that_shows_no_probe_reflects_and_is_no_proof(over_black) -> None:
    assert hashes(over_black)
    over_black.pcc_probe.is_probe = False
    elsewhere = small_probe("Elsewhere", location=(100.0, 0.0, 0.0))
    assert hashes(elsewhere) == ()


def test_a_black_mirror_that_may_be_too_rough_for_probes_is_no_proof(over_black) -> None:
    bpy.context.scene.pcc.roughness_limit = 0.5
    nodes, links = bpy.data.materials["Floor"].node_tree.nodes, bpy.data.materials["Floor"].node_tree.links
    noise = nodes.new("ShaderNodeTexNoise")
    links.new(noise.outputs[0], nodes["Principled BSDF"].inputs["Roughness"])
    bpy.context.view_layer.update()
    assert hashes(over_black) == ()


def test_an_injection_changes_nothing_of_it(over_black, rendered) -> None:
    bake(over_black)
    before, record = picture(over_black).copy(), bake_record(over_black)
    put_in()
    assert hashes(over_black) == record.face_hashes
    bake(over_black)
    assert np.array_equal(before, picture(over_black)) and bake_record(over_black).face_hashes == record.face_hashes


# Faces of one hash have one picture.


def instance(collection: bpy.types.Collection) -> bpy.types.Object:
    empty = bpy.data.objects.new("Kit", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    return empty


def moved_instances() -> Callable[[], None]:
    collection = bpy.data.collections.new("Kit")
    for y in (0.0, -2.4):
        box = add_box(ROOM, "Part", (0.0, y, 0.0), HALF, glow("Part", (2.0, 3.0, 1.0)))
        bpy.context.scene.collection.objects.unlink(box)
        collection.objects.link(box)
    collection.instance_offset = (2.0, -1.0, 0.0)
    empty = instance(collection)
    empty.location = (2.0, 0.2, 0.0)  # so that its boxes are seen before the walls +Y and -Y
    bpy.context.view_layer.update()

    def change() -> None:
        empty.location = (2.0, 0.2, 0.2)

    return change


def pane(share: float) -> bpy.types.Object:
    material, emission = emissive("Pane")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    clear, mix = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = share
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(emission.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], next(n for n in nodes if n.type == "OUTPUT_MATERIAL").inputs["Surface"])
    return add_box(ROOM, "Pane", (-1.5, 0.0, 0.0), (0.01, 0.2, 0.2), material)


def behind_glass() -> Callable[[], None]:
    pane(0.3)
    return lambda: recolour("-X")


def clearer_glass() -> Callable[[], None]:
    pane(0.3)

    def change() -> None:
        mix = next(n for n in bpy.data.materials["Pane"].node_tree.nodes if n.type == "MIX_SHADER")
        mix.inputs[0].default_value = 0.8

    return change


def stretched_and_turned() -> Callable[[], None]:
    box = lamp_box(0.0, 1.2, 0.3)

    def change() -> None:
        box.rotation_euler, box.scale = (0.4, 0.2, 1.1), (3.0, 1.0, 0.5)

    return change


def vertex_moved() -> Callable[[], None]:
    box = lamp_box(1.5, 0.0, 0.0)

    def change() -> None:
        box.data.vertices[0].co = (-1.0, -1.4, 0.5)
        box.data.update()

    return change


@pytest.mark.sweep
@pytest.mark.parametrize("build", [moved_instances, behind_glass, clearer_glass, stretched_and_turned, vertex_moved])
@pytest.mark.parametrize("floor", ["glowing", "black"])
def test_faces_of_one_hash_have_one_picture(request, build, floor) -> None:
    probe = request.getfixturevalue("probe" if floor == "glowing" else "over_black")
    probe.pcc_probe.effects.faces = "ON"
    change = build()
    bpy.context.view_layer.update()
    pictures, seen = [], []
    for _ in range(2):
        bake(probe)
        seen.append(bake_record(probe).face_hashes)
        pictures.append(of_faces(picture(probe)))
        change()
        bpy.context.view_layer.update()
    assert len(seen[0]) == len(seen[1]) == 6
    alike = [name for name, one, other in zip(FACE_NAMES, *seen, strict=True) if one == other]
    assert alike and all(np.array_equal(pictures[0][name], pictures[1][name]) for name in alike)
    assert not all(np.array_equal(pictures[0][name], pictures[1][name]) for name in FACE_NAMES)


# Records.


@pytest.mark.parametrize("of", [{"blender": "1.0"}, {"addon": "0.0.1"}, {"face_hashes": ()}])
def test_faces_are_taken_over_only_from_bakes_that_are_alike(probe, rendered, of) -> None:
    bake(probe)
    recolour("+X")
    probe.pcc_probe.bake_record = replace(bake_record(probe), **of).to_json()
    rendered.clear()
    bake_stale(probe)
    assert rendered == list(FACE_NAMES)


def test_what_was_wrong_with_a_face_is_forgotten_once_it_is_new(probe) -> None:
    bake(probe)
    record = bake_record(probe)
    before = replace(record, replaced_pixels=("face +X: 3 too bright", "face -Y: 1 negative"), seconds=2.0)
    after = completed(replace(record, faces=("+X",), seconds=1.0, replaced_pixels=("face +X: 1 negative",)), before)
    assert after.replaced_pixels == ("face -Y: 1 negative", "face +X: 1 negative")
    assert after.seconds == 3.0 and after.faces == FACE_NAMES and after.face_hashes == record.face_hashes
    assert completed(record, replace(before, face_hashes=())).face_hashes == ()
