"""A probe's node group: what comes out of it, when it is current, whose it is, and what follows the probe."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.store.levels import ensure_levels
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.lookup_plan import Receivers
from pcc_addon.core.pictures import LADDER
from tests.blender.helpers import pretend_bake, small_probe
from tests.blender.places import check_places, drawn

INSIDE = Receivers(all_inside=True, seen_from_outside=False)


def group(probe: bpy.types.Object) -> bpy.types.ShaderNodeTree:
    return probe.pcc_probe.group


def values(probe: bpy.types.Object, name: str) -> set[float]:
    """What the nodes of a probe's group are given under a name."""
    nodes = [node for node in group(probe).nodes if node.bl_idname == "ShaderNodeGroup"]
    return {socket.default_value for node in nodes for socket in node.inputs if socket.name == name}


def test_before_its_first_bake_a_probe_has_no_group(scene) -> None:
    probe = small_probe()
    probe_group.refresh_group(probe)
    assert group(probe) is None and not bpy.data.node_groups and not probe_group.is_current(probe)


def test_a_group_has_an_output_for_each_level_and_says_which(probe) -> None:
    ensure_levels(probe, LADDER, None)
    probe.pcc_probe.falloff = 0.5
    probe_group.refresh_group(probe)
    shown = probe_group.shown_probe(group(probe))
    assert shown.group == group(probe) and shown.rungs == pytest.approx(LADDER) and shown.fade == 0.5
    assert shown.outputs == probe_group.outputs(group(probe))
    assert set(shown.outputs) == {*(f"Level {k}" for k in range(len(LADDER))), "Weight"}
    nodes = [node for node in group(probe).nodes if node.bl_idname == "ShaderNodeTexEnvironment"]
    assert {node.image for node in nodes} == {level.image for level in probe.pcc_probe.levels}
    assert group(probe).name == f"PCC Probe {probe.name}"


def test_pictures_come_out_by_their_roughness(probe) -> None:
    """However the levels are stored."""
    ensure_levels(probe, LADDER[:3], None)
    probe.pcc_probe.levels.move(0, 2)
    probe_group.refresh_group(probe)
    [sharpest] = [level.image for level in probe.pcc_probe.levels if level.roughness == 0.0]
    sink = next(node for node in group(probe).nodes if node.bl_idname == "NodeGroupOutput")
    node = sink.inputs["Level 0"].links[0].from_node
    while node.bl_idname == "NodeReroute":
        node = node.inputs[0].links[0].from_node
    assert node.image == sharpest and probe_group.shown_probe(group(probe)).rungs == pytest.approx(LADDER[:3])


def test_the_lookup_is_what_the_receivers_call_for(probe) -> None:
    def shown(receivers: Receivers) -> str:
        probe_group.refresh_group(probe, receivers)
        return probe_group.shown_effects(group(probe))

    assert shown(INSIDE) == LookupEffects(Correction.ALIGNED_BOX, None, offset=False).label
    assert probe_group.outputs(group(probe)) == ("Level 0",)
    fading = LookupEffects(Correction.ALIGNED_BOX, Outside.OWN, offset=False, facing=True)
    assert shown(Receivers()) == fading.label
    probe.pcc_probe.outside = "BLACK"
    assert "outside black" in shown(Receivers()) and probe_group.outputs(group(probe)) == ("Level 0",)


def test_the_depth_is_given_where_probes_share_and_stays_until_they_do_not(probe) -> None:
    for shares, given in ((None, False), (True, True), (None, True), (False, False), (None, False)):
        probe_group.refresh_group(probe, shares=shares)
        assert ("Depth" in probe_group.outputs(group(probe))) is given


def test_nodes_of_groups_have_room(probe) -> None:
    probe.rotation_euler = (0.3, 0.2, 0.1)
    pretend_bake(probe)
    trees = [tree for tree in bpy.data.node_groups if marks.role(tree)]
    assert probe.pcc_probe.group in trees and len(trees) > 1
    for tree in trees:
        check_places(drawn(tree))


def test_a_group_is_built_in_place_and_takes_the_probes_name(probe) -> None:
    before = group(probe)
    probe.name = "Hall"
    probe_group.refresh_group(probe)
    assert group(probe) == before and before.name == "PCC Probe Hall"
    assert len([node for node in before.nodes if node.bl_idname == "ShaderNodeNewGeometry"]) == 1


def test_a_copied_probe_gets_its_own_group_and_leaves_the_originals(probe) -> None:
    copy = probe.copy()
    bpy.context.scene.collection.objects.link(copy)
    assert group(copy) == group(probe) and not probe_group.is_current(copy) and probe_group.is_current(probe)
    original = group(probe)
    probe_group.refresh_group(copy)
    assert group(copy) != original and group(probe) == original
    assert probe_group.probe_of(group(copy)) == copy and probe_group.probe_of(original) == probe
    assert probe_group.is_current(copy) and probe_group.is_current(probe)


@pytest.fixture
def builds(monkeypatch) -> list[str]:
    """The groups that are built node by node."""
    built, emit = [], probe_group.emit

    def counted(tree: bpy.types.ShaderNodeTree, *rest: object) -> None:
        built.append(tree.name)
        emit(tree, *rest)

    monkeypatch.setattr(probe_group, "emit", counted)
    return built


def test_a_group_that_is_as_it_was_built_takes_new_pictures_and_values_only(probe, builds) -> None:
    nodes = [node.as_pointer() for node in group(probe).nodes]
    picture = probe.pcc_probe.levels[0].image.copy()
    probe.pcc_probe.levels[0].image = picture
    probe.pcc_probe.falloff, probe.pcc_probe.padding = 0.75, 0.125
    probe_group.refresh_group(probe)
    assert not builds and [node.as_pointer() for node in group(probe).nodes] == nodes
    assert picture in {getattr(node, "image", None) for node in group(probe).nodes}
    assert values(probe, "Falloff") == {0.75} and list(values(probe, "Padding")) == pytest.approx([0.125], abs=1e-4)
    assert probe_group.shown_probe(group(probe)).fade == 0.75


def mute(tree: bpy.types.ShaderNodeTree) -> None:
    tree.nodes["Level 0"].mute = True


def unlink(tree: bpy.types.ShaderNodeTree) -> None:
    tree.links.remove(tree.links[0])


def remove_a_node(tree: bpy.types.ShaderNodeTree) -> None:
    tree.nodes.remove(tree.nodes["Level 0"])


def turn_a_value(tree: bpy.types.ShaderNodeTree) -> None:
    scale = next(node for node in tree.nodes if getattr(node, "operation", "") == "SCALE")
    scale.inputs["Scale"].default_value = 2.0


def project_otherwise(tree: bpy.types.ShaderNodeTree) -> None:
    tree.nodes["Level 0"].projection = "MIRROR_BALL"


def remove_a_driver(tree: bpy.types.ShaderNodeTree) -> None:
    tree.animation_data.drivers.remove(tree.animation_data.drivers[0])


def add_an_output(tree: bpy.types.ShaderNodeTree) -> None:
    tree.interface.new_socket("Mine", in_out="OUTPUT", socket_type="NodeSocketFloat")


@pytest.mark.parametrize(
    "spoil", [mute, unlink, remove_a_node, turn_a_value, project_otherwise, remove_a_driver, add_an_output]
)
def test_a_group_that_somebody_changed_is_built_anew(
    probe, builds, spoil: Callable[[bpy.types.ShaderNodeTree], None]
) -> None:
    spoil(group(probe))
    probe_group.refresh_group(probe)
    assert builds == ["PCC Probe Probe"]
    probe_group.refresh_group(probe)
    assert len(builds) == 1


def test_a_new_group_is_a_copy_of_one_like_it_that_is_whole(probe, builds) -> None:
    copy = probe.copy()
    bpy.context.scene.collection.objects.link(copy)
    mute(group(probe))
    copy.pcc_probe.falloff = 0.75
    probe_group.refresh_group(copy)
    assert len(builds) == 1, "the only group like it is not what was built"
    third = copy.copy()
    bpy.context.scene.collection.objects.link(third)
    third.pcc_probe.falloff = 0.5
    probe_group.refresh_group(third)
    assert len(builds) == 1 and len({group(p) for p in (probe, copy, third)}) == 3
    assert group(third).name == f"PCC Probe {third.name}" and probe_group.probe_of(group(third)) == third
    targets = {v.targets[0].id for c in group(third).animation_data.drivers for v in c.driver.variables}
    assert targets == {third} and probe_group.is_current(third) and probe_group.is_current(copy)
    assert values(third, "Falloff") == {0.5} and values(copy, "Falloff") == {0.75}


def test_a_group_of_the_users_is_left_alone(probe) -> None:
    theirs = bpy.data.node_groups.new("Mine", "ShaderNodeTree")
    probe.pcc_probe.group = theirs
    assert not probe_group.is_current(probe)
    probe_group.refresh_group(probe)
    assert group(probe) != theirs and theirs.name == "Mine" and not theirs.nodes and marks.role(theirs) is None


def delete_a_formula(probe: bpy.types.Object) -> None:
    bpy.data.node_groups.remove(next(n.node_tree for n in group(probe).nodes if n.bl_idname == "ShaderNodeGroup"))


def make_older(probe: bpy.types.Object) -> None:
    marks.note(group(probe), marks.VERSION, probe_group.VERSION - 1)


def lose_the_drivers(probe: bpy.types.Object) -> None:
    group(probe).animation_data_clear()


@pytest.mark.parametrize("spoil", [delete_a_formula, make_older, lose_the_drivers])
def test_a_group_that_is_old_or_torn_is_not_current_until_it_is_built_again(
    probe, spoil: Callable[[bpy.types.Object], None]
) -> None:
    assert probe_group.is_current(probe)
    spoil(probe)
    assert not probe_group.is_current(probe)
    probe_group.refresh_group(probe)
    assert probe_group.is_current(probe)


@pytest.mark.parametrize(
    "move",
    [
        lambda probe: setattr(probe.location, "x", probe.location.x + 0.01),
        lambda probe: setattr(probe.rotation_euler, "z", 0.01),
        lambda probe: setattr(probe, "empty_display_size", 1.01),
    ],
)
def test_a_probe_that_stands_elsewhere_than_its_group_says_was_moved(probe, move: Callable) -> None:
    assert not probe_group.was_moved(probe)
    move(probe)
    bpy.context.view_layer.update()
    probe_group.refresh_group(probe)
    assert not probe_group.was_moved(probe)


def test_moving_is_noticed_before_the_group_is_built_again(probe) -> None:
    probe.matrix_world.translation.x += 1.0
    assert probe_group.was_moved(probe)


def test_whose_group_it_was_is_forgotten_with_the_probe(probe) -> None:
    tree = group(probe)
    assert probe_group.probe_of(tree) == probe
    bpy.context.scene.collection.objects.unlink(probe)
    assert probe_group.probe_of(tree) is None, "in no collection it is as good as deleted"
    bpy.context.scene.collection.objects.link(probe)
    assert probe_group.probe_of(tree) == probe
    bpy.data.objects.remove(probe)
    assert probe_group.probe_of(tree) is None


def test_a_group_without_drivers_is_its_users(probe) -> None:
    tree = group(probe)
    tree.animation_data_clear()
    other = small_probe("Other")
    assert probe_group.probe_of(tree) == probe
    probe.pcc_probe.group = None
    assert probe_group.probe_of(tree) is None
    other.pcc_probe.group = tree
    assert probe_group.probe_of(tree) == other


def test_lengths_follow_a_probe_that_goes_far_away(probe) -> None:
    probe_group.refresh_group(probe, shares=True)
    near = probe_spec(probe)
    assert list(values(probe, "Padding")) == pytest.approx([near.influence_padding])
    assert list(values(probe, "Boundary")) == pytest.approx([near.boundary])
    probe.matrix_world.translation.x += 1e6
    far = probe_spec(probe)
    assert far.boundary > 2.0 * near.boundary
    probe_group.follow_afar(group(probe), far)
    for name, length in (("Padding", far.influence_padding), ("Boundary", far.boundary)):
        [found] = values(probe, name)
        assert found == pytest.approx(length, rel=1e-6)
    assert list(values(probe, "Falloff")) == pytest.approx([near.influence_falloff])
