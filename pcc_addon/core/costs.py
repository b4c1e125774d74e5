"""What effects cost, from the table that `benchmarks/effects.py` writes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from .decisions import Effect

_NOISE = 0.02  # of alternating frames
TABLE = Path(__file__).with_name("effect_costs.json")


@dataclass(frozen=True)
class Cost:
    """Of one effect, as ratios of what takes it to what does not; None: not measured, or nothing to measure.

    Attributes:
        nodes: how many more nodes a material has.
        cycles, eevee: seconds of a frame that is nothing but the reflection.
        bake: seconds of a bake.
        megabytes: of the pictures.
    """

    nodes: int | None = None
    cycles: float | None = None
    eevee: float | None = None
    bake: float | None = None
    megabytes: float | None = None

    @property
    def words(self) -> str:
        """Such as "Cycles ×1.05"; what is within the noise is not told, and nothing where nothing is known."""
        ratios = {"Cycles": self.cycles, "EEVEE": self.eevee, "bake": self.bake, "MB": self.megabytes}
        known = {name: ratio for name, ratio in ratios.items() if ratio is not None}
        told = [f"{name} ×{ratio:.2f}" for name, ratio in known.items() if ratio >= 1.0 + _NOISE]
        return ", ".join(told) or "less than can be measured" * bool(known)


@dataclass(frozen=True)
class CostTable:
    """What was measured.

    Attributes:
        costs: by the effects' keys.
        where: machine, Blender and day, in words.
    """

    costs: dict[str, Cost]
    where: str

    def of(self, effect: Effect) -> Cost:
        """That of an effect; empty where it was not measured."""
        return self.costs.get(effect.key, Cost())


@cache
def cost_table() -> CostTable:
    """The table that comes with the add-on; empty where there is none."""
    if not TABLE.is_file():
        return CostTable({}, "")
    document = json.loads(TABLE.read_text(encoding="utf-8"))
    return CostTable({key: Cost(**cost) for key, cost in document["effects"].items()}, document["where"])
