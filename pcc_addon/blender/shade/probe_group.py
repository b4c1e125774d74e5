"""A probe's node group: its box, its capture point and its pictures in, one radiance for each level out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict
from functools import partial

import bpy
import numpy as np

from ...core.effects import lookup, relief
from ...core.effects.records import Correction, LookupEffects
from ...core.effects.roughness import rung_name
from ...core.expression import Operand
from ...core.lookup_plan import Receivers, lookup_effects
from ...core.probe import STEEPEST_FALLOFF, ProbeSpec
from ...core.sidecar import Sidecar
from .. import marks, unrecorded
from ..read.probes import bake_record, probe_spec
from ..read.shown import driven_object
from ..store.levels import picture_rows
from . import built, groups, playback
from .drivers import DRIVEN, driven_vector, follow
from .node_builder import Surroundings, emit
from .twin_order import ShownProbe

VERSION = 8
ROLE = "probe"
UNKNOWN_RECEIVERS = Receivers()
_BUILT_FOR = "built_for"  # the probe's matrix and drawn size when its group was built
_LOOKUP = "lookup"  # the lookup that it was built with, as plain values
_RECEIVERS = "receivers"  # what was known then of the surfaces that show it
_RUNGS, _FADE = "rungs", "fade"  # as in ShownProbe
_SHARES = "shares"  # whether it says how deep a point lies in its box


def refresh_group(
    probe: bpy.types.Object, receivers: Receivers = UNKNOWN_RECEIVERS, shares: bool | None = None
) -> None:
    """Build or rebuild the group of a baked probe; nothing happens before its first bake.

    Everything is read first: where something is missing the group stays as it is. Materials that use it keep using it.
    The box follows the probe object through drivers; the capture point stays where the pictures were taken.

    Args:
        probe: the probe object.
        receivers: what is known of the surfaces that show it; by default nothing is.
        shares: whether surfaces choose between it and other probes; None: as before.

    Raises:
        PccError: the probe's transform, its record or a picture is faulty.
    """
    record = bake_record(probe)
    if record is None:
        return
    spec = probe_spec(probe)
    captured_at, departure = record.capture_point_apart_from(spec.box.centre), record.departs_from(spec.box)
    effects = lookup_effects(spec, receivers, captured_at, record.source, departure)
    rungs, images, heights = shown_levels(probe)
    pictures = read_pictures(probe, images)
    known = known_values(spec, record, effects.correction)
    if shares is None:
        shares = probe.pcc_probe.group is not None and bool(marks.noted(probe.pcc_probe.group, _SHARES))
    recipe = f"{VERSION} {groups.VERSION} {effects.label} {heights} {shares}"
    changing = {*known, *DRIVEN}
    tree = _group_of(probe, recipe, changing)
    if built.is_built(tree, recipe, changing):
        change(tree, probe, pictures, known)
    else:
        formula = lookup.probe(effects, heights, known, shares=shares)
        tree.animation_data_clear()
        fed = given(tree, probe)
        emit(tree, formula.outputs, Surroundings(fed, pictures, groups.formula_group, frozenset(images)))
        built.note_built(tree, recipe, changing)
    playback.stop(tree)
    playback.play(tree, record, pictures.values())
    marks.note(tree, marks.VERSION, VERSION)
    marks.note(tree, _BUILT_FOR, _place(probe))
    marks.note(tree, _RECEIVERS, asdict(receivers))
    marks.note(tree, _LOOKUP, effects.to_plain())
    marks.note(tree, _RUNGS, rungs)
    marks.note(tree, _SHARES, shares)
    marks.note(tree, _FADE, spec.influence_falloff)


def shown_levels(probe: bpy.types.Object) -> tuple[list[float], dict[str, bpy.types.Image], dict[str, int]]:
    """The roughnesses of a baked probe's levels, ascending, and by the names of its outputs their pictures and heights.

    Raises:
        BakeError: a picture is missing or cannot be read.
    """
    kept = sorted(probe.pcc_probe.levels, key=lambda level: level.roughness)
    levels = [level for level in kept if level.roughness >= 0.0]
    heights = {rung_name(level.roughness): picture_rows(probe, level) for level in levels}
    images = {rung_name(level.roughness): level.image for level in levels}
    return [level.roughness for level in levels], images, heights


def read_pictures(probe: bpy.types.Object, images: Mapping[str, bpy.types.Image]) -> dict[str, bpy.types.Image]:
    """All pictures that a lookup reads: those of levels, and that of how near things are where there is one.

    Raises:
        BakeError: that one is missing or cannot be read.
    """
    for level in probe.pcc_probe.levels:
        if level.roughness < 0.0:
            picture_rows(probe, level)
            return {**images, relief.PICTURE: level.image}
    return dict(images)


def shown_probe(tree: bpy.types.ShaderNodeTree) -> ShownProbe:
    """A probe's group as twins show it."""
    return ShownProbe(tree, tuple(marks.noted(tree, _RUNGS)), marks.noted(tree, _FADE), outputs(tree))


def outputs(tree: bpy.types.ShaderNodeTree) -> tuple[str, ...]:
    """The names of a group's outputs."""
    return tuple(item.name for item in tree.interface.items_tree if item.in_out == "OUTPUT")


def probe_of(tree: bpy.types.ShaderNodeTree) -> bpy.types.Object | None:
    """The probe that a group was built for, or None where it was deleted."""
    followed = driven_object(tree)
    if followed is not None:
        return followed if followed.library or followed.users_collection else None
    if any(curve.driver.variables for curve in (tree.animation_data.drivers if tree.animation_data else ())):
        return None
    return next((o for o in bpy.data.objects if o.pcc_probe.is_probe and o.pcc_probe.group == tree), None)


def recall_group(probe: bpy.types.Object) -> None:
    """Give a library override the group that was built for it, which Blender forgets as it opens the file."""
    own = (t for t in bpy.data.node_groups if marks.role(t) == ROLE and driven_object(t) == probe and not t.library)
    if probe.override_library and (tree := next(own, None)):
        probe.pcc_probe.group = tree


def is_current(probe: bpy.types.Object) -> bool:
    """Whether a probe has a group of its own, built by this version, that is whole."""
    tree = probe.pcc_probe.group
    return (
        tree is not None
        and built.is_whole(tree)
        and marks.role(tree) == ROLE
        and marks.noted(tree, marks.VERSION) == VERSION
        and driven_object(tree) == probe
    )


def shown_effects(tree: bpy.types.ShaderNodeTree) -> str:
    """The label of the lookup effects that a probe's group was built for."""
    built = built_lookup(tree)
    return built.label if built is not None else ""


def built_lookup(tree: bpy.types.ShaderNodeTree) -> LookupEffects | None:
    """The lookup that a probe's group was built with; None where an earlier version built it."""
    plain = marks.noted(tree, _LOOKUP)
    return LookupEffects.of_plain(plain) if plain else None


def known_receivers(tree: bpy.types.ShaderNodeTree) -> Receivers:
    """What was known of the surfaces that show a probe when its group was built."""
    return Receivers(**{name: bool(value) for name, value in marks.noted(tree, _RECEIVERS, {}).items()})


def was_moved(probe: bpy.types.Object) -> bool:
    """Whether a probe stands elsewhere than when its group was built."""
    return list(marks.noted(probe.pcc_probe.group, _BUILT_FOR, ())) != _place(probe)


def follow_afar(tree: bpy.types.ShaderNodeTree, spec: ProbeSpec) -> None:
    """Give a probe's group the lengths that depend on how far from the origin it stands, and on mirrored axes."""
    wanted = _following(spec, lookup_effects(spec, UNKNOWN_RECEIVERS, spec.capture_point).correction)
    for node in tree.nodes:
        for socket in node.inputs if node.bl_idname == "ShaderNodeGroup" else ():
            value = wanted.get(socket.name)
            if value is not None and not np.allclose(socket.default_value, value, rtol=1e-6, atol=0.0):
                socket.default_value = value  # which asks for another update


def known_values(spec: ProbeSpec, record: Sidecar, correction: Correction) -> dict[str, Operand]:
    """What is the same for all points that a probe's group is asked about, by the formula's inputs."""
    return {
        "Capture Point": record.capture_point,
        "Falloff": spec.influence_falloff,
        "Normal Fade": max(spec.influence.normal_fade, STEEPEST_FALLOFF),
        "Probe Weight": spec.influence.weight,
        **_following(spec, correction),
    }


def _following(spec: ProbeSpec, correction: Correction) -> dict[str, Operand]:
    faces = {name: tuple(float(v) for v in values) for name, values in spec.shown_faces(correction).items()}
    return {"Padding": spec.influence_padding, "Boundary": spec.boundary, **faces}


def _place(probe: bpy.types.Object) -> list[float]:
    return [*(float(value) for row in probe.matrix_world for value in row), float(probe.empty_display_size)]


def _group_of(probe: bpy.types.Object, recipe: str, changing: Collection[str]) -> bpy.types.ShaderNodeTree:
    """The probe's own group; a new one where it has none, or shares that of the probe that it was copied from.

    A new one is a copy of another probe's that is built by the same recipe, where there is one.
    """
    tree = probe.pcc_probe.group
    usable = tree is not None and not tree.library and marks.role(tree) == ROLE
    if not usable or driven_object(tree) not in (None, probe):
        model = built.built_alike(ROLE, recipe, changing)
        tree = unrecorded.new(model.copy) if model else unrecorded.new_group("PCC Probe")
        marks.tag(tree, ROLE)
        probe.pcc_probe.group = tree
    tree.name = f"PCC Probe {probe.name}"
    return tree


def change(
    tree: bpy.types.ShaderNodeTree,
    probe: bpy.types.Object,
    images: Mapping[str, bpy.types.Image],
    known: Mapping[str, Operand],
) -> None:
    """Give a group that is built already a probe, pictures and values; each call takes time, so only what differs."""
    follow(tree, probe)
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeTexEnvironment" and node.image != images[node.label]:
            node.image = images[node.label]
        for socket in node.inputs if node.bl_idname == "ShaderNodeGroup" else ():
            value = np.float32(known.get(socket.name, socket.default_value))
            if not np.array_equal(socket.default_value, value):
                socket.default_value = value


def given(
    tree: bpy.types.ShaderNodeTree, probe: bpy.types.Object, of_surface: Sequence[str] = ("Position",)
) -> dict[str, Callable[[], bpy.types.NodeSocket]]:
    """What feeds the formula's inputs that every surface has, and those that follow the probe."""
    made: list[bpy.types.Node] = []
    frames: list[bpy.types.Node] = []

    def geometry(output: str) -> bpy.types.NodeSocket:
        if not made:
            made.append(tree.nodes.new("ShaderNodeNewGeometry"))
        return made[0].outputs[output]

    def driven(name: str) -> bpy.types.NodeSocket:
        if not frames:
            frames.append(tree.nodes.new("NodeFrame"))
            frames[0].name = frames[0].label = "Follows the probe"
        socket, nodes = driven_vector(tree, probe, name)
        for node in nodes:
            node.parent = frames[0]
        return socket

    of_all = {name: partial(geometry, name) for name in of_surface}
    return of_all | {name: partial(driven, name) for name in DRIVEN}
