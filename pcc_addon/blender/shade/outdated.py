"""What materials show of probes and would not after an injection, since the scene calls for something else now."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import bpy

from ...core.lookup_plan import lacking
from ...core.material_plan import MaterialPlan
from ...core.plan import Plan
from ...core.probe_plan import ProbePlan
from ...core.readings import SceneReading
from ...core.words import named
from .. import marks
from . import copies, live, probe_group
from .injection import order_of
from .probe_group import shown_probe
from .twin import has_twins, shown_probe_groups
from .twin_order import ShownProbe


def outdated(scene: SceneReading, plan: Plan, probes: Mapping[str, bpy.types.Object]) -> dict[str, tuple[str, ...]]:
    """By probe, in words, what an injection would change.

    Only of probes that some material shows, or would instead of what it shows now, as that of another scene.

    Args:
        scene: what there is.
        plan: what is decided.
        probes: the probes' objects by name.
    """
    current = {name: item.pcc_probe.group for name, item in probes.items() if probe_group.is_current(item)}
    shown = {name: shown_probe(tree) for name, tree in current.items()}
    found = {}
    late = _late_materials(scene, plan, shown)
    used = {tree for material in bpy.data.materials if material.node_tree for tree in shown_probe_groups(material)}
    injected = {material.name_full for material in bpy.data.materials if has_twins(material)}
    for probe in plan.probes:
        if probe.probe not in shown:
            continue
        if current[probe.probe] not in used and injected.isdisjoint(late.get(probe.probe, ())):
            continue
        words = [*_lacking(probe, current[probe.probe])]
        if probe.probe in late:
            words.append(f"{named(late[probe.probe])} would show it otherwise")
        if words:
            found[probe.probe] = tuple(words)
    return found


def _late_materials(scene: SceneReading, plan: Plan, shown: Mapping[str, ShownProbe]) -> dict[str, list[str]]:
    """By probe the materials that are not what an injection would make of them."""
    materials = {material.name_full: material for material in bpy.data.materials}
    known = copies.all_copies()
    found: dict[str, list[str]] = {}
    planned = {each.material for each in plan.materials if each.probes or not each.choices}
    names = {each.group: probe for probe, each in shown.items()}
    for reading in scene.materials:
        if reading.name not in planned and not marks.is_foreign(materials[reading.name]):
            material = materials[reading.name]
            groups = {group for one in (material, *known.get(material, ())) for group in shown_probe_groups(one)}
            for probe in sorted(names[group] for group in groups if group in names):
                found.setdefault(probe, []).append(reading.name)
    for each in plan.materials:
        material = materials[each.material]
        wanted = [probe for probe in each.probes if probe in shown]
        if wanted and not marks.is_foreign(material):
            worn = known.get(material, [])
            orders = [order_of(each, probes, shown, scene) for probes in _shown_as(each, shown)]
            right = sum(any(live.is_shown(one, order) for one in (material, *worn)) for order in orders)
            if right < len(orders) or len(worn) > len(each.division.parts):
                for probe in wanted:
                    found.setdefault(probe, []).append(each.material)
    return found


def _shown_as(plan: MaterialPlan, shown: Mapping[str, ShownProbe]) -> Iterator[tuple[str, ...]]:
    """The probes of a material itself and of each of its copies, where there is one."""
    for probes in (plan.division.kept, *(part.probes for part in plan.division.parts)):
        if any(probe in shown for probe in probes):
            yield probes


def _lacking(plan: ProbePlan, group: bpy.types.ShaderNodeTree) -> Iterator[str]:
    """What the group of a probe has not got, and surfaces need now."""
    there = {round(rung, 4) for rung in shown_probe(group).rungs}
    missing = [roughness for roughness in plan.roughnesses if roughness not in there]
    if missing:
        yield f"pictures for roughness {', '.join(f'{r:.3g}' for r in missing)} are missing"
    built = probe_group.built_lookup(group)
    if built is not None:
        yield from (f"its lookup lacks '{effect.label}'" for effect in lacking(built, plan.lookup))
