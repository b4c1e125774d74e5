"""Expressions and their evaluation: what the operations mean, in which precision, and how shapes meet."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core import expression as ex
from pcc_addon.core.backends.arrays import evaluate

A, B = ex.scalar("a"), ex.scalar("b")
U, V = ex.vector("u"), ex.vector("v")
BOTH_DTYPES = pytest.mark.parametrize("dtype", [np.float32, np.float64])
dyadic = st.integers(-1024, 1024).map(lambda k: k / 64.0)  # sums and products of these are exact in float64
triple = st.tuples(dyadic, dyadic, dyadic)


def value(expr: ex.Expr, dtype: type = np.float64, **inputs: object) -> np.ndarray:
    return evaluate({"out": expr}, {name: np.asarray(v, np.float64) for name, v in inputs.items()}, dtype)["out"]


@BOTH_DTYPES
def test_anything_divided_by_zero_is_zero(dtype: type) -> None:
    numerators = [1.0, -1.0, 0.0, -0.0, 1e30]
    for zero in (0.0, -0.0):
        assert (value(A / B, dtype, a=numerators, b=np.full(5, zero)) == 0.0).all()
    np.testing.assert_array_equal(value(U / V, dtype, u=[6.0, 1.0, 0.0], v=[3.0, 0.0, 0.0]), [2.0, 0.0, 0.0])


@BOTH_DTYPES
def test_the_zero_vector_normalizes_to_zero_and_others_to_unit_length(dtype: type) -> None:
    out = value(ex.normalize(U), dtype, u=[[0.0, 0.0, 0.0], [3.0, 0.0, -4.0]])
    np.testing.assert_array_equal(out[0], 0.0)
    np.testing.assert_allclose(out[1], [0.6, 0.0, -0.8], rtol=4 * np.finfo(dtype).eps)


@BOTH_DTYPES
def test_the_root_of_a_negative_number_is_zero(dtype: type) -> None:
    np.testing.assert_array_equal(value(ex.sqrt(A), dtype, a=[-4.0, -0.0, 0.0, 9.0]), [0.0, 0.0, 0.0, 3.0])


def test_the_sign_of_zero_is_zero() -> None:
    np.testing.assert_array_equal(value(ex.sign(U), u=[-2.5, 0.0, 7.0]), [-1.0, 0.0, 1.0])


@given(triple, triple, dyadic)
def test_operators_mean_what_python_means_by_them(u: tuple, v: tuple, a: float) -> None:
    values = {"u": u, "v": v, "a": a}
    pairs = list(zip(u, v, strict=True))
    np.testing.assert_array_equal(value(U + V, **values), [p + q for p, q in pairs])
    np.testing.assert_array_equal(value(U - V, **values), [p - q for p, q in pairs])
    np.testing.assert_array_equal(value(U * V, **values), [p * q for p, q in pairs])
    np.testing.assert_array_equal(value(1.0 - A, **values), 1.0 - a)
    np.testing.assert_array_equal(value(2.0 + A * 3.0, **values), 2.0 + a * 3.0)
    np.testing.assert_array_equal(value(1.0 / A, **values), 1.0 / a if a else 0.0)
    np.testing.assert_array_equal(value(ex.absolute(U), **values), [abs(p) for p in u])
    np.testing.assert_array_equal(value(ex.minimum(U, V), **values), [min(p) for p in pairs])
    np.testing.assert_array_equal(value(ex.maximum(U, V), **values), [max(p) for p in pairs])
    np.testing.assert_array_equal(value(ex.multiply_add(U, A, V), **values), [p * a + q for p, q in pairs])
    np.testing.assert_array_equal(value(ex.dot(U, V), **values), math.fsum(p * q for p, q in pairs))
    np.testing.assert_array_equal(value(ex.greatest(U), **values), max(u))
    np.testing.assert_array_equal(value(ex.clamp(A), **values), sorted((0.0, a, 1.0))[1])
    np.testing.assert_array_equal(value(ex.combine(U.z, U.x, U.y), **values), [u[2], u[0], u[1]])


@given(dyadic, dyadic)
def test_mix_gives_its_ends_exactly(a: float, b: float) -> None:
    assert value(ex.mix(A, B, 0.0), a=a, b=b) == a
    assert value(ex.mix(A, B, 1.0), a=a, b=b) == b
    assert value(ex.mix(A, B, 0.5), a=a, b=b) == (a + b) / 2.0


def test_a_scalar_stands_for_all_components_of_a_vector() -> None:
    u = np.arange(12.0).reshape(4, 3)
    a = np.array([1.0, 10.0, 100.0, 1000.0])
    expected = np.array([[a[i] * u[i, k] for k in range(3)] for i in range(4)])
    np.testing.assert_array_equal(value(U * A, u=u, a=a), expected)
    np.testing.assert_array_equal(value(A * U, u=u, a=a), expected)
    np.testing.assert_array_equal(value(U * 2.0, u=u), u * 2.0)
    np.testing.assert_array_equal(value(ex.lift((1.0, 2.0, 3.0)) + U, u=u), np.array([1.0, 2.0, 3.0]) + u)


def test_shapes_follow_the_inputs() -> None:
    u, a = np.ones((5, 4, 3)), np.ones((5, 4))
    assert value(U * A, u=u, a=a).shape == (5, 4, 3)
    assert value(ex.dot(U, V), u=u, v=np.ones(3)).shape == (5, 4)
    assert value(A + B, a=a, b=2.0).shape == (5, 4)
    assert value(ex.combine(A, B, 0.0), a=a, b=1.0).shape == (5, 4, 3)
    assert value(ex.combine(1.0, 2.0, 3.0)).shape == (3,)
    assert value(A, a=2.0).shape == ()


def test_every_step_is_rounded_to_the_precision_asked_for() -> None:
    lost = (A + 1.0) - A
    assert value(lost, np.float32, a=1e8) == 0.0
    assert value(lost, np.float64, a=1e8) == 1.0
    assert value(A - 0.1, np.float32, a=0.1) == 0.0, "inputs and constants are rounded alike"
    assert value(A * A, np.float32, a=1e30) == np.inf


@BOTH_DTYPES
@pytest.mark.parametrize("op", list(ex.Op))
def test_no_operation_changes_the_precision(op: ex.Op, dtype: type) -> None:
    vectors = {
        ex.Op.NORMALIZE: 1,
        ex.Op.LENGTH: 1,
        ex.Op.DOT: 2,
        ex.Op.REFLECT: 2,
        ex.Op.CROSS: 2,
        ex.Op.RANDOM: 1,
        ex.Op.COMPONENT_X: 1,
        ex.Op.COMPONENT_Y: 1,
        ex.Op.COMPONENT_Z: 1,
    }
    scalars = dict.fromkeys((ex.Op.ABSOLUTE, ex.Op.SIGN, ex.Op.FLOOR, ex.Op.SQRT, ex.Op.EXP2, ex.Op.COSINE), 1)
    scalars |= {ex.Op.MULTIPLY_ADD: 3, ex.Op.COMBINE: 3}
    args = [U, V][: vectors[op]] if op in vectors else [A, B, 2.0][: scalars.get(op, 2)]
    out = value(ex.operation(op, *args), dtype, u=[1.0, 2.0, 2.0], v=[1.0, 0.0, 0.0], a=0.3, b=0.7)
    assert out.dtype == dtype
    wide = {ex.Op.NORMALIZE, ex.Op.REFLECT, ex.Op.CROSS, ex.Op.RANDOM, ex.Op.COMBINE}
    assert out.shape == ((3,) if op in wide else ())


def test_widths_are_known_before_anything_is_evaluated() -> None:
    assert [e.width for e in (A, U, ex.lift(2.0), ex.lift((1.0, 2.0, 3.0)))] == [1, 3, 1, 3]
    assert [e.width for e in (A + B, A + U, U * A, ex.dot(U, V), U.x, ex.combine(A, A, A))] == [1, 3, 3, 1, 1, 3]
    assert ex.normalize(U).width == ex.greatest(U).width * 3 == 3


def test_an_expression_used_twice_is_evaluated_once() -> None:
    """Otherwise this takes 2⁴⁰ additions."""
    doubled: ex.Expr = A
    for _ in range(40):
        doubled = doubled + doubled
    assert value(doubled, a=3.0) == 3.0 * 2.0**40


LOOKED = ex.Sample("Sky", U * A)
FORMULA = ex.Formula(
    "Of Many",
    {"Sum": ex.Section("Sum", LOOKED + V), "Again": LOOKED, "Other": ex.Sample("Sea", V) * ex.scalar("Way In")},
)


def test_a_formula_knows_what_it_reads_in_the_order_of_its_first_use() -> None:
    assert {name: part.width for name, part in FORMULA.inputs.items()} == {"u": 3, "a": 1, "v": 3, "Way In": 1}
    assert list(FORMULA.inputs) == ["u", "a", "v", "Way In"] and FORMULA.pictures == ("Sky", "Sea")
    outer = ex.Formula("Outer", {"Result": FORMULA(u=B * V, v=(1.0, 2.0, 3.0))["Sum"]})
    assert list(outer.inputs) == ["b", "v", "a", "Way In"] and outer.pictures == (), "it samples nothing itself"


def test_the_parts_of_a_formula_come_once_and_after_what_they_are_made_of() -> None:
    parts = list(FORMULA.parts())
    assert len({id(part) for part in parts}) == len(parts) == 10
    for k, part in enumerate(parts):
        assert all(argument in parts[:k] for argument in ex.arguments_of(part))
    assert set(FORMULA.outputs.values()) <= set(parts)
    doubled: ex.Expr = A
    for _ in range(40):
        doubled = doubled + doubled
    assert len(list(ex.Formula("Doubled", {"Result": doubled}).parts())) == 41


def test_a_call_gives_inputs_other_expressions_and_passes_on_the_rest() -> None:
    calls = FORMULA(Way_In=2.0, u=V)
    found = dict(zip(FORMULA.inputs, calls.arguments, strict=True))
    assert found["u"] is V and found["v"] is FORMULA.inputs["v"] and found["Way In"].value == (2.0,)
    assert (calls["Sum"].output, calls["Sum"].width, calls["Sum"].calls) == ("Sum", 3, calls)
    double = ex.Formula("Double", {"Twice": A * 2.0, "More": A + B})
    np.testing.assert_array_equal(value(double(a=B + 1.0)["Twice"] - double(b=A)["More"], a=10.0, b=3.0), -12.0)
    with pytest.raises(TypeError, match=r"formula 'Of Many' has no input \['w', 'x y'\]"):
        FORMULA(x_y=1.0, u=U, w=2.0)


def test_a_missing_input_is_named() -> None:
    with pytest.raises(KeyError, match="Box Centre"):
        evaluate({"out": ex.vector("Box Centre") + 1.0}, {})
