"""Keeps twins like their originals while an artist edits: values at once, everything else by building anew."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import replace

import bpy

from ...core.belonging import beside
from ...core.effects.transmission import Interface
from ...core.errors import PccError, ProbeError
from ...core.lookup_plan import Receivers
from ...core.pictures import LADDER
from ...core.surface_plan import SurfacePlan, plan_surfaces
from .. import marks
from ..read.materials import read_material
from ..read.node_lines import node_lines
from ..read.probes import probe_spec
from ..store.levels import bake_folder, ensure_levels
from . import by_hand, copies, probe_group
from .animation import repeat_animation
from .groups import VERSION
from .probe_group import probe_of, shown_probe
from .sketch import OF, VALUES, repeat_value
from .twin import add_twins, has_twins, is_torn, remove_twins, shown_probe_groups
from .twin_order import TwinOrder

_SIGNATURE = "signature"  # note on a material: what its twins were built from
_INTERFACE = "interface"  # note on a material: how often its objects bend light, which it cannot know by itself
WITHHELD = "withheld"  # note on a material: that it would show probes if its user had not chosen otherwise


def show(material: bpy.types.Material, order: TwinOrder) -> None:
    """Let a material show what is ordered; twins that show it already only get the values of today."""
    if is_shown(material, order):
        copy_values(material.node_tree)
        return
    remove(material)
    add_twins(material, order)
    marks.note(material, _SIGNATURE, _signature(material, order))
    interfaces = {plan.interface.value for plan in order.surfaces.values()}
    if interfaces:
        marks.note(material, _INTERFACE, interfaces.pop())


def is_shown(material: bpy.types.Material, order: TwinOrder) -> bool:
    """Whether the twins of a material were built from what is ordered, and are whole."""
    built = marks.noted(material, _SIGNATURE)
    return built == _signature(material, order) and has_twins(material) and not is_torn(material)


def remove(material: bpy.types.Material) -> bool:
    """Take everything of ours out of a material; True where there was something."""
    removed = remove_twins(material)
    marks.forget(material, _SIGNATURE)
    marks.forget(material, _INTERFACE)
    marks.forget(material, WITHHELD)
    return removed


def copy_values(tree: bpy.types.ShaderNodeTree) -> None:
    """Let the inputs of twins repeat what the inputs of their originals say now."""
    for node in tree.nodes:
        values = marks.noted(node, VALUES)
        original = tree.nodes.get(marks.noted(node, OF)) if values else None
        if original is None:
            continue
        theirs = {socket.identifier: socket for socket in original.inputs}
        for socket in node.inputs:
            known = values.get(socket.identifier)
            if known in theirs and not socket.is_linked:
                repeat_value(theirs[known], socket)
                repeat_animation(theirs[known], socket)


def _signature(material: bpy.types.Material, order: TwinOrder) -> str:
    """A text that changes when the twins of a material must be built anew; values alone do not change it."""
    lines = [f"{VERSION}", *node_lines(material.node_tree, values=False)]
    lines += [
        f"{shown.group.name_full} {shown.rungs} {shown.fade} {shown.outputs} {shown.beside}" for shown in order.probes
    ]
    for path, surface in sorted(order.surfaces.items()):
        levels = [
            surface.levels(shown.rungs, ray, shown.hardening) for shown in order.probes for ray in surface.effects.rays
        ]
        lines.append(
            f"{path} {surface.effects} {levels} {surface.handed_over} {surface.layered} {surface.bends_normals}"
        )
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def refresh_probe(
    probe: bpy.types.Object,
    roughness_limit: float,
    receivers: Receivers = probe_group.UNKNOWN_RECEIVERS,
    shares: bool | None = None,
) -> None:
    """`probe_group.refresh_group`, the probe's groups by hand, and the twins that read an output which came or went.

    Raises:
        PccError: the probe's transform, its record or a picture is faulty.
    """
    before = probe.pcc_probe.group and probe_group.outputs(probe.pcc_probe.group)
    probe_group.refresh_group(probe, receivers, shares)
    by_hand.refresh(probe)
    tree = probe.pcc_probe.group
    if tree is None or before in (None, probe_group.outputs(tree)):
        return
    for material in bpy.data.materials:
        if material.node_tree and tree in shown_probe_groups(material):
            bring_up_to_date(material, roughness_limit)


def follow(materials: Iterable[bpy.types.Material], roughness_limit: float, *, make_levels: bool = False) -> None:
    """Let the twins of edited materials, and copies of these, follow what the user made of them.

    Args:
        materials: which.
        roughness_limit: rougher surfaces keep their own lobe.
        make_levels: whether levels that they need now, and that bakes left out, are made and stored.
    """
    known = copies.all_copies()
    for original in dict.fromkeys(marks.original(material) for material in materials):
        for material, groups in copies.follow(original, known.get(original, ())):
            bring_up_to_date(material, roughness_limit, groups, make_levels=make_levels)


def bring_up_to_date(
    material: bpy.types.Material,
    roughness_limit: float,
    groups: Sequence[bpy.types.ShaderNodeTree] | None = None,
    *,
    make_levels: bool = False,
) -> None:
    """Let the twins of a material follow what the user made of it; nothing happens to materials without twins.

    Probes that were deleted are shown no more. A surface that no probe can serve at present keeps its own lobe, and
    shows them again when it can be served.

    Args:
        material: which.
        roughness_limit: rougher surfaces keep their own lobe.
        groups: of the probes that it shows; None: those that it shows now.
        make_levels: as for `follow`.
    """
    if groups is None:
        groups = shown_probe_groups(material)
    if not groups or not material.node_tree or marks.is_foreign(material):
        return
    left = [group for group in groups if probe_of(group) is not None]
    if not left:
        remove(material)
        return
    reading = read_material(material)
    interface = Interface(marks.noted(material, _INTERFACE, Interface.SOLID.value))
    plans = () if reading.obstacles else plan_surfaces(reading, roughness_limit, interface)
    served = {plan.path: plan for plan in plans if plan.effects is not None}
    for group in left if make_levels else ():
        _make_levels(group, served.values())
    ordered = [replace(shown_probe(group), beside=others) for group, others in zip(left, _beside(left), strict=True)]
    show(material, TwinOrder(tuple(ordered), served, reading.emits))


def _make_levels(group: bpy.types.ShaderNodeTree, surfaces: Iterable[SurfacePlan]) -> None:
    """Make what a bake left out as no surface was so rough then; where that fails, status says that it is missing."""
    probe, shown = probe_of(group), shown_probe(group)
    levels = set().union(*(surface.levels_of_ladder(shown.hardening) for surface in surfaces))
    wanted, there = {LADDER[level] for level in levels}, {round(rung, 4) for rung in shown.rungs}
    if wanted <= there or probe is None or probe.library:
        return
    with contextlib.suppress(PccError):
        ensure_levels(probe, wanted, bake_folder(bpy.context.scene))
        probe_group.refresh_group(probe, probe_group.known_receivers(group))
        by_hand.refresh(probe)


def _beside(groups: Sequence[bpy.types.ShaderNodeTree]) -> tuple[tuple[int, ...], ...]:
    """`beside` of the probes of some groups; those whose transform is faulty are not known to be apart."""
    try:
        return beside([probe_spec(probe_of(group)) for group in groups])
    except ProbeError:
        return ((),) * len(groups)
