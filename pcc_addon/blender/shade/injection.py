"""Putting probes into materials, as the plan says, and taking them out again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import bpy

from ...core.belonging import beside, layered
from ...core.errors import PccError
from ...core.faces_needed import told_missing
from ...core.material_plan import MaterialPlan
from ...core.plan import Plan
from ...core.readings import SceneReading
from .. import marks
from ..planning import PlannedScene, read_and_plan
from ..read.probes import all_probes, bake_record
from ..stepping import Steps, at_once
from ..store.levels import bake_folder, ensure_levels
from . import by_hand, copies, groups, live
from .probe_group import refresh_group, shown_probe
from .twin import has_twins, is_torn
from .twin_order import ShownProbe, TwinOrder


@dataclass(frozen=True)
class InjectionReport:
    """What an injection did.

    Attributes:
        materials: (material, probe) names of those that now show probes, a pair for each probe.
        notes: sentences on materials, surfaces and probes that were left alone.
        plan: what was obeyed.
    """

    materials: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    plan: Plan


def inject(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    objects: Iterable[bpy.types.Object] | None = None,
    planned: PlannedScene | None = None,
) -> InjectionReport:
    """Let the materials around the scene's baked probes show them; materials that do already are brought up to date.

    Args:
        scene: the scene whose probes and objects count.
        view_layer: which of its objects are rendered.
        objects: only their materials; None: all.
        planned: what is obeyed, of the scene as it is now; None: it is read and planned first.

    Raises:
        PccError: no probe of the scene can be shown.
    """
    return at_once(injecting(scene, view_layer, objects, planned))


def injecting(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    objects: Iterable[bpy.types.Object] | None = None,
    planned: PlannedScene | None = None,
) -> Steps[InjectionReport]:
    """`inject`, a probe or a material between two yields.

    Raises:
        PccError: as `inject`.
        ReferenceError: what it was about to change was removed meanwhile.
    """
    planned = planned or read_and_plan(scene, view_layer)
    reading, plan = planned.reading, planned.plan
    notes = list(plan.notes)
    materials = {material.name_full: material for material in bpy.data.materials}
    shown = yield from _build_probes(scene, reading, plan, notes, whole=objects is None)
    if not shown:
        raise PccError(notes[0] if notes else f"scene '{scene.name}' has no probe; add one and bake it")
    chosen = None if objects is None else {material.name_full for material in materials_of(objects)}
    pairs, known = [], copies.all_copies()
    for material_plan in plan.materials:
        if chosen is not None and material_plan.material not in chosen:
            continue
        material = materials[material_plan.material]
        if not marks.is_foreign(material):
            yield from _show(material, material_plan, shown, reading, known)
        pairs += [(material.name, probe) for probe in material_plan.probes if probe in shown]
        notes += material_plan.notes
    _remove_from_others(plan, objects if objects is not None else scene.objects)
    return InjectionReport(tuple(pairs), tuple(notes), plan)


def _show(
    material: bpy.types.Material,
    plan: MaterialPlan,
    shown: Mapping[str, ShownProbe],
    scene: SceneReading,
    known: copies.Copies,
) -> Steps[None]:
    """Let a material, and the copies of it that some objects are to wear, show what is planned."""
    parts = [part for part in plan.division.parts if not part.probes or any(name in shown for name in part.probes)]
    worn = copies.divide(material, parts, known.get(material, ()))
    each = [(material, plan.division.kept), *((copy, part.probes) for copy, part in zip(worn, parts, strict=True))]
    for one, probes in each:
        order = order_of(plan, probes, shown, scene)
        if order.probes:
            live.show(one, order)
        else:
            live.remove(one)
        yield
    if plan.choices and not plan.probes:
        marks.note(material, live.WITHHELD, True)


def mend(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
    """Build again what materials show and somebody deleted; nothing else is touched."""
    torn = {marks.original(m).name_full: marks.original(m) for m in bpy.data.materials if is_torn(m)}
    if torn:
        _show_some(scene, read_and_plan(scene, view_layer), torn)


def show_anew(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, owner: bpy.types.Material | bpy.types.Object
) -> None:
    """Let a material, or all those of an object, show the probes that the plan gives them now.

    Nothing happens where no material shows any yet, nor would if that had not been chosen.

    Raises:
        PccError: a probe or a picture is faulty.
    """
    if not any(has_twins(material) or marks.noted(material, live.WITHHELD) for material in bpy.data.materials):
        return
    planned = read_and_plan(scene, view_layer)
    if isinstance(owner, bpy.types.Material):
        names = {owner.name_full}
    else:
        placed = (placement for placement in planned.reading.placements if placement.object == owner.name_full)
        names = {name for placement in placed for name in placement.materials}
    _show_some(
        scene, planned, {material.name_full: material for material in bpy.data.materials if material.name_full in names}
    )


def show_again(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, materials: Iterable[bpy.types.Material]
) -> None:
    """Let materials show the probes that the plan gives them, whether any shows one or not.

    Raises:
        PccError: a probe or a picture is faulty.
    """
    some = {material.name_full: material for material in materials}
    if some:
        _show_some(scene, read_and_plan(scene, view_layer), some)


def _show_some(scene: bpy.types.Scene, planned: PlannedScene, some: Mapping[str, bpy.types.Material]) -> None:
    reading, plan = planned.reading, planned.plan
    shown = at_once(_build_probes(scene, reading, plan, [], whole=False))
    for material_plan in plan.materials:
        material = some.get(material_plan.material)
        wanted = material_plan.probes or material_plan.choices
        if material is not None and wanted and not marks.is_foreign(material):
            at_once(_show(material, material_plan, shown, reading, copies.all_copies()))


def remove(objects: Iterable[bpy.types.Object] | None = None) -> list[str]:
    """Take the probes out of all materials, or of those on `objects`; returns the names of the restored ones."""
    objects = None if objects is None else list(objects)
    whole = None if objects is None else {material.name_full for material in materials_of(objects)}
    known = copies.all_copies()
    divided = [original for original in known if whole is None or original.name_full in whole]
    for original in divided:
        copies.unite(original, known[original])
    names = {original.name for original in divided}
    chosen = list(bpy.data.materials) if objects is None else materials_of(objects)
    restored = [m.name for m in chosen if not marks.is_foreign(m) and (live.remove(m) or m.name in names)]
    groups.drop_unused_groups()
    return restored


def materials_of(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Material]:
    """The materials of some objects, by name; the user's own for copies of ours."""
    found = {marks.original(slot.material) for item in objects for slot in item.material_slots if slot.material}
    return sorted(found, key=lambda m: m.name_full)


def order_of(
    plan: MaterialPlan, probes: Sequence[str], shown: Mapping[str, ShownProbe], scene: SceneReading
) -> TwinOrder:
    """What the twins of a material, or of a copy, are to show of some probes, each over those before it."""
    specs = scene.specs
    at_hand = layered([probe for probe in probes if probe in shown], specs, scene.borrowing)
    apart = beside([specs[probe] for probe in at_hand])
    ordered = tuple(replace(shown[probe], beside=others) for probe, others in zip(at_hand, apart, strict=True))
    return TwinOrder(ordered, plan.served, plan.emits)


def _build_probes(
    scene: bpy.types.Scene, reading: SceneReading, plan: Plan, notes: list[str], *, whole: bool
) -> Steps[dict[str, ShownProbe]]:
    """The groups of all baked probes, with the levels that the plan wants; what fails becomes a note.

    Unless the whole scene is injected, other materials may choose between a probe and others, which none is to any
    more.
    """
    shown = {}
    objects = {probe.name: probe for probe in all_probes(scene)}
    folder = bake_folder(scene)
    plans = {probe.probe: probe for probe in plan.probes}
    for probe_reading in reading.probes:
        if probe_reading.spec is None or probe_reading.fault:
            continue
        probe, probe_plan = objects[probe_reading.name], plans[probe_reading.name]
        if probe_reading.captured_at is None:
            notes.append(f"probe '{probe.name}' has no bake; bake it to see it")
            continue
        try:
            ensure_levels(probe, () if probe_plan.unneeded else probe_plan.roughnesses, folder)
            refresh_group(probe, probe_plan.receivers, probe_plan.shares or (False if whole else None))
            by_hand.refresh(probe)
            lacking = bake_record(probe).lacks(probe_plan.shown_faces)
        except PccError as error:
            notes.append(str(error))
            continue
        if lacking:
            notes.append(told_missing(probe.name, lacking))
        shown[probe.name] = shown_probe(probe.pcc_probe.group)
        yield
    return shown


def _remove_from_others(plan: Plan, objects: Iterable[bpy.types.Object]) -> None:
    """Remove the twins of materials that no probe reaches any more."""
    planned, known = {material.material for material in plan.materials}, copies.all_copies()
    for material in materials_of(objects):
        if material.name_full not in planned and not marks.is_foreign(material):
            copies.unite(material, known.get(material, ()))
            live.remove(material)
