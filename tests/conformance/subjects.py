"""What is held to exact results beside the mirrored lookup: each formula with its families, its truth and its bound."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from pcc_addon.core.expression import Formula

from . import dominant, glass, levels, sharing
from .columns import Families
from .digits import Numbers, float64
from .families import CORRECTIONS
from .reference import angle
from .verdict import Verdict, side_by_side

Arrays = dict[str, np.ndarray]


@dataclass(frozen=True)
class Subject:
    """A formula and what its results are compared with.

    Attributes:
        kind: what it is about, as tables group it.
        name: which of the kind, in words.
        formula: what is run on the inputs of the cases.
        families: of cases.
        told: what the families are told beside the number of cases.
        truth: the exact results of cases, by output; in float64 or more digits.
        bound: by output, how far off float32 may be, from cases and what `truth` says of them in float64.
        directions: whether results are directions, compared by angles, radians.
        promised: what the bound does not exceed in most cases.
    """

    kind: str
    name: str
    formula: Formula
    families: Families
    told: tuple
    truth: Callable[[Any, Numbers], Arrays]
    bound: Callable[[Any], Arrays]
    directions: bool
    promised: float

    def __str__(self) -> str:
        return f"{self.kind}, {self.name}"

    def cases(self, name: str, count: int) -> Any:
        return self.families.cases(name, count, *self.told)

    def together(self, count: int) -> tuple[Any, dict[str, slice]]:
        return self.families.together(count, *self.told)

    def judge(self, cases: Any, found: Mapping[str, np.ndarray]) -> Verdict:
        """Compare what was found, by output, with the truth."""
        difference = angle if self.directions else lambda a, b: np.abs(a.astype(np.float64) - b)
        errors = [difference(found[name], exact) for name, exact in self.truth(cases, float64).items()]
        bounds = list(self.bound(cases).values())
        finite = [np.isfinite(found[name]).reshape(len(cases), -1).all(-1) for name in found]
        return Verdict(side_by_side(errors), side_by_side(bounds), np.all(finite, axis=0))


def _by_part(parts: np.ndarray) -> Arrays:
    *probes, own = np.moveaxis(parts, -1, 0)
    return {f"Part {k}": part for k, part in enumerate(probes)} | {"Own": own}


def _through_glass() -> list[Subject]:
    def truth(cases: glass.Glass, numbers: Numbers) -> Arrays:
        return {"Direction": glass.exact(cases, numbers).lookup.direction}

    def bound(cases: glass.Glass) -> Arrays:
        return {"Direction": glass.bound(cases, glass.exact(cases))}

    return [
        Subject(
            "seen through",
            f"{interface.words}, {correction.words}",
            glass.refracted_lookup(interface, correction),
            glass.FAMILIES,
            (correction, interface),
            truth,
            bound,
            directions=True,
            promised=1e-3 if interface is glass.Interface.SOLID else 1e-5,
        )
        for interface in glass.INTERFACES
        for correction in CORRECTIONS
    ]


def _shared(layout: str) -> Subject:
    return Subject(
        "shares",
        layout,
        sharing.sharing(layout),
        sharing.FAMILIES,
        (),
        lambda cases, numbers: _by_part(sharing.exact(cases, layout, numbers)),
        lambda cases: _by_part(sharing.bound(cases, layout, sharing.exact(cases, layout))),
        directions=False,
        promised=1e-5,
    )


def _mixed(ladder: str, hardening: bool) -> Subject:
    exact = partial(levels.exact, ladder=ladder, hardening=hardening)
    return Subject(
        "levels",
        ladder + ", hardening" * hardening,
        levels.mixing(ladder, hardening),
        levels.FAMILIES,
        (ladder,),
        lambda cases, numbers: {"Radiance": exact(cases, numbers=numbers)},
        lambda cases: {"Radiance": levels.bound(cases, ladder, hardening, exact(cases))},
        directions=False,
        promised=1e-5,
    )


def _leant(facets: str) -> Subject:
    return Subject(
        "dominant direction",
        facets,
        dominant.dominant(facets),
        dominant.FAMILIES,
        (),
        lambda cases, numbers: {"Direction": dominant.exact(cases, facets, numbers)},
        lambda cases: {"Direction": dominant.bound(cases, facets, dominant.exact(cases, facets))},
        directions=True,
        promised=1e-4,
    )


SUBJECTS = (
    *_through_glass(),
    *(_shared(layout) for layout in sharing.LAYOUTS),
    *(_mixed(ladder, hardening) for ladder in levels.LADDERS for hardening in (False, True)),
    *(_leant(facets) for facets in dominant.FACETS),
)
