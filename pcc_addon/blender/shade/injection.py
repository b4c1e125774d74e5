"""Putting probes into materials and taking them out again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import bpy

from ...core.errors import PccError, ProbeError
from ...core.probe import ProbeSpec
from ..read.probes import all_probes, bake_record, probe_spec
from ..read.receivers import Survey, survey
from ..store.levels import bake_folder, ensure_levels, refresh_group
from . import groups, twin


@dataclass(frozen=True)
class InjectionReport:
    """What an injection did.

    Attributes:
        materials: (material, probe) names of those that now show a probe.
        notes: sentences on materials and probes that were left alone.
    """

    materials: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


def inject(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    objects: Iterable[bpy.types.Object] | None = None,
) -> InjectionReport:
    """Let the materials around the scene's baked probes show them; materials that do already are brought up to date.

    Args:
        scene: the scene whose probes and objects count.
        view_layer: which of its objects are rendered.
        objects: only their materials; None: all.

    Raises:
        PccError: no probe of the scene is baked.
        BakeError: a picture cannot be read or written.
    """
    notes = []
    specs: list[ProbeSpec] = []
    for probe in all_probes(scene):
        try:
            if bake_record(probe) is None:
                notes.append(f"probe '{probe.name}' has no bake; bake it to see it")
            else:
                specs.append(probe_spec(probe))
        except ProbeError as error:
            notes.append(str(error))
    if not specs:
        raise PccError(notes[0] if notes else f"scene '{scene.name}' has no probe; add one and bake it")
    found = survey(view_layer, specs, scene.pcc.roughness_limit, objects)
    probes = {probe.name: probe for probe in all_probes(scene)}
    folder = bake_folder(scene)
    for spec in specs:
        ensure_levels(probes[spec.name], found.roughnesses(spec.name), folder)
        refresh_group(probes[spec.name], objects is None and found.all_inside(spec.name))
    for receiver in found.receivers:
        twin.remove_twins(receiver.material)
        group = probes[receiver.probe].pcc_probe.group
        twin.add_twins(receiver.material, twin.Reflection(group, scene.pcc.roughness_limit))
        if receiver.others:
            others = ", ".join(f"'{name}'" for name in receiver.others)
            notes.append(
                f"material '{receiver.material.name}' is also within {others}; it shows '{receiver.probe}' everywhere"
            )
    _drop_outdated(found, scene, objects)
    shown = tuple((receiver.material.name, receiver.probe) for receiver in found.receivers)
    return InjectionReport(shown, (*notes, *found.left_alone))


def remove(objects: Iterable[bpy.types.Object] | None = None) -> list[str]:
    """Take the probes out of all materials, or of those on `objects`; returns the names of the restored ones."""
    materials = _materials(objects)
    restored = [m.name for m in materials if not m.library and twin.remove_twins(m)]
    groups.drop_unused_groups()
    return restored


def _drop_outdated(found: Survey, scene: bpy.types.Scene, objects: Iterable[bpy.types.Object] | None) -> None:
    """Remove twins from materials that call for none any more."""
    current = {receiver.material for receiver in found.receivers}
    for material in _materials(objects if objects is not None else scene.objects):
        if material not in current and not material.library and twin.shown_probe_group(material):
            twin.remove_twins(material)


def _materials(objects: Iterable[bpy.types.Object] | None) -> list[bpy.types.Material]:
    if objects is None:
        return list(bpy.data.materials)
    found = {slot.material for item in objects for slot in item.material_slots if slot.material}
    return sorted(found, key=lambda m: m.name_full)
