"""Every family of hard cases, through the node groups themselves, against exact geometry and the derived bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects
from tests.shader_harness import evaluate_expressions

from . import variants
from .bound import direction_bound, spread_bound, stretched_bound
from .digits import fifty
from .families import CORRECTIONS, FAMILIES
from .reference import LEAST_SPREAD, MOST_SPREAD, angle, exact
from .run import EXPECTED_ROUNDING, directions, errors_in_eevee, in_cycles, together
from .verdict import WELL_CONDITIONED, judge

FEW, MANY = 2048, 20_000  # cases of a family and a correction: over 100,000 and over a million in all

BY_CORRECTION = pytest.mark.parametrize("correction", CORRECTIONS, ids=lambda c: c.value)
SIZES = pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.heavy)])


def worst(where: dict[str, slice], failed: np.ndarray) -> str:
    """How many cases of which family failed."""
    counts = {name: int(failed[part].sum()) for name, part in where.items()}
    return ", ".join(f"{name}: {count}" for name, count in counts.items() if count)


@BY_CORRECTION
@SIZES
def test_cycles_stays_finite_and_within_the_bound_on_every_family(scene, correction: Correction, count: int) -> None:
    cases, where = together(count, correction)
    verdict = judge(cases, directions(cases, variants.full(correction)))
    assert verdict.finite.all(), worst(where, ~verdict.finite)
    assert verdict.within.all(), worst(where, ~verdict.within)
    assert verdict.bound_at_most().mean() > 0.7, "most cases are such that the bound promises 1e-5 radians"


@pytest.mark.heavy
@BY_CORRECTION
def test_eevee_stays_within_the_same_bound_on_every_family(scene, correction: Correction) -> None:
    cases, where = together(FEW, correction)
    truth = exact(cases)
    error = errors_in_eevee(cases, variants.full(correction), truth.direction)
    failed = ~(error <= direction_bound(cases, truth) + EXPECTED_ROUNDING)
    assert not failed.any(), worst(where, failed)


@BY_CORRECTION
def test_a_capture_from_the_centre_is_as_exact(scene, correction: Correction) -> None:
    cases, where = together(FEW, correction)
    cases = replace(cases, capture_point=cases.centre)
    lookup = formula.lookup(LookupEffects(correction, None, offset=False))
    verdict = judge(cases, directions(cases, lookup["Direction"]))
    assert verdict.within.all(), worst(where, ~verdict.within)


@BY_CORRECTION
def test_a_picture_that_is_stretched_is_looked_up_within_its_bound(scene, correction: Correction) -> None:
    cases, where = together(FEW, correction)
    lookup = formula.lookup(LookupEffects(correction, None, offset=False, stretched=True))
    found, truth = directions(cases, lookup["Direction"]), exact(cases)
    bound = stretched_bound(cases, truth)
    assert np.isfinite(found).all(), worst(where, ~np.isfinite(found).all(-1))
    failed = ~(angle(found, truth.stretched) <= bound)
    assert not failed.any(), worst(where, failed)
    assert (bound <= 10.0 * WELL_CONDITIONED).mean() > 0.7, "long boxes shorten directions, not what they are off by"


@BY_CORRECTION
def test_the_spread_of_hardened_contacts_stays_within_its_bound(scene, correction: Correction) -> None:
    cases, where = together(FEW, correction)
    outputs = {"Spread": formula.lookup(LookupEffects(correction, None, hardening=True))["Spread"]}
    found, truth = in_cycles(outputs, variants.inputs(cases))["Spread"], exact(cases)
    bound = spread_bound(cases, truth)
    failed = ~(np.abs(found - truth.spread) <= bound)
    assert not failed.any(), worst(where, failed)
    assert (bound <= WELL_CONDITIONED).mean() > 0.7
    assert min((truth.spread == LEAST_SPREAD).mean(), (truth.spread == MOST_SPREAD).mean()) > 0.01


@pytest.mark.heavy
@BY_CORRECTION
def test_eevee_stretches_within_the_same_bound(scene, correction: Correction) -> None:
    cases, where = together(FEW, correction)
    truth = exact(cases)
    lookup = formula.lookup(LookupEffects(correction, None, offset=False, stretched=True))
    error = errors_in_eevee(cases, lookup["Direction"], truth.stretched)
    failed = ~(error <= stretched_bound(cases, truth) + EXPECTED_ROUNDING)
    assert not failed.any(), worst(where, failed)


@BY_CORRECTION
def test_nan_and_infinite_inputs_harm_no_case_but_their_own(scene, correction: Correction) -> None:
    healthy, _ = together(64, correction)
    broken, _ = together(64, correction, finite=False)
    between = np.arange(len(healthy)) % 2 == 0
    mixed = {
        name: np.where(between.reshape(-1, *[1] * (array.ndim - 1)), array, np.resize(other, array.shape))
        for (name, array), other in zip(healthy.inputs().items(), broken.inputs().values(), strict=True)
    }
    outputs = {"Direction": variants.full(correction)}
    found = evaluate_expressions(outputs, mixed)["Direction"]
    alone = directions(healthy, variants.full(correction))
    np.testing.assert_array_equal(found[between], alone[between])
    lost = ~np.isfinite(directions(broken, variants.full(correction))).all(-1)
    lost = np.resize(lost, len(healthy)) & ~between
    assert lost.any() and (found[lost] == 0.0).any(-1).all(), "Cycles shows black where a shader gives NaN"


@pytest.mark.sweep
@pytest.mark.parametrize("variant", [variants.ARTICLES, *variants.WITHOUT], ids=lambda v: v.name)
def test_the_families_find_what_every_guard_is_for(scene, variant: variants.Variant) -> None:
    for correction in variant.corrections:
        cases, _ = together(FEW, correction)
        verdict = judge(cases, directions(cases, variant.direction(correction)))
        assert verdict.visibly_wrong.sum() > FEW // 4, correction


@pytest.mark.without_blender
@pytest.mark.parametrize("family", [f for f in FAMILIES if f.finite], ids=lambda f: f.name)
def test_the_reference_agrees_with_50_digits(family) -> None:
    for correction in family.corrections:
        if correction is Correction.TURNED_BOX:  # its face normals are not given but follow from the mirror
            continue
        cases = family.cases(12, correction)
        truth = exact(cases)
        with fifty() as numbers:
            exacter = exact(cases, numbers)
        for name, bound in (("direction", direction_bound), ("stretched", stretched_bound)):
            sure = bound(cases, truth) < 0.1
            error = angle(getattr(truth, name), getattr(exacter, name))
            assert (error[sure] <= 1e-6 * bound(cases, truth)[sure] + 1e-15).all()


@pytest.mark.without_blender
def test_cases_are_the_same_every_time_and_differ_between_families() -> None:
    for family in FAMILIES:
        once, again = (family.cases(8, family.corrections[0]) for _ in range(2))
        np.testing.assert_array_equal(once.position, again.position)
    positions = [f.cases(8, f.corrections[0]).position.tobytes() for f in FAMILIES]
    assert len(set(positions)) == len(FAMILIES)
