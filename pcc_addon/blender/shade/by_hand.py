"""The groups that users put into shaders of their own: one for each probe, made when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial

import bpy

from ...core.effects import by_hand as formula
from ...core.errors import BakeError
from ...core.lookup_plan import lookup_effects
from .. import marks, unrecorded
from ..read.probes import bake_record, probe_spec
from ..read.shown import driven_object
from . import built, groups, playback, probe_group
from .drivers import DRIVEN
from .node_builder import Surroundings, declare_sockets, emit

VERSION = 1
_SHOWN = "Shown"  # the node whose value is the formula's input of that name
_MIRRORED_VIEW = f"{marks.BY_HAND}: mirrored view"


@dataclass(frozen=True)
class Socket:
    """An input or output of a group: what it is called, is and means."""

    name: str
    kind: str
    meaning: str


_DIRECTION = "World space, from the surface on, of any length. Where nothing is linked: the mirrored view"
INPUTS = (
    Socket("Direction", "NodeSocketVector", _DIRECTION),
    Socket("Roughness", "NodeSocketFloat", "How blurred: the roughness of a GGX lobe around the direction"),
    Socket("Offset", "NodeSocketVector", "World space, metres: from the surface to where the ray starts"),
)
OUTPUTS = (
    Socket("Radiance", "NodeSocketColor", "Light that arrives along the direction. Black while probes are captured"),
    Socket("Weight", "NodeSocketFloat", "The probe's influence here, 0 to 1, fading to 0 over the falloff outside"),
    Socket("Distance", "NodeSocketFloat", "Metres along the direction to the wall of the probe's box"),
)
_VIEW_INPUTS = (Socket("Normal", "NodeSocketVector", "World space, of any length. Unlinked: the surface's own"),)
_VIEW_OUTPUTS = (Socket("Direction", "NodeSocketVector", "World space, unit: where a mirror sends the view"),)


def group_for(probe: bpy.types.Object) -> bpy.types.ShaderNodeTree:
    """The group of a baked probe for shaders made by hand; built where there is none yet.

    Raises:
        PccError: the probe has no bake, or its transform, its record or a picture is faulty.
    """
    if bake_record(probe) is None:
        raise BakeError(f"probe '{probe.name}' has no bake to show; bake it first")
    known = groups_of(probe)
    if known:
        refresh(probe)
        return known[0]
    tree = unrecorded.new_group("PCC")
    try:
        _build(tree, probe)
    except Exception:
        bpy.data.node_groups.remove(tree)
        raise
    marks.tag(tree, marks.BY_HAND)
    return tree


def groups_of(probe: bpy.types.Object) -> list[bpy.types.ShaderNodeTree]:
    """The groups of a probe for shaders made by hand."""
    ours = (tree for tree in bpy.data.node_groups if marks.role(tree) == marks.BY_HAND and not tree.library)
    return [tree for tree in ours if driven_object(tree) == probe]


def refresh(probe: bpy.types.Object) -> None:
    """Let the groups of a probe for shaders made by hand show its newest bake, in place.

    Raises:
        PccError: the probe's transform, its record or a picture is faulty.
    """
    for tree in groups_of(probe):
        _build(tree, probe)


def is_current(probe: bpy.types.Object) -> bool:
    """Whether all groups of a probe for shaders made by hand are whole and of this version."""
    return all(built.is_whole(tree) and marks.noted(tree, marks.VERSION) == VERSION for tree in groups_of(probe))


def mirrored_view_group() -> bpy.types.ShaderNodeTree:
    """The group that mirrors the view in a normal; built where there is none yet."""
    found = (t for t in bpy.data.node_groups if marks.role(t) == _MIRRORED_VIEW and not t.library)
    tree = next(found, None)
    if tree is None:
        tree = unrecorded.new_group("PCC Mirrored View")
        marks.tag(tree, _MIRRORED_VIEW)
        emit(tree, formula.MIRRORED_VIEW.outputs, Surroundings(_view(tree)))
        _describe(tree, _VIEW_INPUTS, _VIEW_OUTPUTS)
    return tree


def hide(stack: ExitStack) -> None:
    """Make what shaders made by hand show of probes black until `stack` closes."""
    _show(0.0)
    stack.callback(_show, 1.0)


def _show(value: float) -> None:
    for tree in bpy.data.node_groups:  # found anew each time, as a bake may build them anew meanwhile
        node = tree.nodes.get(_SHOWN) if marks.role(tree) == marks.BY_HAND else None
        if node is not None:
            node.outputs[0].default_value = value


def _build(tree: bpy.types.ShaderNodeTree, probe: bpy.types.Object) -> None:
    """Build a group, or give one that is as it was built the pictures and values of today."""
    record, spec = bake_record(probe), probe_spec(probe)
    if record is None:
        return
    # A user may put it on any surface, so nothing is known of those that show it.
    captured_at = record.capture_point_apart_from(spec.box.centre)
    effects = lookup_effects(
        spec, probe_group.UNKNOWN_RECEIVERS, captured_at, record.source, record.departs_from(spec.box)
    )
    rungs, images, heights = probe_group.shown_levels(probe)
    pictures = probe_group.read_pictures(probe, images)
    known = probe_group.known_values(spec, record, effects.correction)
    changing = {*known, *DRIVEN}
    recipe = f"{VERSION} {groups.VERSION} {effects.label} {heights} {rungs}"
    tree.name = f"PCC {probe.name}"
    if built.is_built(tree, recipe, changing):
        probe_group.change(tree, probe, pictures, known)
        playback.stop(tree)
        playback.play(tree, record, pictures.values())
        return
    before = tree.nodes.get(_SHOWN)
    shown = before.outputs[0].default_value if before else 1.0
    tree.animation_data_clear()
    declare_sockets(tree, "INPUT", {socket.name: socket.kind for socket in INPUTS})  # in this order
    fed = probe_group.given(tree, probe, ("Position", "Incoming", "Normal"))
    fed[_SHOWN] = lambda: _value(tree, shown)
    outputs = formula.by_hand(effects, heights, rungs, known).outputs
    emit(tree, outputs, Surroundings(fed, pictures, groups.formula_group, frozenset({"Radiance"})))
    _describe(tree, INPUTS, OUTPUTS)
    built.note_built(tree, recipe, changing)
    playback.stop(tree)
    playback.play(tree, record, pictures.values())
    marks.note(tree, marks.VERSION, VERSION)


def _value(tree: bpy.types.ShaderNodeTree, value: float) -> bpy.types.NodeSocket:
    node = tree.nodes.new("ShaderNodeValue")
    node.name = node.label = _SHOWN
    node.outputs[0].default_value = value
    return node.outputs[0]


def _view(tree: bpy.types.ShaderNodeTree) -> dict[str, Callable[[], bpy.types.NodeSocket]]:
    """What feeds the inputs of the mirrored view that every surface has."""

    def geometry(output: str) -> bpy.types.NodeSocket:
        node = tree.nodes.get("Geometry") or tree.nodes.new("ShaderNodeNewGeometry")
        node.name = "Geometry"
        return node.outputs[output]

    return {"Incoming": partial(geometry, "Incoming"), "Surface Normal": partial(geometry, "Normal")}


def _describe(tree: bpy.types.ShaderNodeTree, inputs: Sequence[Socket], outputs: Sequence[Socket]) -> None:
    meanings = {(way, s.name): s.meaning for way, part in (("INPUT", inputs), ("OUTPUT", outputs)) for s in part}
    for item in tree.interface.items_tree:
        item.description = meanings[item.in_out, item.name]
        if item.name == "Roughness":
            item.subtype, item.min_value, item.max_value = "FACTOR", 0.0, 1.0
        elif item.in_out == "INPUT":
            item.hide_value = item.name != "Offset"  # what is not linked says so
