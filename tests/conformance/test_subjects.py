"""Views through glass, shares of probes, mixed levels, dominant directions: on their families of hard cases."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate

from . import sharing
from .digits import fifty, float64
from .run import MOST_IN_EEVEE, in_cycles, judged_in_eevee
from .subjects import SUBJECTS, Subject
from .test_conformance import worst

FEW, SOME, MANY = 256, 1024, 4096  # cases of a family and a formula

# One of each kind and of what differs in its operations.
_USUAL = (
    "thin pane, turned box",
    "one interface, oriented box",
    "solid, aligned box",
    "solid, oriented box",
    "two rooms, in each a box",
    "the ladder of probes, hardening",
    "metal over IOR 1.5",
)
EACH = pytest.mark.parametrize("subject", SUBJECTS, ids=str)
USUAL = pytest.mark.parametrize("subject", [s for s in SUBJECTS if s.name in _USUAL], ids=str)


def holds(subject: Subject, count: int, run) -> None:
    cases, where = subject.together(count)
    verdict = subject.judge(cases, run(subject.formula.outputs, cases.inputs()))
    assert verdict.finite.all(), worst(where, ~verdict.finite)
    assert verdict.within.all(), worst(where, ~verdict.within)
    assert verdict.bound_at_most(subject.promised).mean() > 0.7
    assert verdict.error.max() > 0.0


@pytest.mark.without_blender
@EACH
def test_single_precision_stays_within_the_bound(subject: Subject) -> None:
    holds(subject, SOME, evaluate)


@USUAL
def test_cycles_stays_within_the_bound(scene, subject: Subject) -> None:
    holds(subject, FEW, in_cycles)


@pytest.mark.heavy
@EACH
def test_cycles_stays_within_the_bound_on_many_cases(scene, subject: Subject) -> None:
    holds(subject, MANY, in_cycles)


@pytest.mark.heavy
@pytest.mark.parametrize(
    "subject", [s for s in SUBJECTS if s.name in _USUAL and len(s.formula.inputs) <= MOST_IN_EEVEE], ids=str
)
def test_eevee_stays_within_the_same_bound(scene, subject: Subject) -> None:
    cases, where = subject.together(FEW)
    verdict = judged_in_eevee(subject, cases)
    assert verdict.within.all(), worst(where, ~verdict.within)


@pytest.mark.without_blender
@EACH
def test_the_references_agree_with_50_digits(subject: Subject) -> None:
    cases, _ = subject.together(6)
    rough, bounds = subject.truth(cases, float64), subject.bound(cases)
    with fifty() as numbers:
        exact = {name: array.astype(np.float64) for name, array in subject.truth(cases, numbers).items()}
    for name, values in exact.items():
        off = np.abs(rough[name] - values)
        allowed = bounds[name][:, None] if subject.directions else bounds[name]
        sure = allowed < 0.1
        assert (off <= 1e-6 * allowed + 1e-15 * np.maximum(np.abs(values), 1.0))[np.broadcast_to(sure, off.shape)].all()


@pytest.mark.without_blender
@pytest.mark.parametrize("subject", [s for s in SUBJECTS if s.kind == "shares"], ids=str)
def test_the_shares_and_the_own_lobe_add_up_to_one_and_nothing_steps(subject: Subject) -> None:
    cases, where = subject.together(SOME)
    found = sharing.parts_of(evaluate(subject.formula.outputs, cases.inputs())).astype(np.float64)
    assert (found >= 0.0).all()
    assert (np.abs(found.sum(-1) - 1.0) <= sharing.sum_bound(sharing.PROBES)).all()
    np.testing.assert_allclose(sharing.exact(cases, subject.name).sum(-1), 1.0, atol=1e-15)
    stepped = cases[where[sharing.STEPPED]]
    steepest = sharing.steepest(stepped, subject.name)[::2]
    for parts, rounded in ((sharing.exact(stepped, subject.name), 0.0), (found[where[sharing.STEPPED]], 1e-5)):
        metres, change = sharing.steps(stepped, parts)
        assert (change <= steepest * metres + rounded).all() and change.max() > 0.005


@pytest.mark.without_blender
def test_families_are_the_same_every_time_and_differ() -> None:
    for families in {id(s.families): s for s in SUBJECTS}.values():
        once, again = ([families.cases(name, 8).inputs() for name in families.families.names] for _ in range(2))
        for a, b in zip(once, again, strict=True):
            for name in a:
                np.testing.assert_array_equal(a[name], b[name])
        assert len({b"".join(v.tobytes() for v in one.values()) for one in once}) == len(once)
