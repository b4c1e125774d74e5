"""Inputs that repeat an animated input of the same tree; nothing is baked here."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender.shade.animation import repeat_animation


class Pair:
    """A number and a vector of the user's that are animated, and inputs of ours for them."""

    def __init__(self) -> None:
        self.tree = bpy.data.materials.new("Animated").node_tree or self._with_nodes()
        nodes = self.tree.nodes
        self.theirs, self.ours = nodes.new("ShaderNodeBsdfPrincipled"), nodes.new("ShaderNodeBsdfPrincipled")
        self.mapping = nodes.new("ShaderNodeMapping")

    def _with_nodes(self) -> bpy.types.ShaderNodeTree:
        material = bpy.data.materials["Animated"]
        material.use_nodes = True
        return material.node_tree

    def key(self, name: str, *values: object) -> bpy.types.NodeSocket:
        socket = self.theirs.inputs[name]
        for frame, value in zip((1, 6, 11), values, strict=True):
            socket.default_value = value
            socket.keyframe_insert("default_value", frame=frame)
        return socket

    def curves(self, socket: bpy.types.NodeSocket) -> dict[int, bpy.types.FCurve]:
        """The user's, by component."""
        path = f"{socket.path_from_id()}.default_value"
        action = self.tree.animation_data.action
        bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
        return {c.array_index: c for bag in bags for c in bag.fcurves if c.data_path == path}

    def drivers(self, socket: bpy.types.NodeSocket) -> dict[int, bpy.types.FCurve]:
        path = f"{socket.path_from_id()}.default_value"
        found = self.tree.animation_data.drivers if self.tree.animation_data else ()
        return {c.array_index: c for c in found if c.data_path == path}


@pytest.fixture
def pair(scene: bpy.types.Scene) -> Pair:
    return Pair()


FRAMES = (-3.0, 1.0, 2.5, 6.0, 8.25, 11.0, 17.0)


def test_a_number_and_a_vector_are_repeated_between_and_beyond_their_keys(pair: Pair) -> None:
    for name, values in (("Roughness", (0.0, 1.0, 0.25)), ("Base Color", ((1, 0, 0, 1), (0, 1, 0.5, 1), (1, 1, 1, 1)))):
        old, new = pair.key(name, *values), pair.ours.inputs[name]
        for curve in pair.curves(old).values():
            curve.keyframe_points[1].interpolation = "SINE"
            curve.keyframe_points[0].handle_right_type = "FREE"
            curve.keyframe_points[0].handle_right = (3.0, 2.0)
            curve.extrapolation = "LINEAR"
        repeat_animation(old, new)
        theirs, ours = pair.curves(old), pair.drivers(new)
        assert theirs.keys() == ours.keys() and len(ours) == (4 if name == "Base Color" else 1)
        for index, curve in theirs.items():
            assert [ours[index].evaluate(f) for f in FRAMES] == [curve.evaluate(f) for f in FRAMES]


def test_one_number_is_repeated_by_all_components_and_a_vector_by_those_that_there_are(pair: Pair) -> None:
    number, vector = pair.key("Roughness", 0.0, 1.0, 0.25), pair.mapping.inputs["Location"]
    repeat_animation(number, vector)
    assert {i: c.evaluate(6.0) for i, c in pair.drivers(vector).items()} == {0: 1.0, 1: 1.0, 2: 1.0}
    color = pair.key("Base Color", (1, 0, 0, 1), (0, 1, 0.5, 1), (1, 1, 1, 1))
    repeat_animation(color, vector)
    assert {i: c.evaluate(6.0) for i, c in pair.drivers(vector).items()} == {0: 0.0, 1: 1.0, 2: 0.5}


def test_modifiers_of_curves_are_repeated(pair: Pair) -> None:
    old, new = pair.key("Roughness", 0.0, 1.0, 0.25), pair.ours.inputs["Roughness"]
    [curve] = pair.curves(old).values()
    cycles, stepped = curve.modifiers.new("CYCLES"), curve.modifiers.new("STEPPED")
    cycles.mode_after, stepped.frame_step = "REPEAT_OFFSET", 3.0
    repeat_animation(old, new)
    [ours] = pair.drivers(new).values()
    assert [m.type for m in ours.modifiers] == ["CYCLES", "STEPPED"]
    assert [ours.evaluate(f) for f in (*FRAMES, 40.0)] == [curve.evaluate(f) for f in (*FRAMES, 40.0)]


def test_what_says_the_same_is_not_made_anew_however_its_panels_are_folded(pair: Pair) -> None:
    old, new = pair.key("Roughness", 0.0, 1.0, 0.25), pair.ours.inputs["Roughness"]
    [curve] = pair.curves(old).values()
    for kind in ("CYCLES", "STEPPED"):
        curve.modifiers.new(kind)
    repeat_animation(old, new)
    [made] = pair.drivers(new).values()
    made.driver.use_self = True  # a mark that a new one would not have
    for modifier in curve.modifiers:
        modifier.show_expanded = not modifier.show_expanded
        modifier.active = not modifier.active
        modifier.name = f"Mine {modifier.type}"
    repeat_animation(old, new)
    assert [c.driver.use_self for c in pair.drivers(new).values()] == [True]
    curve.modifiers[1].frame_step = 5.0
    repeat_animation(old, new)
    assert [c.driver.use_self for c in pair.drivers(new).values()] == [False]


def test_drivers_are_repeated_and_go_when_the_users_do(pair: Pair) -> None:
    old, new = pair.theirs.inputs["Roughness"], pair.ours.inputs["Roughness"]
    old.driver_add("default_value").driver.expression = "frame / 10"
    repeat_animation(old, new)
    assert [c.driver.expression for c in pair.drivers(new).values()] == ["frame / 10"]
    old.driver_remove("default_value")
    repeat_animation(old, new)
    assert pair.drivers(new) == {}
