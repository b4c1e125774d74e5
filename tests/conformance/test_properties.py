"""What must hold for any inputs at all, tried by hypothesis on formulas in single precision, run by NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects
from tests.core.boxes import unit

from . import glass, sharing
from .cases import Cases
from .digits import inner
from .families import CORRECTIONS
from .reference import exact
from .subjects import SUBJECTS, Subject
from .verdict import judge

pytestmark = pytest.mark.without_blender

component = st.one_of(st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-40, -1e-20, 1e-7]), st.floats(-1.0, 1.0, width=32))
three = st.tuples(component, component, component)
coordinate = st.one_of(st.sampled_from([0.0, 1.0, -1.0, 2.0]), st.floats(-1e6, 1e6, width=32))
place = st.tuples(coordinate, coordinate, coordinate)
half_width = st.one_of(st.sampled_from([1.0, 2.0]), st.floats(2.0**-13, 2.0**17, width=32))


def one(values: object) -> np.ndarray:
    return np.asarray(values, np.float32)[None]


@st.composite
def any_case(draw: st.DrawFn, correction: Correction | None = None) -> Cases:
    """One lookup in any box; the point is anywhere, or a share of the half widths from the centre, walls included."""

    correction = correction or draw(st.sampled_from(CORRECTIONS))
    axes = np.eye(3)
    if correction is Correction.ORIENTED_BOX:
        axes, _ = np.linalg.qr(np.array([draw(three) for _ in range(3)]))
        axes = axes.T if np.isfinite(axes).all() else np.eye(3)
    turn = unit(np.array(draw(three)) * (1.0, 1.0, 0.0))
    assume(correction is not Correction.TURNED_BOX or turn.any())
    centre, half = np.array(draw(place)), np.array([draw(half_width) for _ in range(3)])
    position = centre + np.array(draw(three)) * half if draw(st.booleans()) else np.array(draw(place))
    return Cases(
        correction,
        position=one(position),
        incoming=one(unit(np.array(draw(three)))),
        normal=one(unit(np.array(draw(three))) * draw(st.sampled_from([1.0, 1e-3, 1e3]))),
        centre=one(centre),
        face_normals=one(axes),
        half_widths=one(half),
        turn_mirror=one(turn if turn.any() else (1.0, 0.0, 0.0)),
        capture_point=one(centre + np.array(draw(three)) * half),
    )


def look(cases: Cases) -> np.ndarray:
    return evaluate(formula.lookup(LookupEffects(cases.correction, None)), cases.inputs(), np.float32)["Direction"]


@given(any_case())
def test_single_precision_stays_finite_and_within_the_bound(case: Cases) -> None:
    verdict = judge(case, look(case))
    assert verdict.within.all(), (verdict.error, verdict.bound)


@given(any_case(), st.tuples(*[st.sampled_from([-1.0, 1.0])] * 3))
def test_a_face_normal_may_point_either_way(case: Cases, signs: tuple) -> None:
    """Mirrored boxes therefore need nothing of their own: not a bit changes."""
    mirrored = replace(case, face_normals=case.face_normals * np.array(signs, np.float32)[:, None])
    np.testing.assert_array_equal(look(mirrored), look(case))


@given(any_case(), st.integers(-8, 8))
def test_the_unit_of_length_does_not_matter(case: Cases, power: int) -> None:
    """Inside the box and away from its walls, scaling by a power of two changes nothing but denormal products."""
    assume((np.abs(exact(case).origin) < 0.5 * case.half_widths).all())
    lengths = ("position", "centre", "half_widths", "capture_point")
    scaled = replace(case, **{name: getattr(case, name) * np.float32(2.0**power) for name in lengths})
    np.testing.assert_allclose(look(scaled), look(case), rtol=0.0, atol=1e-37)


direction = three.map(lambda v: unit(np.array(v))).filter(lambda v: v.any())
depth = st.one_of(st.sampled_from([0.0, -0.0, -1e-30, -0.2, -1.0, -1e6]), st.floats(-2.0, 2.0, width=32))
share = st.one_of(st.sampled_from([0.0, 1.0, 1e-40]), st.floats(0.0, 1.0, width=32))
fade = st.one_of(st.just(1.0), st.floats(2.0**-30, 2.0**10, width=32))


@pytest.mark.sweep
@pytest.mark.parametrize("subject", [s for s in SUBJECTS if s.kind == "seen through"], ids=str)
@given(st.data(), direction, direction, st.floats(1.0, 2.5, width=32), st.booleans(), st.tuples(*[half_width] * 3))
def test_any_glass_stays_finite_and_within_the_bound(
    subject: Subject, data: st.DataObject, view: np.ndarray, normal: np.ndarray, ior: float, back: bool, size: tuple
) -> None:
    correction, interface = subject.told
    facing = normal * (-1.0 if inner(view, normal) < 0.0 else 1.0)
    case = replace(data.draw(any_case(correction)), incoming=one(view), normal=one(facing))
    axes = one(np.eye(3)[[2, 0, 1]])
    surface = glass.Glass(interface, case, one(ior), one(back), one(size), axes)
    verdict = subject.judge(surface, evaluate(subject.formula.outputs, surface.inputs(), np.float32))
    assert verdict.within.all(), (verdict.error, verdict.bound)


@pytest.mark.parametrize("subject", [s for s in SUBJECTS if s.kind == "shares"], ids=str)
@given(*[st.tuples(*[strategy] * sharing.PROBES) for strategy in (depth, share, fade)], st.booleans())
def test_any_shares_add_up_to_one_and_stay_within_the_bound(
    subject: Subject, depths: tuple, weights: tuple, fades: tuple, diffuse: bool
) -> None:
    point = sharing.Shared(one(depths), one(weights), one(fades), one(diffuse))
    found = evaluate(subject.formula.outputs, point.inputs(), np.float32)
    verdict = subject.judge(point, found)
    assert verdict.within.all(), (verdict.error, verdict.bound)
    total = sharing.parts_of(found).astype(np.float64).sum(-1)
    assert (np.abs(total - 1.0) <= sharing.sum_bound(sharing.PROBES)).all()
