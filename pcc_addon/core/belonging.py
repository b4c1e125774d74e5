"""Which probes the objects of a scene belong to."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from .effects.choice import handover
from .probe import ProbeSpec
from .readings import PlacementReading

_STEPS = np.linspace(0.0, 1.0, 5)  # points along each edge of an object's bounds
_EDGES = np.stack([1.0 - _STEPS, _STEPS], -1)
_WITHIN = np.einsum("ia,jb,kc->ijkabc", _EDGES, _EDGES, _EDGES).reshape(-1, 8)  # points within, from the 8 corners
_SHARE = 0.05  # of an object's bounds, from which on it counts for a probe beside the one that it is mostly in
_FILLED = 0.5  # of a box along the axes that an object has, from which on one that runs through many rooms counts


@dataclass(frozen=True)
class Belongings:
    """What belongs to whom.

    Attributes:
        owners: by material, by probe, by object: how much of it the probe has, about 0 … 1.
        leaving: by probe: the materials of objects that may show it and reach beyond its influence box and padding.
        touching: by probe: the materials of objects that may show it and reach to its box or beyond.
        beyond: by probe: those of `touching` whose objects reach beyond its box.
        strays: by material, by object: the probes that it reaches, where it would show others too if its material does.
        needs: by material, by object: the probes that its points may show, those that it hardly reaches included.
        refused: by material, by object: the probes whose influence it reaches and that it is not to show.
        refusing: by probe: the objects in its influence that are not to show it.
        avoiding: by probe: the materials of objects in its influence that are to show another one alone, or none.
        excluded: by material: its objects in the influence of probes that are to show none.
        fixed: by material: its objects that cannot wear a copy of it.
    """

    owners: dict[str, dict[str, dict[str, float]]] = field(default_factory=dict)
    leaving: dict[str, set[str]] = field(default_factory=dict)
    touching: dict[str, set[str]] = field(default_factory=dict)
    beyond: dict[str, set[str]] = field(default_factory=dict)
    strays: dict[str, dict[str, set[str]]] = field(default_factory=dict)
    needs: dict[str, dict[str, set[str]]] = field(default_factory=dict)
    refused: dict[str, dict[str, set[str]]] = field(default_factory=dict)
    refusing: dict[str, set[str]] = field(default_factory=dict)
    avoiding: dict[str, set[str]] = field(default_factory=dict)
    excluded: dict[str, set[str]] = field(default_factory=dict)
    fixed: dict[str, set[str]] = field(default_factory=dict)


def belongings(
    probes: Sequence[ProbeSpec],
    placements: Sequence[PlacementReading],
    moving: Collection[str] = frozenset(),
    allowed: Mapping[str, Collection[str]] = MappingProxyType({}),
) -> Belongings:
    """Find the probes that each placement is in the influence of, and among them those that it belongs to.

    A placement belongs to the probe with the largest share of its bounds, the nearest of those with equal shares, and
    to every other one with a share worth mentioning.

    Args:
        probes: those of the scene.
        placements: what is there.
        moving: names of objects that move; they count as leaving the boxes that they are in now.
        allowed: by material, names of the only probes that it may show; other materials may show all.
    """
    found = Belongings()
    if not probes or not placements:
        return found
    lows, highs = _bounds(probes)
    margin = handover(max(probe.influence_falloff for probe in probes))
    lows, highs = lows - margin, highs + margin
    for placement, names in _alike(placements, allowed):
        low, high = placement.corners.min(0), placement.corners.max(0)
        near = ((lows <= high) & (highs >= low)).all(1).nonzero()[0].tolist()
        reached = [probes[k] for k in near if probes[k].overlaps(placement.corners)]
        if names is not None:
            _note_avoided(found, placement, [probe.name for probe in reached if probe.name not in names])
            near = [k for k in near if probes[k].name in names]
            reached = [probe for probe in reached if probe.name in names]
        accepted = [p for p in reached if p.influence.accepts(placement.object) and not placement.excluded]
        refused = [probe.name for probe in reached if probe not in accepted]
        _note_refused(found, placement, refused)
        reached = accepted
        shares = {probe.name: _share(probe, placement.corners) for probe in reached}
        moves = placement.object in moving
        if not shares:
            _note_stray(found, placement, [])
            continue
        best = min(shares, key=lambda name: (-round(shares[name][0], 6), round(shares[name][1], 6), name))
        own = next(probe for probe in reached if probe.name == best)
        needed = _needed(own, reached, placement.corners)
        whole = not moves and _has_all_of(own, placement.corners)
        if not whole:
            _note_stray(found, placement, [probe.name for probe in reached])
        for probe in (probes[k] for k in near):
            kept_out = whole and probe is not own and _keeps_out(probe, own, placement.corners)
            if not (kept_out or probe.name in refused):
                _note_reach(found, probe, placement, moves)
        for probe in reached:
            share, distance = shares[probe.name]
            if probe.name != best and share < _SHARE and _fills(probe, placement.corners) < _FILLED:
                continue
            _note_fixed(found, placement)
            for material in placement.materials:
                found.needs.setdefault(material, {}).setdefault(placement.object, set()).update(needed)
                tally = found.owners.setdefault(material, {}).setdefault(probe.name, {})
                tally[placement.object] = tally.get(placement.object, 0.0) + share + 1e-3 / (1.0 + distance)
    return found


def _alike(
    placements: Iterable[PlacementReading], allowed: Mapping[str, Collection[str]]
) -> Iterator[tuple[PlacementReading, Collection[str] | None]]:
    """Each placement with those of its materials that may show the same probes, and the names of these; None: all."""
    for placement in placements:
        free = tuple(material for material in placement.materials if material not in allowed)
        yield (placement if free == placement.materials else replace(placement, materials=free)), None
        for material in placement.materials:
            if material in allowed:
                yield replace(placement, materials=(material,)), allowed[material]


def _note_reach(found: Belongings, probe: ProbeSpec, placement: PlacementReading, moves: bool) -> None:
    """Note how far an object that may show a probe reaches."""
    for reached, inside in (
        (found.leaving, probe.contains),
        (found.touching, probe.keeps_clear_of),
        (found.beyond, probe.holds),
    ):
        if moves or not inside(placement.corners):
            reached.setdefault(probe.name, set()).update(placement.materials)


def _note_stray(found: Belongings, placement: PlacementReading, reached: Sequence[str]) -> None:
    for material in placement.materials:
        known = found.strays.setdefault(material, {})
        known[placement.object] = known.get(placement.object, set(reached)) & set(reached)


def _has_all_of(probe: ProbeSpec, corners: np.ndarray) -> bool:
    """Whether a probe has all of each point of an object, and leaves nothing to probes that are shown below it."""
    influence = probe.influence
    full = influence.weight >= 1.0 and influence.normal_fade <= 0.0
    return full and not probe.animated and probe.contains(corners)


def _keeps_out(probe: ProbeSpec, own: ProbeSpec, corners: np.ndarray) -> bool:
    """Whether a probe has no share of an object that is all in the influence of its own one."""
    return are_apart(own, probe) and not probe.nears(corners, handover(own.influence_falloff))


def _note_fixed(found: Belongings, placement: PlacementReading) -> None:
    for material in placement.materials if placement.fixed else ():
        found.fixed.setdefault(material, set()).add(placement.object)


def _note_avoided(found: Belongings, placement: PlacementReading, probes: Sequence[str]) -> None:
    for probe in probes:
        found.avoiding.setdefault(probe, set()).update(placement.materials)


def _note_refused(found: Belongings, placement: PlacementReading, probes: Sequence[str]) -> None:
    if probes:
        _note_fixed(found, placement)
    for material in placement.materials if probes else ():
        found.refused.setdefault(material, {}).setdefault(placement.object, set()).update(probes)
        found.needs.setdefault(material, {}).setdefault(placement.object, set())
        if placement.excluded:
            found.excluded.setdefault(material, set()).add(placement.object)
        for probe in probes:
            found.refusing.setdefault(probe, set()).add(placement.object)


def _needed(best: ProbeSpec, reached: Sequence[ProbeSpec], corners: np.ndarray) -> list[str]:
    """The probes that points of an object may show: its own where it is inside and the others' boxes are apart."""
    others = [probe for probe in reached if probe is not best]
    apart = all(are_apart(best, o) and not o.nears(corners, handover(best.influence_falloff)) for o in others)
    return [best.name] if apart and best.contains(corners) else [probe.name for probe in reached]


def are_apart(a: ProbeSpec, b: ProbeSpec) -> bool:
    """Whether the influence boxes of two probes have next to nothing in common, as those of two rooms.

    Tests separation along their face normals only; probes that move are never known to be apart.
    """
    if a.animated or b.animated:
        return False
    common = min(handover(a.influence_falloff), handover(b.influence_falloff))
    return not (a.nears(b.influence_corners, -common) and b.nears(a.influence_corners, -common))


def beside(ordered: Sequence[ProbeSpec]) -> tuple[tuple[int, ...], ...]:
    """For each probe of a material those before it, by their index, whose boxes are apart from its own."""
    return tuple(tuple(j for j in range(k) if are_apart(ordered[j], one)) for k, one in enumerate(ordered))


def layered(
    probes: Sequence[str], specs: Mapping[str, ProbeSpec], borrowing: Collection[str] = frozenset()
) -> list[str]:
    """Probes in the order in which they are shown, each over those before it where boxes overlap.

    The least priority comes first, of the same those that show what was captured for another probe, of the same the
    largest box, of the same the one that was named last.
    """
    rank = {name: k for k, name in enumerate(probes)}
    return sorted(probes, key=lambda n: (specs[n].influence.priority, n not in borrowing, -_volume(specs[n]), -rank[n]))


def _volume(probe: ProbeSpec) -> float:
    """Of the box, in half widths; the same for boxes that differ by rounding."""
    return float(f"{np.prod(probe.box.half_widths):.5g}")


def vessels(placements: Sequence[PlacementReading], clear: Collection[str]) -> set[str]:
    """Those of some materials whose objects have others inside their bounds, by the others' middles."""
    middles = np.array([placement.corners.mean(0) for placement in placements])
    found = set()
    for placement in placements:
        worn = set(placement.materials) & set(clear)
        if not worn:
            continue
        corner, edges = placement.corners[0], placement.corners[[4, 2, 1]] - placement.corners[0]
        squares = np.maximum((edges**2).sum(-1), 1e-30)
        within = (np.abs((middles - corner) @ edges.T / squares - 0.5) < _WELL_INSIDE).all(-1)
        others = {placements[k].object for k in within.nonzero()[0].tolist()} - {placement.object}
        if others:
            found |= worn
    return found


_WELL_INSIDE = 0.49  # of a side, from its middle


def _bounds(probes: Sequence[ProbeSpec]) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) lowest and highest corners of the axis-aligned bounds of the probes' influences."""
    centres = np.array([probe.box.centre for probe in probes])
    margins = np.array([probe.fading_reach.max() for probe in probes])
    # A box grown by a margin on each side reaches as far as its half edges, each longer by its share of the margin.
    grown = [
        probe.box.axes * (1.0 + margin / probe.box.half_widths) for probe, margin in zip(probes, margins, strict=True)
    ]
    reach = np.abs(np.array(grown)).sum(2)
    return centres - reach, centres + reach


def _fills(probe: ProbeSpec, corners: np.ndarray) -> float:
    """How much of a box the bounds of an object fill along each axis, or the box of these; the product, 0 … 1."""
    coordinates = probe.box.coordinates(corners)
    half = probe.box.half_widths + probe.influence_padding
    low, high = coordinates.min(0), coordinates.max(0)
    common = np.minimum(high, half) - np.maximum(low, -half)
    least = np.maximum(np.minimum(high - low, 2.0 * half), 1e-9)
    return float(np.clip((common + 1e-9) / least, 0.0, 1.0).prod())


def _share(probe: ProbeSpec, corners: np.ndarray) -> tuple[float, float]:
    """The share of an object's bounds in the influence, 0 … 1, and how far they are from the centre, in half widths."""
    points = _WITHIN @ corners
    distances = np.abs(probe.box.coordinates(points)) / probe.box.half_widths
    return float(probe.within_influence(points).mean()), float(distances.max(-1).mean())
