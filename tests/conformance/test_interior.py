"""Interior mapping through its nodes, on every family of hard cases: finite, and within the derived bound."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import interior as formula
from pcc_addon.core.expression import absolute, dot, normalize, vector
from pcc_addon.core.probe import Engine
from tests.shader_harness import evaluate_expressions

from .interior import FAMILIES, Panes, cases, direction_bound, exact, expression, together
from .reference import angle
from .run import EXPECTED_ROUNDING
from .test_conformance import worst

FEW, MANY = 2048, 40_000
_MAGNIFIED = 4096.0


@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.heavy)])
def test_cycles_stays_finite_and_within_the_bound(scene, count: int) -> None:
    panes, where = together(count)
    outputs = {"Direction": expression(), "Is Finite": dot(expression(), vector("Zero")) + 1.0}
    found = evaluate_expressions(outputs, panes.inputs() | {"Zero": np.zeros(3, np.float32)})
    finite, truth = found["Is Finite"] == 1.0, exact(panes)
    bound = direction_bound(panes, truth)
    failed = ~(angle(found["Direction"], truth.direction) <= bound)
    assert finite.all(), worst(where, ~finite)
    assert not failed.any(), worst(where, failed)
    assert (bound <= 1e-5).mean() > 0.7, "most cases are such that the bound promises 1e-5 radians"


@pytest.mark.heavy
def test_eevee_stays_within_the_same_bound(scene) -> None:
    panes, where = together(FEW)
    truth = exact(panes)
    outputs = {"Offset": absolute(normalize(expression()) - vector("Expected")) * _MAGNIFIED}
    found = evaluate_expressions(outputs, panes.inputs() | {"Expected": truth.direction}, Engine.EEVEE)["Offset"]
    error = np.linalg.norm(found, axis=-1) / _MAGNIFIED
    failed = ~(error <= direction_bound(panes, truth) + EXPECTED_ROUNDING)
    assert not failed.any(), worst(where, failed)


def test_the_families_find_what_the_guard_is_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it, x / 0 is 0 and a wall that one touches is not there."""
    monkeypatch.setattr(formula, "ON_FACE", -1.0)
    panes = cases("grazing views at the sides of cells", FEW)
    truth = exact(panes)
    found = evaluate({"Direction": expression()}, panes.inputs())["Direction"]
    monkeypatch.undo()
    assert (angle(found, truth.direction) > direction_bound(panes, truth)).sum() > FEW // 20


share = st.one_of(st.sampled_from([0.0, -0.0, 1.0, 0.5, -1e-20, 1e-40]), st.floats(-3.0, 3.0, width=32))
component = st.one_of(st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-20]), st.floats(-1.0, 1.0, width=32))
length = st.one_of(st.just(1.0), st.floats(2.0**-10, 2.0**10, width=32))


@given(
    st.tuples(share, share),
    st.tuples(component, component, component).filter(any),
    st.tuples(length, length, length),
    st.integers(0, 3),
    st.sampled_from([-1.0, 1.0]),
)
def test_single_precision_stays_within_the_bound_whatever_comes(place, ray, size, quarters, mirror) -> None:
    def one(values: object) -> np.ndarray:
        return np.asarray(values, np.float32)[None]

    ray = np.array(ray) / np.linalg.norm(ray) * (1.0, 1.0, 1.0)
    panes = Panes(
        place=one((*place, 0.0)),
        ray=one((ray[0], abs(ray[1]), ray[2])),
        size=one(size),
        half_edges=one(np.diag([2.0, 3.0, 1.5])),
        capture=one((0.3, -0.2, 0.1)),
        quarters=one(quarters),
        mirror=one(mirror),
    )
    found = evaluate({"Direction": expression()}, panes.inputs(), np.float32)["Direction"]
    truth = exact(panes)
    assert np.isfinite(found).all() and found.any()
    assert (angle(found, truth.direction) <= direction_bound(panes, truth)).all()


def test_families_differ_and_are_the_same_every_time() -> None:
    for name in FAMILIES.names:
        np.testing.assert_array_equal(cases(name, 8).ray, cases(name, 8).ray)
    assert len({cases(name, 8).inputs()["Ray"].tobytes() for name in FAMILIES.names}) > len(FAMILIES.names) // 2
