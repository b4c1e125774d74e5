"""How a material is divided among its objects, where they are to show different probes of it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

TOGETHER = 2
"""As many probes one material shows by place, if all objects may show them; with more, each costs every point something
(docs/shared_material.md), so objects get copies of the material that show their own."""


@dataclass(frozen=True)
class MaterialPart:
    """Objects that show a copy of a material.

    Attributes:
        probes: those that the copy shows, the one with most objects first; empty: none.
        objects: their names.
    """

    probes: tuple[str, ...]
    objects: tuple[str, ...]


@dataclass(frozen=True)
class Division:
    """Which probes a material shows.

    Attributes:
        kept: those that it shows itself.
        parts: its copies; empty: it is not divided.
        dropped: those that objects would show if EEVEE could read more pictures in one material.
    """

    kept: tuple[str, ...]
    parts: tuple[MaterialPart, ...] = ()
    dropped: tuple[str, ...] = ()

    @property
    def probes(self) -> tuple[str, ...]:
        """All that it shows, itself or as a copy."""
        return tuple(dict.fromkeys([*self.kept, *(probe for part in self.parts for probe in part.probes)]))

    def blends(self, probe: str) -> bool:
        """Whether points choose between this probe and others."""
        return any(probe in probes and len(probes) > 1 for probes in (self.kept, *(p.probes for p in self.parts)))


def divide(
    ranked: Sequence[str],
    needs: Mapping[str, Collection[str]],
    refused: Mapping[str, Collection[str]],
    fixed: Collection[str],
    fitting: int,
    together: int = TOGETHER,
) -> Division:
    """Divide a material among its objects, if need be.

    Args:
        ranked: the probes that its objects belong to, the one with most of them first.
        needs: by object: the probes that its points may show.
        refused: by object: the probes whose influence it reaches and that it is not to show.
        fixed: objects that cannot wear a copy.
        fitting: how many probes one material can show.
        together: how many it shows by place without being divided, if all objects may show them.
    """
    unwanted = any(probe in ranked for probes in refused.values() for probe in probes)
    sets = {item: _ranked(probes, ranked) for item, probes in needs.items()}
    if not (unwanted or len(ranked) > together) or len({*sets.values()}) < 2:
        return Division(tuple(ranked[:fitting]), (), tuple(ranked[fitting:]))
    kept = _ranked({probe for item in fixed for probe in sets.get(item, ())}, ranked)
    objects: dict[tuple[str, ...], list[str]] = {}
    for item in sorted(sets.keys() - set(fixed)):
        objects.setdefault(sets[item], []).append(item)
    clean = not kept  # objects that show nothing then wear the material itself
    parts = [
        MaterialPart(probes[:fitting], tuple(objects[probes])) for probes in sorted(objects) if probes or not clean
    ]
    wanted = dict.fromkeys([*kept[fitting:], *(probe for probes in objects for probe in probes[fitting:])])
    shown = {*kept[:fitting], *(probe for part in parts for probe in part.probes)}
    return Division(kept[:fitting], tuple(parts), tuple(probe for probe in wanted if probe not in shown))


def _ranked(probes: Collection[str], ranked: Sequence[str]) -> tuple[str, ...]:
    rank = {name: k for k, name in enumerate(ranked)}
    return tuple(sorted(probes, key=lambda name: (rank.get(name, len(rank)), name)))
