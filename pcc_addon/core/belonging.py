"""Which probes the objects of a scene belong to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from .probe import ProbeSpec
from .readings import PlacementReading

_STEPS = np.linspace(0.0, 1.0, 5)  # points along each edge of an object's bounds
_EDGES = np.stack([1.0 - _STEPS, _STEPS], -1)
_WITHIN = np.einsum("ia,jb,kc->ijkabc", _EDGES, _EDGES, _EDGES).reshape(-1, 8)  # points within, from the 8 corners
_SHARE = 0.05  # of an object's bounds, from which on it counts for a probe beside the one that it is mostly in


@dataclass(frozen=True)
class Belongings:
    """What belongs to whom.

    Attributes:
        owners: by material, by probe, by object: how much of it the probe has, about 0 … 1.
        leaving: by probe: the materials of objects that belong to it and reach beyond its box and padding.
        touching: by probe: the materials of objects that belong to it and reach to its box or beyond.
    """

    owners: dict[str, dict[str, dict[str, float]]] = field(default_factory=dict)
    leaving: dict[str, set[str]] = field(default_factory=dict)
    touching: dict[str, set[str]] = field(default_factory=dict)


def belongings(probes: Sequence[ProbeSpec], placements: Sequence[PlacementReading]) -> Belongings:
    """Find the probes that each placement is in the influence of, and among them those that it belongs to.

    A placement belongs to the probe with the largest share of its bounds, the nearest of those with equal shares, and
    to every other one with a share worth mentioning.
    """
    found = Belongings()
    if not probes or not placements:
        return found
    lows, highs = _bounds(probes)
    for placement in placements:
        low, high = placement.corners.min(0), placement.corners.max(0)
        near = ((lows <= high) & (highs >= low)).all(1).nonzero()[0].tolist()
        reached = [probes[k] for k in near if probes[k].overlaps(placement.corners)]
        shares = {probe.name: _share(probe, placement.corners) for probe in reached}
        if not shares:
            continue
        best = min(shares, key=lambda name: (-round(shares[name][0], 6), round(shares[name][1], 6), name))
        for probe in reached:
            share, distance = shares[probe.name]
            if probe.name != best and share < _SHARE:
                continue
            for material in placement.materials:
                tally = found.owners.setdefault(material, {}).setdefault(probe.name, {})
                tally[placement.object] = tally.get(placement.object, 0.0) + share + 1e-3 / (1.0 + distance)
            if not probe.contains(placement.corners):
                found.leaving.setdefault(probe.name, set()).update(placement.materials)
            if not probe.keeps_clear_of(placement.corners):
                found.touching.setdefault(probe.name, set()).update(placement.materials)
    return found


def _bounds(probes: Sequence[ProbeSpec]) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) lowest and highest corners of the axis-aligned bounds of the probes' influences."""
    centres = np.array([probe.box.centre for probe in probes])
    margins = np.array([probe.influence_padding + probe.falloff for probe in probes])
    # A box grown by a margin on each side reaches as far as its half edges, each longer by its share of the margin.
    grown = [
        probe.box.axes * (1.0 + margin / probe.box.half_widths) for probe, margin in zip(probes, margins, strict=True)
    ]
    reach = np.abs(np.array(grown)).sum(2)
    return centres - reach, centres + reach


def _share(probe: ProbeSpec, corners: np.ndarray) -> tuple[float, float]:
    """The share of an object's bounds inside the box, 0 … 1, and how far it is from the centre, in half widths."""
    distances = np.abs(probe.box.coordinates(_WITHIN @ corners))
    inside = (distances <= probe.box.half_widths + probe.influence_padding).all(-1).mean()
    return float(inside), float((distances / probe.box.half_widths).max(-1).mean())
