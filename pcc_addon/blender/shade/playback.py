"""Which picture of a sequence is shown when: drivers of the frame, which Blender follows where the add-on is not.

A driver's value goes through the driver's own keyframes, so one whose value is the frame is a table of frames. Unlike
an action it belongs to the group alone and is copied with it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import bpy

from ...core.frames import FIRST_FRAME
from ...core.sequence import Change, changes
from ...core.sidecar import Sidecar

_FRAME = "frame"  # an expression that Blender knows without Python
_POINT = "Capture Point"


def play(tree: bpy.types.ShaderNodeTree, record: Sidecar, images: Collection[bpy.types.Image]) -> None:
    """Let a group show at each frame the picture that was baked for it, as taken from where it was taken.

    What `play` made before of the same pictures must have been removed with `stop`.

    Args:
        tree: the group.
        record: of the bake that it shows.
        images: the pictures of that bake.
    """
    if not record.moments:
        return
    found = changes(record.moments)
    for node in tree.nodes:
        if getattr(node, "image", None) in set(images):
            user = node.image_user
            # One frame, which lasts for ever: what is shown is the offset alone.
            user.frame_start, user.frame_duration, user.use_cyclic, user.use_auto_refresh = FIRST_FRAME, 1, False, True
            user.frame_offset = found[0].number - 1
            if len(found) > 1:
                _follow(
                    tree, f"{node.path_from_id()}.image_user.frame_offset", -1, found, [c.number - 1 for c in found]
                )
    if len({change.capture_point for change in found}) > 1:
        for node in tree.nodes:
            socket = node.inputs.get(_POINT) if node.bl_idname == "ShaderNodeGroup" else None
            if socket is not None and not socket.is_linked:
                for axis in range(3):
                    path = f"{socket.path_from_id()}.default_value"
                    _follow(tree, path, axis, found, [change.capture_point[axis] for change in found])


def stop(tree: bpy.types.ShaderNodeTree) -> None:
    """Remove what `play` made."""
    for curve in [c for c in (tree.animation_data.drivers if tree.animation_data else ()) if is_ours(c)]:
        tree.animation_data.drivers.remove(curve)


def is_ours(curve: bpy.types.FCurve) -> bool:
    """Whether a driver of a group of ours was made by `play`."""
    return curve.driver.expression == _FRAME


def _follow(
    tree: bpy.types.ShaderNodeTree, path: str, axis: int, found: Sequence[Change], values: Sequence[float]
) -> None:
    """Let a property have from each change on its value."""
    curve = tree.driver_add(path, axis) if axis >= 0 else tree.driver_add(path)
    while curve.modifiers:
        curve.modifiers.remove(curve.modifiers[0])
    curve.keyframe_points.clear()
    curve.keyframe_points.add(len(found))
    pairs = zip(found, values, strict=True)
    curve.keyframe_points.foreach_set("co", [float(v) for change, value in pairs for v in (change.frame, value)])
    for point in curve.keyframe_points:
        point.interpolation = "CONSTANT"
    curve.update()
    curve.driver.type, curve.driver.expression = "SCRIPTED", _FRAME
