"""Inputs of ours that repeat an animated input of the user's: by drivers, which no handler has to follow.

A keyframed input is repeated by a driver of the frame with the same keyframes, and not by one that reads the input:
that would be a cycle, since drivers of a tree count as part of it.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .. import compat

_FRAME = "frame"  # an expression that Blender knows without Python
_CURVE = ("extrapolation", "mute")
_WAY = ("interpolation", "easing", "back", "amplitude", "period", "handle_left_type", "handle_right_type")
_PLACE = ("co", "handle_left", "handle_right")


def repeat_animation(old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
    """Let an input of ours have at each frame the value of one of the user's in the same tree."""
    tree, path = new.id_data, f"{new.path_from_id()}.default_value"
    wanted = dict(_wanted(old, new))
    have = {
        c.array_index: c for c in (tree.animation_data.drivers if tree.animation_data else ()) if c.data_path == path
    }
    if {index: _says(curve) for index, curve in have.items()} == {index: _says(c) for index, c in wanted.items()}:
        return
    for curve in have.values():
        tree.animation_data.drivers.remove(curve)
    for index, curve in wanted.items():
        if curve.driver is not None:
            made = tree.animation_data.drivers.from_existing(src_driver=curve)
            made.data_path, made.array_index = path, index
        else:
            wide = hasattr(new.default_value, "__len__")
            _copy(curve, tree.driver_add(path, index) if wide else tree.driver_add(path))


def _wanted(old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> Iterator[tuple[int, bpy.types.FCurve]]:
    """The curves of the user's input by the component of ours that they are for; one number is for all components."""
    path = f"{old.path_from_id()}.default_value"
    count = len(new.default_value) if hasattr(new.default_value, "__len__") else 1
    single = not hasattr(old.default_value, "__len__")
    for curve in compat.curves_of(old.id_data):
        if curve.data_path == path:
            for index in range(count) if single else (curve.array_index,):
                if index < count:
                    yield index, curve


def _says(curve: bpy.types.FCurve) -> tuple:
    """What a curve and one that repeats it have in common."""
    driver = curve.driver
    expression = _FRAME if driver is None else driver.expression
    variables = (
        ()
        if driver is None
        else tuple((v.name, *((t.id and t.id.name_full, t.data_path) for t in v.targets)) for v in driver.variables)
    )
    points = tuple(
        tuple(value[:] if hasattr(value, "__len__") and not isinstance(value, str) else value for value in each)
        for each in ((getattr(point, name) for name in (*_WAY, *_PLACE)) for point in curve.keyframe_points)
    )
    modifiers = tuple(tuple(repr(getattr(m, name)) for name in _settings(m)) for m in curve.modifiers)
    return expression, variables, points, modifiers, tuple(getattr(curve, name) for name in _CURVE)


def _copy(curve: bpy.types.FCurve, made: bpy.types.FCurve) -> None:
    """Make a new driver say at each frame what a curve says."""
    while made.modifiers:
        made.modifiers.remove(made.modifiers[0])
    made.keyframe_points.clear()
    made.keyframe_points.add(len(curve.keyframe_points))
    _place(curve, made)  # at once, since points that are at one place for a moment become one
    for theirs, ours in zip(curve.keyframe_points, made.keyframe_points, strict=True):
        for name in _WAY:
            setattr(ours, name, getattr(theirs, name))
    _place(curve, made)
    for name in _CURVE:
        setattr(made, name, getattr(curve, name))
    for theirs in curve.modifiers:
        ours = made.modifiers.new(theirs.type)
        for name in _settings(theirs):
            setattr(ours, name, getattr(theirs, name))
    made.driver.type, made.driver.expression = "SCRIPTED", _FRAME


def _place(curve: bpy.types.FCurve, made: bpy.types.FCurve) -> None:
    for name in _PLACE:
        values = [0.0] * (2 * len(curve.keyframe_points))
        curve.keyframe_points.foreach_get(name, values)
        made.keyframe_points.foreach_set(name, values)


def _settings(modifier: bpy.types.FModifier) -> list[str]:
    """The settings of a curve's modifier that can be copied."""
    without = {"active", "show_expanded", "is_valid", "type", "rna_type", "name"}
    names = (p for p in modifier.bl_rna.properties if p.identifier not in without and not p.is_readonly)
    return [p.identifier for p in names if p.type not in {"COLLECTION", "POINTER"}]
