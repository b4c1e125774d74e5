"""Our formulas on the published vectors: what is run, on which inputs, and what must come out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.expression import Expr, Formula
from tests.conformance import glass, levels, sharing
from tests.conformance import interior as panes
from tests.conformance.dominant import dominant
from tests.conformance.reference import angle

from . import dominant as lobes
from . import interior, lookup, refracted, shares
from . import levels as mixed
from .vector_file import Record, columns

Arrays = dict[str, np.ndarray]


@dataclass(frozen=True)
class Expected:
    """Exact values of an output and their tolerances: radians where it is a direction."""

    values: np.ndarray
    tolerance: np.ndarray
    direction: bool = False

    def met(self, found: np.ndarray) -> np.ndarray:
        """(n,) whether what was found is as near as it must be."""
        found = found.astype(np.float64)
        error = angle(found, self.values) if self.direction else np.abs(found - self.values)
        return (error <= self.tolerance).reshape(len(found), -1).all(-1)


@dataclass(frozen=True)
class Check:
    """Some vectors of a file, those that one formula is for."""

    formula: Formula
    inputs: Arrays
    expected: dict[str, Expected]

    def __str__(self) -> str:
        return self.formula.title

    def met(self, found: Mapping[str, np.ndarray]) -> np.ndarray:
        """(n,) whether all outputs are as near as they must be."""
        return np.all([expected.met(found[name]) for name, expected in self.expected.items()], axis=0)


def checks() -> Iterator[Check]:
    """All of them."""
    yield from _mirrored()
    yield from _seen_through()
    yield from _shared()
    yield from _mixed()
    yield from _leant()
    yield _interior()


def _mirrored() -> Iterator[Check]:
    for correction, cases in _grouped(lookup.FILE.read(), "box", {c.words.removesuffix(" box"): c for c in _BOXES}):
        outputs: dict[str, Expr] = dict(formula.lookup(LookupEffects(correction, Outside.OWN, hardening=True)))
        turned = formula.lookup(LookupEffects(correction, None, False, stretched=True))
        outputs["Stretched"] = turned["Direction"]
        fields = {"Direction": "direction", "Stretched": "stretched_direction", "Spread": "spread", "Weight": "weight"}
        names = ("tolerance", "stretched_tolerance", "spread_tolerance", "weight_tolerance")
        expected = {
            output: Expected(cases[field], cases[name], direction="direction" in field)
            for (output, field), name in zip(fields.items(), names, strict=True)
        }
        inputs = _box(cases) | {"Padding": cases["padding"], "Falloff": cases["falloff"]}
        yield Check(Formula(f"Lookup vectors, {correction.words}", outputs), inputs, expected)


_BOXES = (Correction.ALIGNED_BOX, Correction.ORIENTED_BOX)


def _box(cases: Arrays) -> Arrays:
    return {
        "Position": cases["position"],
        "Incoming": cases["incoming"],
        "Normal": cases["normal"],
        "Box Centre": cases["centre"],
        **{f"Face Normal {axis}": cases["face_normals"][:, k] for k, axis in enumerate("XYZ")},
        "Half Widths": cases["half_widths"],
        "Capture Point": cases["capture_point"],
    }


def _seen_through() -> Iterator[Check]:
    for interface, cases in _grouped(refracted.FILE.read(), "interface", {i.words: i for i in glass.INTERFACES}):
        inputs = _box(cases) | {
            "IOR": cases["ior"],
            "Backfacing": cases["backfacing"],
            "Dimensions": cases["dimensions"],
        }
        inputs |= {f"Axis {axis}": cases["axes"][:, k] for k, axis in enumerate("XYZ")}
        expected = {"Direction": Expected(cases["direction"], cases["tolerance"], direction=True)}
        yield Check(glass.refracted_lookup(interface, Correction.ORIENTED_BOX), inputs, expected)


def _shared() -> Iterator[Check]:
    for layout, cases in _grouped(shares.FILE.read(), "layout", {name: name for name in sharing.LAYOUTS}):
        points = sharing.Shared(*(cases[name] for name in ("depth", "weight", "fade", "diffuse")))
        made = sharing.sharing(layout)
        parts = zip(made.outputs, cases["parts"].T, cases["tolerances"].T, strict=True)
        yield Check(made, points.inputs(), {name: Expected(values, off) for name, values, off in parts})


def _mixed() -> Iterator[Check]:
    for ladder in levels.LADDERS:
        for hardening in (False, True):
            chosen = [c for c in mixed.FILE.read() if c["ladder"] == ladder and c["hardening"] is hardening]
            cases = columns(chosen)
            surfaces = levels.Mixed(cases["roughness"], cases["spread"], cases["levels"])
            expected = {"Radiance": Expected(cases["radiance"], cases["tolerances"])}
            yield Check(levels.mixing(ladder, hardening), surfaces.inputs(), expected)


def _leant() -> Iterator[Check]:
    for facets, cases in _grouped(lobes.FILE.read(), "facets", {name: name for name in lobes.FACETS}):
        inputs = {"Incoming": cases["incoming"], "Normal": cases["normal"], "Roughness": cases["roughness"]}
        expected = {"Direction": Expected(cases["direction"], cases["tolerance"], direction=True)}
        yield Check(dominant(facets), inputs, expected)


def _interior() -> Check:
    cases = columns(interior.FILE.read())
    place = np.concatenate([cases["place"], np.zeros((len(cases["place"]), 1))], 1)
    given = panes.Panes(
        place, *(cases[name] for name in ("ray", "size", "half_edges", "capture", "quarters", "mirror"))
    )
    expected = {"Direction": Expected(cases["direction"], cases["tolerance"], direction=True)}
    return Check(Formula("Interior vectors", {"Direction": panes.expression()}), given.inputs(), expected)


def _grouped(records: Sequence[Record], field: str, known: Mapping[str, object]) -> Iterator[tuple]:
    """What each value of a field stands for, and the records that have it, as arrays."""
    for name, meant in known.items():
        yield meant, columns([record for record in records if record[field] == name])
