"""A probe's shader follows the probe object: its box through drivers, its orientation through the handler."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.read.shown import driven_object
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.shade.drivers import driven_vector
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from sample_blends.scenes import principled
from tests.blender.helpers import pretend_bake, small_probe
from tests.shader_harness import evaluate_group

TURNED = (0.3, -0.4, 0.9)
EPS = float(np.finfo(np.float32).eps)
TURN = Euler(TURNED).to_matrix().to_4x4()
SHEAR = Matrix(((1.0, 0.5, 0.0, 0.0), (0.0, 1.0, -0.25, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)))


def box(probe: bpy.types.Object) -> dict[str, np.ndarray]:
    """The box values that a probe's group passes on to its lookup, by name, as the drivers left them."""
    bpy.context.view_layer.update()
    tree = probe.pcc_probe.group
    found = {}
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeCombineXYZ":
            scale = node.outputs[0].links[0].to_node.inputs["Scale"].default_value
            found[node.name] = np.array([socket.default_value * scale for socket in node.inputs])
    return found


def check_box(probe: bpy.types.Object) -> None:
    """The driven values are those of the probe's own box to float32 accuracy."""
    found = box(probe)
    expected = probe_spec(probe).box
    turning = {"aligned": (), "turned": ("Turn Mirror",), "oriented": [f"Face Normal {axis}" for axis in "XYZ"]}
    correction = probe_group.shown_effects(probe.pcc_probe.group).split()[0]
    assert found.keys() == {"Box Centre", "Half Widths", *turning[correction]}
    assert np.allclose(found["Box Centre"], expected.centre, rtol=4 * EPS, atol=0.0)
    # Cofactors and determinant are of float32 numbers; products of a sheared box cancel.
    lost = 4 * EPS * np.linalg.cond(expected.axes / expected.half_extents)
    assert np.allclose(found["Half Widths"], expected.half_widths, rtol=lost, atol=0.0)
    if "Turn Mirror" in found:
        assert np.allclose(found["Turn Mirror"], expected.turn_mirror, rtol=0.0, atol=4 * EPS)
    if "Face Normal X" in found:
        normals = np.array([found[f"Face Normal {axis}"] for axis in "XYZ"])
        assert np.allclose(normals, expected.face_normals, rtol=0.0, atol=lost)


@pytest.fixture
def probe(scene) -> bpy.types.Object:
    """A turned, baked probe in view of a material that shows it."""
    probe = small_probe(rotation=TURNED)
    pretend_bake(probe)
    show(probe)
    return probe


def show(probe: bpy.types.Object) -> None:
    """Put the probe's group into a rendered material, which makes its drivers run."""
    material = principled("Shows the Probe")
    material.node_tree.nodes.new("ShaderNodeGroup").node_tree = probe.pcc_probe.group
    mesh = bpy.data.meshes.new("Shows the Probe")
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Shows the Probe", mesh))


def test_the_box_is_right_when_the_group_is_built(probe) -> None:
    check_box(probe)


@pytest.mark.parametrize(
    "matrix",
    [
        Matrix.Translation((7.0, -3.0, 0.125)) @ TURN,
        TURN @ Matrix.Diagonal((0.5, 8.0, 30.0, 1.0)),
        TURN @ Matrix.Diagonal((-2.0, 3.0, 1.0, 1.0)),
        TURN @ Matrix.Diagonal((-2.0, -3.0, -1.0, 1.0)),
        Matrix.Translation((1e4, -2e4, 300.0)) @ TURN,
        Matrix.Translation((3e-5, -7e-5, 2e-9)) @ TURN,
        TURN @ Matrix.Diagonal((5e-5, 2e-5, 9e-5, 1.0)),
        TURN @ Matrix.Diagonal((5e4, 1e5, 2e6, 1.0)),
        Euler((2e-5, -3e-5, 5e-5)).to_matrix().to_4x4() @ Matrix.Diagonal((2.0, 3.0, 4.0, 1.0)),
    ],
    ids=[
        "moved", "scaled", "mirrored", "mirrored thrice", "far away", "a hair's breadth from the origin", "minute",
        "vast", "turned by a hair",
    ],
)  # fmt: skip
def test_the_box_follows_the_object(probe, matrix) -> None:
    before = box(probe)
    probe.matrix_world = matrix
    check_box(probe)
    assert any(not np.array_equal(before[name], values) for name, values in box(probe).items())


def test_the_box_follows_the_size_that_the_empty_is_drawn_with(probe) -> None:
    probe.empty_display_size = 2.5
    check_box(probe)


def test_the_box_follows_a_parent_that_shears_it(probe) -> None:
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (3.0, 1.0, 0.5)
    probe.parent = parent
    bpy.context.view_layer.update()
    axes = probe_spec(probe).box.axes
    assert abs(axes[:, 0] @ axes[:, 1]) > 0.1, "the box is not sheared"
    check_box(probe)
    parent.location = (4.0, 5.0, 6.0)
    parent.scale = (-1.0, 2.0, 3.0)
    check_box(probe)


def test_a_box_without_volume_gives_finite_values(probe) -> None:
    probe.scale = (1.0, 0.0, 1.0)
    for values in box(probe).values():
        assert np.isfinite(values).all()


def test_the_box_of_an_unturned_probe_follows_it(scene) -> None:
    probe = small_probe()
    pretend_bake(probe)
    show(probe)
    check_box(probe)
    probe.location, probe.scale = (3e-5, 20.0, -4.0), (1e5, 2.0, -3e-5)
    check_box(probe)


def test_shaders_read_the_values_that_the_drivers_give(probe) -> None:
    probe.matrix_world = Matrix.Translation((3e-5, -40.0, 2.0)) @ TURN @ Matrix.Diagonal((2e5, 0.5, 3e-5, 1.0))
    expected = box(probe)
    tree = probe.pcc_probe.group.copy()
    sink = next(node for node in tree.nodes if node.bl_idname == "NodeGroupOutput")
    for name in expected:
        tree.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketVector")
        tree.links.new(tree.nodes[name].outputs[0].links[0].to_node.outputs[0], sink.inputs[name])
    nothing = dict.fromkeys(("Normal", "Direction", "Offset"), np.zeros((1, 3)))
    found = evaluate_group(tree, nothing, list(expected))
    for name, values in expected.items():
        assert np.allclose(found[name][0], values, rtol=2 * EPS, atol=0.0), name


def test_driven_nodes_say_what_and_whose_they_are(probe) -> None:
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    assert driven_object(tree) is None
    tree.animation_data_create()
    assert driven_object(tree) is None
    socket, (node, unscale) = driven_vector(tree, probe, "Box Centre")
    assert node.name == node.label == "Box Centre" and socket == unscale.outputs["Vector"]
    assert driven_object(tree) == probe
    bpy.data.objects.remove(probe)
    assert driven_object(tree) is None


def test_every_driver_runs_where_scripts_are_disabled(probe) -> None:
    drivers = [curve.driver for curve in probe.pcc_probe.group.animation_data.drivers]
    assert len(drivers) == 15
    bpy.context.view_layer.update()
    assert all(driver.is_valid and driver.is_simple_expression for driver in drivers)


def test_a_driver_expression_of_python_would_not_count_as_simple(probe) -> None:
    driver = probe.pcc_probe.group.animation_data.drivers[0].driver
    driver.expression = "max([1, 2])"
    assert not driver.is_simple_expression


def test_the_capture_point_stays_where_the_pictures_were_taken(probe) -> None:
    captured_at = tuple(probe_spec(probe).capture_point)
    for _ in range(2):
        probe.location.x += 5.0
        probe.rotation_euler.z += 1.0
        bpy.context.view_layer.update()
        find = next(node for node in probe.pcc_probe.group.nodes if node.label == "Lookup")
        assert tuple(find.inputs["Capture Point"].default_value) == pytest.approx(captured_at)


ALIGNED, TURNED_ABOUT_Z, ORIENTED = (
    LookupEffects(correction, Outside.OWN, False, facing=True).label
    for correction in (Correction.ALIGNED_BOX, Correction.TURNED_BOX, Correction.ORIENTED_BOX)
)


def test_a_probe_that_is_turned_gets_the_lookup_that_holds_there_and_back(scene) -> None:
    probe = small_probe()
    pretend_bake(probe)
    show(probe)
    user = bpy.data.materials["Shows the Probe"].node_tree.nodes["Group"]
    assert probe_group.shown_effects(probe.pcc_probe.group) == ALIGNED
    for degrees in (10.0, -135.0, 180.0):
        probe.rotation_euler.z = math.radians(degrees)
        bpy.context.view_layer.update()
        assert probe_group.shown_effects(probe.pcc_probe.group) == TURNED_ABOUT_Z
        check_box(probe)
    probe.rotation_euler.x = 0.1
    bpy.context.view_layer.update()
    assert probe_group.shown_effects(probe.pcc_probe.group) == ORIENTED
    check_box(probe)
    probe.rotation_euler = (0.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert probe_group.shown_effects(probe.pcc_probe.group) == ALIGNED
    assert user.node_tree == probe.pcc_probe.group, "materials keep using the group"


def test_a_probe_moved_away_from_its_capture_point_gets_the_lookup_with_an_offset_and_back(scene) -> None:
    probe = small_probe(rotation=TURNED)
    pretend_bake(probe)
    show(probe)
    assert probe_group.shown_effects(probe.pcc_probe.group) == ORIENTED
    probe.location.x += 0.5
    bpy.context.view_layer.update()
    moved = LookupEffects(Correction.ORIENTED_BOX, Outside.OWN, offset=True, facing=True)
    assert probe_group.shown_effects(probe.pcc_probe.group) == moved.label
    probe.location.x -= 0.5
    bpy.context.view_layer.update()
    assert probe_group.shown_effects(probe.pcc_probe.group) == ORIENTED


@pytest.mark.parametrize("moved_by", ["keyframes", "a constraint", "a parent's keyframes", "a driver"])
def test_an_animated_probe_has_the_lookup_that_holds_wherever_it_goes(scene, moved_by) -> None:
    probe = small_probe()
    mover = bpy.data.objects.new("Mover", None)
    scene.collection.objects.link(mover)
    if moved_by == "a constraint":
        probe.constraints.new("COPY_LOCATION").target = mover
    elif moved_by == "a driver":
        probe.driver_add("location", 0).driver.expression = "3 + frame / 4"
    else:
        item = probe if moved_by == "keyframes" else mover
        probe.parent = mover
        for frame, turn in ((1, 0.0), (20, 0.4)):
            item.rotation_euler.x = turn
            item.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_set(1)
    pretend_bake(probe)
    show(probe)
    assert probe_group.shown_effects(probe.pcc_probe.group) == LookupEffects(Correction.ORIENTED_BOX, facing=True).label
    scene.frame_set(20)
    assert probe_group.shown_effects(probe.pcc_probe.group) == LookupEffects(Correction.ORIENTED_BOX, facing=True).label
    check_box(probe)


def test_a_probe_moved_far_away_widens_its_padding_by_what_float32_resolves_there(scene) -> None:
    probe = small_probe(capture_offset=(0.1, 0.0, 0.0))
    probe.pcc_probe.padding = 0.0
    pretend_bake(probe)
    show(probe)
    before = next(node for node in probe.pcc_probe.group.nodes if node.label == "Lookup").as_pointer()
    probe.location.x = 1e5
    bpy.context.view_layer.update()
    find = next(node for node in probe.pcc_probe.group.nodes if node.label == "Lookup")
    assert find.inputs["Padding"].default_value == pytest.approx(probe_spec(probe).influence_padding, rel=1e-5)
    assert find.as_pointer() == before, "without building anew"


def test_a_probe_whose_parent_is_turned_gets_the_oriented_lookup(scene) -> None:
    parent = bpy.data.objects.new("Parent", None)
    scene.collection.objects.link(parent)
    probe = small_probe()
    probe.parent = parent
    bpy.context.view_layer.update()
    pretend_bake(probe)
    assert probe_group.shown_effects(probe.pcc_probe.group) == ALIGNED
    parent.rotation_euler.y = 1.0
    bpy.context.view_layer.update()
    assert probe_group.shown_effects(probe.pcc_probe.group) == LookupEffects(Correction.ORIENTED_BOX, facing=True).label


@pytest.mark.parametrize(
    ("setting", "value", "socket"), [("padding", 0.5, "Padding"), ("falloff", 0.75, "Falloff")], ids=str
)
def test_a_changed_setting_is_shown_at_once(probe, setting, value, socket) -> None:
    setattr(probe.pcc_probe, setting, value)
    find = next(node for node in probe.pcc_probe.group.nodes if node.label == "Lookup")
    assert find.inputs[socket].default_value == pytest.approx(value, rel=1e-4)


def test_the_classic_lookup_and_the_black_outside_are_shown_at_once(probe) -> None:
    probe.pcc_probe.outside = "BLACK"
    assert (
        probe_group.shown_effects(probe.pcc_probe.group)
        == LookupEffects(outside=Outside.BLACK, offset=False, facing=True).label
    )
    probe.pcc_probe.correction = "NONE"
    assert probe_group.shown_effects(probe.pcc_probe.group) == LookupEffects(Correction.NONE, None, False).label
    assert probe.pcc_probe.group.animation_data is None or not probe.pcc_probe.group.animation_data.drivers
