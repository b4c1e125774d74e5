"""The tables of docs/numerics.md: every family of hard cases, what each guard catches and what it costs.

python3 dev.py run benchmarks/numerics.py
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import bpy
import numpy as np

from benchmarks.lookup_time import node_count, relative_times
from benchmarks.measure import ROOT, start, table, write_between
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.expression import Expr, Operation
from pcc_addon.core.probe import Box, ProbeSpec
from tests.conformance import variants
from tests.conformance.bound import direction_bound
from tests.conformance.cases import Cases
from tests.conformance.families import CORRECTIONS, FAMILIES, Family, at, on_boundary, room
from tests.conformance.reference import exact
from tests.conformance.run import EXPECTED_ROUNDING, directions, errors_in_eevee, together
from tests.conformance.verdict import WELL_CONDITIONED, judge
from tests.poles import halves
from tests.shader_harness import evaluate_group

CASES, EEVEE_CASES, FEW = 16_384, 1024, 4096  # of a family and a correction
PAGE = ROOT / "docs" / "numerics.md"


def main() -> None:
    start()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    head = ["family", "cases", "largest error", "its bound", "bound ≤ 1e-5", "error ÷ bound", "in EEVEE", "NaN, inf"]
    head += [variants.ARTICLES.name, *(f"without: {v.name}" for v in variants.WITHOUT)]
    eevee = _shares_of_bound_in_eevee()
    families = table(head, [_family_row(family, eevee.get(family.name, 0.0)) for family in FAMILIES])
    guards = table(["guard", "wrong without it", "nodes", "frame with ÷ without"], _guard_rows())
    text = f"Blender {bpy.app.version_string}.\n\n{families}\n\n### What the guards cost\n\n{guards}"
    write_between(PAGE, "tables: written by benchmarks/numerics.py", text)


def _family_row(family: Family, in_eevee: float) -> list[str]:
    """A row of the first table; errors in radians, failures as counts of visibly wrong cases."""
    if not family.finite:
        lost = [
            ~np.isfinite(directions(cases, variants.full(cases.correction))).all(-1) for cases in _all_cases(family)
        ]
        return [
            family.name,
            f"{np.size(lost):,}",
            *["–"] * 5,
            f"{np.sum(lost):,}",
            *["–"] * (1 + len(variants.WITHOUT)),
        ]
    verdicts = [judge(cases, directions(cases, variants.full(cases.correction))) for cases in _all_cases(family)]
    error, bound, finite = (np.concatenate([getattr(v, n) for v in verdicts]) for n in ("error", "bound", "finite"))
    worst = error.argmax()
    row = [
        family.name,
        f"{len(error):,}",
        f"{error[worst]:.1e}",
        f"{bound[worst]:.1e}",
        f"{(bound <= WELL_CONDITIONED).mean():.0%}",
    ]
    row += [f"{(error / bound).max():.2f}", f"{in_eevee:.2f}", str((~finite).sum())]
    return row + [f"{_wrong(family, variant):,}" for variant in (variants.ARTICLES, *variants.WITHOUT)]


def _all_cases(family: Family) -> list[Cases]:
    return [family.cases(CASES, correction) for correction in family.corrections]


@cache
def _wrong(family: Family, variant: variants.Variant) -> int:
    """How many of a family's cases a variant gets visibly wrong, of those in which it differs from the formula."""
    concerned = [cases for cases in _all_cases(family) if cases.correction in variant.corrections]
    verdicts = (judge(cases, directions(cases, variant.direction(cases.correction))) for cases in concerned)
    return sum(int(verdict.visibly_wrong.sum()) for verdict in verdicts)


def _shares_of_bound_in_eevee() -> dict[str, float]:
    """By family, the largest error in EEVEE as a share of the bound."""
    shares: dict[str, float] = {}
    for correction in CORRECTIONS:
        cases, where = together(EEVEE_CASES, correction)
        truth = exact(cases)
        error = errors_in_eevee(cases, variants.full(correction), truth.direction)
        share = error / (direction_bound(cases, truth) + EXPECTED_ROUNDING)
        for name, part in where.items():
            shares[name] = max(shares.get(name, 0.0), float(share[part].max()))
    return shares


def _guard_rows() -> list[list[str]]:
    rows = []
    for variant in variants.WITHOUT:
        correction = variant.corrections[-1] if len(variant.corrections) == 1 else Correction.TURNED_BOX
        shipped, without = ({"Direction": make(correction)} for make in (variants.full, variant.direction))
        finite = [family for family in FAMILIES if family.finite]
        wrong = sum(_wrong(family, variant) for family in finite)
        looked_up = CASES * sum(c in variant.corrections for family in finite for c in family.corrections)
        rows.append([variant.name, f"{wrong:,} of {looked_up:,} lookups", *_price(shipped, without)])
    direction = variants.full(Correction.TURNED_BOX)
    guarded = {"Direction": _substituted(formula.OFF_POLES.outputs["Direction"], direction)}
    rows.append(["half a texel off the poles", _poles(), *_price(guarded, {"Direction": direction})])
    rows.append(["padding widened by what float32 resolves", _widening(), "0", "1"])
    rows.append(["falloff of a nanometre for none", _no_falloff(), "0", "1"])
    return rows


def _price(shipped: dict[str, Expr], without: dict[str, Expr]) -> list[str]:
    """How many nodes more, and how much longer a frame of lookups takes."""
    constants = {
        name: values[0] for name, values in variants.inputs(FAMILIES[0].cases(1, Correction.TURNED_BOX)).items()
    }
    constants["Steepest"] = formula.steepest_slope(256)
    times = relative_times({"without": without, "with": shipped}, constants)
    return [f"{node_count(shipped) - node_count(without):+d}", f"{times['with']:.2f}"]


def _substituted(expr: Expr, direction: Expr) -> Expr:
    """An expression of the input "Direction" with another expression in its place."""
    if expr is formula.DIRECTION:
        return direction
    if isinstance(expr, Operation):
        return replace(expr, args=tuple(_substituted(part, direction) for part in expr.args))
    return expr


def _poles() -> str:
    """Lookups within a texel of the poles of a picture that is white above and black below."""
    rng = np.random.default_rng(51)
    height = 64
    tilt, azimuth = np.pi / height * rng.random(FEW), 2.0 * np.pi * rng.random(FEW)
    side = rng.choice([-1.0, 1.0], FEW)
    given = np.stack([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), side * np.cos(tilt)], -1)
    found = evaluate_group(halves(height, guarded=False), {"Direction": given})["Color"][:, 0]
    return f"{int((np.abs(found - (side > 0)) > 0.01).sum()):,} of {FEW:,} lookups within a texel of a pole"


def _widening() -> str:
    """Surfaces on the walls of far rooms whose probe has neither padding nor falloff."""
    rng = np.random.default_rng(52)
    rooms = (room(rng, 1, Correction.ALIGNED_BOX, centre=10.0 ** rng.uniform(1.0, 6.0)) for _ in range(FEW))
    outside = 0
    for cases in rooms:
        matrix = np.diag([*cases.half_widths[0], 1.0])
        matrix[:3, 3] = cases.centre[0]
        spec = ProbeSpec("Hall", Box.from_matrix("Hall", matrix), padding=0.0, falloff=0.0)
        walls = replace(cases, position=at(cases, on_boundary(rng, 1)))
        fade = {"Padding": 0.0, "Falloff": spec.influence_falloff}
        effects = LookupEffects(spec.box.correction, Outside.BLACK)
        outside += int(evaluate(formula.lookup(effects), walls.inputs() | fade)["Weight"][0] < 1.0)
    return f"{outside:,} of {FEW:,} points on walls count as outside"


def _no_falloff() -> str:
    """Surfaces beyond walls, with no padding and a falloff of 0, where shaders hold x / 0 to be 0."""
    family = next(f for f in FAMILIES if f.name == "just outside")
    cases = family.cases(FEW, Correction.ALIGNED_BOX)
    effects = LookupEffects(Correction.ALIGNED_BOX, Outside.BLACK)
    found = evaluate(formula.lookup(effects), cases.inputs() | {"Padding": 0.0, "Falloff": 0.0})["Weight"]
    return f"{int((found > 0.0).sum()):,} of {FEW:,} points outside count as inside"


if __name__ == "__main__":
    main()
