"""Who reads a probe beside the materials that the plan gives it to: shaders made by hand, and windows."""

from __future__ import annotations

import json
from dataclasses import dataclass

import bpy

from .. import marks


@dataclass(frozen=True)
class OtherReaders:
    """What reads probes of a file, asked once for all of them.

    Attributes:
        by_hand: names of probes whose groups for shaders made by hand are in use.
        in_windows: the uids of probes whose rooms windows show.
    """

    by_hand: frozenset[str]
    in_windows: frozenset[str]

    def read_by_hand(self, probe: bpy.types.Object) -> bool:
        return probe.name in self.by_hand

    def read_by_windows(self, probe: bpy.types.Object) -> bool:
        return probe.pcc_probe.uid in self.in_windows


def other_readers() -> OtherReaders:
    """Those of the open file."""
    by_hand, windows = set(), set()
    for tree in bpy.data.node_groups:
        role = marks.role(tree) if tree.users else None
        if role == marks.BY_HAND:
            followed = driven_object(tree)
            by_hand |= {followed.name} if followed else set()
        elif role == marks.WINDOW:
            windows.update(room["uid"] for room in json.loads(marks.noted(tree, marks.ROOMS)) if room["uid"])
    return OtherReaders(frozenset(by_hand), frozenset(windows))


def driven_object(tree: bpy.types.ShaderNodeTree) -> bpy.types.Object | None:
    """The object that the drivers of a group follow, or None where there is none or it was deleted."""
    curves = tree.animation_data.drivers if tree.animation_data else ()
    return next((variable.targets[0].id for curve in curves for variable in curve.driver.variables), None)
