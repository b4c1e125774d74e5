"""Drivers that show the pictures of a sequence: at each frame the one that was baked for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import pytest

from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.shade import playback
from pcc_addon.core.sequence import Moment
from pcc_addon.core.sidecar import Sidecar
from tests.blender.helpers import small_probe

HERE, THERE, BEYOND = (0.0, 0.0, 0.0), (1.0, -2.0, 3.0), (5.0, 0.5, 0.25)


def record_of(numbers: Sequence[int], points: Sequence[tuple[float, float, float]]) -> Sidecar:
    """A bake of frames 10, 11, … that show these pictures, each taken at the point of its number."""
    record = Sidecar.of_bake(probe_spec(small_probe()), "uid", seconds=0.0, content_hash="", blender="", addon="")
    moments = [Moment(10 + k, str(number), number, points[number]) for k, number in enumerate(numbers)]
    return replace(record, moments=tuple(moments))


class Group:
    """A group that reads a picture of a sequence and one of the user's, and asks twice for a capture point."""

    def __init__(self) -> None:
        inner = bpy.data.node_groups.new("Lookup", "ShaderNodeTree")
        inner.interface.new_socket("Capture Point", in_out="INPUT", socket_type="NodeSocketVector")
        inner.interface.new_socket("Other", in_out="INPUT", socket_type="NodeSocketVector")
        self.tree = bpy.data.node_groups.new("Probe", "ShaderNodeTree")
        nodes = self.tree.nodes
        self.picture, self.foreign = (nodes.new("ShaderNodeTexEnvironment") for _ in range(2))
        self.picture.image, self.foreign.image = (bpy.data.images.new(name, 4, 2) for name in ("Ours", "Theirs"))
        self.free, self.fed, self.plain = (nodes.new("ShaderNodeGroup") for _ in range(3))
        self.free.node_tree = self.fed.node_tree = inner
        self.plain.node_tree = bpy.data.node_groups.new("Plain", "ShaderNodeTree")
        value = nodes.new("ShaderNodeCombineXYZ")
        self.tree.links.new(value.outputs[0], self.fed.inputs["Capture Point"])

    def play(self, record: Sidecar) -> None:
        playback.play(self.tree, record, [self.picture.image])

    def curve(self, path: str, index: int = 0) -> bpy.types.FCurve | None:
        curves = self.tree.animation_data.drivers if self.tree.animation_data else ()
        return next((c for c in curves if (c.data_path, c.array_index) == (path, index)), None)

    def offset(self, frame: int) -> float:
        """What is added to the frame at which the sequence begins, to have the number of its file."""
        curve = self.curve(f"{self.picture.path_from_id()}.image_user.frame_offset")
        return self.picture.image_user.frame_offset if curve is None else curve.evaluate(frame)

    def point(self, frame: int) -> tuple[float, ...]:
        path = f"{self.free.inputs['Capture Point'].path_from_id()}.default_value"
        return tuple(self.curve(path, axis).evaluate(frame) for axis in range(3))


@pytest.fixture
def group(scene: bpy.types.Scene) -> Group:
    return Group()


@pytest.mark.parametrize("numbers", [(0,), (0, 0, 0), (0, 1), (0, 0, 1, 1, 0, 2)])
def test_each_frame_has_the_number_of_its_picture_and_the_last_stays(group: Group, numbers: Sequence[int]) -> None:
    group.play(record_of(numbers, (HERE,) * 3))
    assert group.picture.image_user.frame_duration == 1 and group.picture.image_user.use_auto_refresh
    for frame, number in [*enumerate(numbers, 10), (9, numbers[0]), (10.75, numbers[0]), (99, numbers[-1])]:
        assert group.offset(frame) == number - 1, "the first frame of a sequence is its file number 1"
    moving = len(set(numbers)) > 1
    drivers = len(group.tree.animation_data.drivers) if group.tree.animation_data else 0
    assert drivers == int(moving), "what stands still needs no driver, and neither do pictures of others"


@pytest.mark.parametrize("points", [(HERE, THERE), (HERE, THERE, BEYOND)])
def test_a_picture_is_seen_from_where_it_was_taken(group: Group, points: Sequence[tuple]) -> None:
    numbers = [*range(len(points)), 0]
    group.play(record_of(numbers, points))
    for frame, number in enumerate(numbers, 10):
        assert group.point(frame) == points[number]
    assert group.curve(f"{group.fed.inputs['Capture Point'].path_from_id()}.default_value") is None
    assert len(group.tree.animation_data.drivers) == 4


def test_only_what_was_made_here_is_removed(group: Group) -> None:
    users = group.tree.driver_add(f"{group.free.inputs['Other'].path_from_id()}.default_value", 0)
    users.driver.expression = "2 * frame"
    group.play(record_of((0, 1), (HERE, THERE)))
    assert [playback.is_ours(curve) for curve in group.tree.animation_data.drivers].count(True) == 4
    playback.stop(group.tree)
    assert [curve.driver.expression for curve in group.tree.animation_data.drivers] == ["2 * frame"]
    playback.stop(bpy.data.node_groups["Lookup"])


def test_a_still_plays_nothing(group: Group) -> None:
    group.play(record_of((), ()))
    assert group.tree.animation_data is None and group.picture.image_user.frame_offset == 0
