"""Which materials show which probe."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.effects.records import SurfaceEffects
from ...core.probe import ProbeSpec
from . import surfaces
from .scene import surfaces as scene_surfaces


@dataclass(frozen=True)
class Receiver:
    """A material that a probe can light.

    Attributes:
        material: the material.
        probe: the name of the probe that most of its objects are nearest to.
        effects: what its surfaces call for.
        all_inside: whether all its objects lie within the probe's box and padding.
        others: names of further probes whose influence its objects reach.
    """

    material: bpy.types.Material
    probe: str
    effects: frozenset[SurfaceEffects]
    all_inside: bool
    others: tuple[str, ...] = ()

    @property
    def roughnesses(self) -> set[float]:
        """The levels that the material reads."""
        return {effect.roughness for effect in self.effects}


@dataclass(frozen=True)
class Survey:
    """The materials of a scene, as far as probes are concerned.

    Attributes:
        receivers: materials that probes light, by name.
        left_alone: for each material that cannot be handled yet, a sentence that names it and says why.
    """

    receivers: tuple[Receiver, ...]
    left_alone: tuple[str, ...]

    def all_inside(self, probe: str) -> bool:
        """Whether no surface that shows this probe leaves its box and padding."""
        return all(receiver.all_inside for receiver in self.receivers if receiver.probe == probe)

    def roughnesses(self, probe: str) -> set[float]:
        """The levels that the materials of one probe read."""
        return {r for receiver in self.receivers if receiver.probe == probe for r in receiver.roughnesses}


def survey(
    view_layer: bpy.types.ViewLayer,
    probes: Sequence[ProbeSpec],
    roughness_limit: float,
    objects: Iterable[bpy.types.Object] | None = None,
) -> Survey:
    """Find the materials that `probes` can light, on all objects that are rendered or only on `objects`."""
    chosen = None if objects is None else set(objects)
    votes: dict[bpy.types.Material, dict[str, float]] = {}
    leaving: dict[bpy.types.Material, set[str]] = {}
    for item, material, corners in scene_surfaces(view_layer):
        if chosen is not None and item not in chosen:
            continue
        leaving.setdefault(material, set()).update(p.name for p in probes if not p.contains(corners))
        reached = [probe for probe in probes if probe.overlaps(corners)]
        for probe in reached:
            tally = votes.setdefault(material, {})
            tally[probe.name] = tally.get(probe.name, 0.0) + _belonging(probe, corners)
    receivers, left_alone = [], []
    for material in sorted(votes, key=lambda m: m.name_full):
        ranked = sorted(votes[material], key=lambda name: (-votes[material][name], name))
        try:
            effects = surfaces.effects(material, roughness_limit)
        except surfaces.Unhandled as why:
            left_alone.append(f"material '{material.name}' {why}; left as it is")
            continue
        if effects:
            receivers.append(
                Receiver(material, ranked[0], frozenset(effects), ranked[0] not in leaving[material], tuple(ranked[1:]))
            )
    return Survey(tuple(receivers), tuple(left_alone))


def _belonging(probe: ProbeSpec, corners: np.ndarray) -> float:
    """How much an object belongs to a probe: the share of its bounds inside the box, plus a little for nearness."""
    steps = np.linspace(0.0, 1.0, 5)
    low, high = corners.min(0), corners.max(0)
    grid = np.stack(np.meshgrid(steps, steps, steps), -1).reshape(-1, 3)
    distances = np.abs(probe.box.coordinates(low + grid * (high - low)))
    inside = (distances <= probe.box.half_widths + probe.influence_padding).all(-1).mean()
    return float(inside + 1e-3 / (1.0 + (distances / probe.box.half_widths).max(-1).mean()))
