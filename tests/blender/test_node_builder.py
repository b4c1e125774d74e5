"""Emitted node groups compute in Cycles what NumPy computes in float32."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from pcc_addon.blender.shade import groups, node_builder
from pcc_addon.core import expression as ex
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.dominant import dominant
from pcc_addon.core.effects.fresnel import METAL, MIRRORS, dielectric_facets
from pcc_addon.core.effects.lookup import DIRECTION, OFFSET, POSITION, lookup, lookup_formula
from pcc_addon.core.effects.metal import Metal, TintedMetal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.effects.surface import SurfaceEffects, surface
from pcc_addon.core.expression import Expr, Op, operation, scalar, vector
from pcc_addon.core.ggx import Distribution
from tests.core.boxes import directions
from tests.shader_harness import evaluate_expressions, evaluate_group

CASES = 16384
EPS = float(np.finfo(np.float32).eps)
A, B, C = vector("a"), vector("b"), vector("c")
S, T, U = scalar("s"), scalar("t"), scalar("u")


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240)


def signed(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Numbers of both signs over six decades, with some exact zeros and ones."""
    numbers = rng.choice([-1.0, 1.0], shape) * 10.0 ** rng.uniform(-3.0, 3.0, shape)
    special = rng.choice([0.0, -0.0, 1.0, -1.0], shape)
    return np.where(rng.random(shape) < 0.1, special, numbers).astype(np.float32)


def unit(rng: np.random.Generator, count: int) -> np.ndarray:
    return directions(count, rng).astype(np.float32)


# Every operation with each mix of widths that formulas may write, and the largest term that is rounded on the way.
OPERATIONS: list[tuple[str, Expr, Callable[[dict], np.ndarray] | None]] = [
    ("a scalar sum", S + T, None),
    ("a vector sum", A + B, None),
    ("a vector plus a scalar", A + S, None),
    ("a number minus a vector", 1.0 - A, None),
    ("a scalar difference", S - T, None),
    ("a vector difference", A - B, None),
    ("a scalar product", S * T, None),
    ("a vector product", A * B, None),
    ("a vector times a scalar", A * S, None),
    ("a scalar times a vector", S * A, None),
    ("a scalar quotient", S / T, None),
    ("a vector quotient", A / B, None),
    ("a vector over a scalar", A / S, None),
    ("a number over a vector", 2.0 / A, None),
    ("a scalar minimum", ex.minimum(S, T), None),
    ("a vector minimum", ex.minimum(A, B), None),
    ("a scalar maximum", ex.maximum(S, T), None),
    ("a vector maximum", ex.maximum(A, 0.25), None),
    ("a scalar's absolute value", ex.absolute(S), None),
    ("a vector's absolute value", ex.absolute(A), None),
    ("a scalar's sign", ex.sign(S), None),
    ("a vector's sign", ex.sign(A), None),
    ("a scalar rounded down", ex.floor(S), None),
    ("a vector rounded down", ex.floor(A), None),
    (
        "a cross product",
        ex.cross(A, B),
        lambda v: np.abs(v["a"]).max(-1, keepdims=True) * abs(v["b"]).max(-1, keepdims=True),
    ),
    ("three random numbers", ex.random(A), None),
    ("a square root", ex.sqrt(S), None),
    ("a vector's square roots", ex.sqrt(A), None),
    ("a power of two", ex.exp2(ex.clamp(S, -100.0, 100.0)), None),
    ("a vector's powers of two", ex.exp2(ex.clamp(A, -100.0, 100.0)), None),
    ("a cosine", ex.cosine(S), lambda v: 1.0),
    ("a vector's cosines", ex.cosine(A), lambda v: 1.0),
    ("a scalar multiply-add", ex.multiply_add(S, T, U), lambda v: abs(v["s"] * v["t"])),
    ("a vector multiply-add", ex.multiply_add(A, B, C), lambda v: abs(v["a"] * v["b"])),
    ("a multiply-add with a scalar factor", ex.multiply_add(A, S, C), lambda v: abs(v["a"] * v["s"][:, None])),
    ("a multiply-add of a constant", ex.multiply_add((1.0, 2.0, 3.0), S, 0.5), lambda v: abs(v["s"][:, None]) * 3.0),
    ("a dot product", ex.dot(A, B), lambda v: abs(v["a"] * v["b"]).sum(-1)),
    ("a normalised vector", ex.normalize(A), lambda v: 1.0),
    ("a length", ex.length(A), lambda v: np.linalg.norm(v["a"], axis=-1)),
    # Its normal is rounded three times while it is made a unit vector.
    ("a reflected vector", ex.reflect(A, B), lambda v: 4.0 * np.linalg.norm(v["a"], axis=-1, keepdims=True)),
    ("a combined vector", ex.combine(S, T, 3.5), None),
    ("a first component", A.x, None),
    ("a second component", A.y, None),
    ("a third component", A.z, None),
    ("a mix", ex.mix(A, B, T), lambda v: abs((v["b"] - v["a"]) * v["t"][:, None]) + abs(v["a"])),
    ("a clamp", ex.clamp(A), None),
    ("a greatest component", ex.greatest(A), None),
]


@pytest.mark.sweep
@pytest.mark.parametrize(("expr", "terms"), [o[1:] for o in OPERATIONS], ids=[o[0] for o in OPERATIONS])
def test_a_node_computes_its_operation_to_two_ulp(scene, rng, expr, terms) -> None:
    values = {name: signed(rng, CASES, 3) for name in "abc"} | {name: signed(rng, CASES) for name in "stu"}
    outputs = {"Result": expr}
    found = evaluate_expressions(outputs, values)["Result"]
    expected = evaluate(outputs, values)["Result"]
    assert np.isfinite(expected).all() and np.ptp(expected) > 0.5
    rounded = np.abs(expected) if terms is None else np.maximum(terms(values), np.abs(expected))
    # Cycles may fuse a product with the sum behind it, so the unit is the ulp of the largest term.
    ulps = np.abs(found.astype(np.float64) - expected) / np.spacing(rounded.astype(np.float32))
    assert ulps.max() <= 2.0, f"{ulps.max():.1f} ulp at {np.argmax(ulps)}"


def test_the_harness_shows_a_wrong_result(scene, rng) -> None:
    values = {"s": signed(rng, 1000), "t": signed(rng, 1000)}
    found = evaluate_expressions({"Result": S * T}, values)["Result"]
    assert (found != (values["s"] * values["t"] * np.float32(1.0 + 4.0 * EPS))).mean() > 0.5


def test_every_operation_is_tried(scene) -> None:
    def operations(expr: Expr) -> set[Op]:
        arguments = getattr(expr, "args", ())
        own = {expr.op} if arguments else set()
        return own.union(*(operations(argument) for argument in arguments))

    assert set().union(*(operations(expr) for _, expr, _ in OPERATIONS)) == set(Op)


def test_dividing_by_zero_and_rooting_a_negative_give_zero(scene) -> None:
    zero = np.array([0.0, -0.0, 0.0, -0.0], np.float32)
    numerator = np.array([1.0, -2.0, 0.0, 0.0], np.float32)
    vectors = np.repeat(numerator[:, None], 3, 1)
    outputs = {"Scalar": S / T, "Vector": A / T, "Root": ex.sqrt(U), "Roots": ex.sqrt(A - 9.0), "Unit": ex.normalize(B)}
    inputs = {"s": numerator, "t": zero, "a": vectors, "u": -np.ones(4), "b": np.zeros((4, 3))}
    found = evaluate_expressions(outputs, inputs)
    assert all((found[name] == 0.0).all() for name in outputs)


def test_the_harness_keeps_the_sign_and_the_order_of_few_and_of_many_cases(scene, rng) -> None:
    for count in (1, 2, 17, 1000):
        values = {"s": signed(rng, count), "a": signed(rng, count, 3)}
        found = evaluate_expressions({"Scalar": S + 0.0, "Vector": A + 0.0}, values)
        assert np.array_equal(found["Scalar"], values["s"]) and np.array_equal(found["Vector"], values["a"])


def lookup_inputs(rng: np.random.Generator, correction: Correction) -> dict[str, np.ndarray]:
    """Boxes of many sizes and places; points inside, outside and exactly on walls; some rays along the axes."""
    half = 10.0 ** rng.uniform(-0.5, 1.3, (CASES, 3))
    centre = rng.uniform(-100.0, 100.0, (CASES, 3))
    turn = np.broadcast_to(np.eye(3), (CASES, 3, 3))
    mirror = unit(rng, CASES) * (1.0, 1.0, 0.0)
    mirror /= np.linalg.norm(mirror, axis=-1, keepdims=True)
    if correction is Correction.TURNED_BOX:
        turn = turn - 2.0 * mirror[:, :, None] * mirror[:, None, :]
    elif correction is Correction.ORIENTED_BOX:
        turn = np.linalg.qr(rng.normal(size=(CASES, 3, 3)))[0]
    axes = turn * half[:, None, :]
    local = rng.uniform(-1.2, 1.2, (CASES, 3))
    on_wall = rng.random((CASES, 3)) < 0.1
    local = np.where(on_wall, np.sign(local), local)
    normal, incoming = unit(rng, CASES), unit(rng, CASES)
    straight = rng.random(CASES) < 0.1
    normal[straight] = np.eye(3, dtype=np.float32)[rng.integers(0, 3, straight.sum())]
    incoming[straight] = normal[straight]
    return {
        "Position": centre + np.einsum("nij,nj->ni", axes, local),
        "Direction": 2.0 * (incoming * normal).sum(-1, keepdims=True) * normal - incoming,
        "Offset": np.where(rng.random((CASES, 1)) < 0.5, 0.0, 0.1 * unit(rng, CASES)),
        "Normal": normal,
        "Box Centre": centre,
        **{f"Face Normal {axis}": turn[:, :, k] for k, axis in enumerate("XYZ")},
        "Turn Mirror": mirror,
        "Half Widths": half,
        "Capture Point": centre + half * rng.uniform(-0.5, 0.5, (CASES, 3)),
        "Padding": rng.uniform(0.001, 0.1, CASES),
        "Falloff": np.maximum(rng.uniform(-0.1, 0.5, CASES), 1e-9),
    }


LOOKUPS = [
    LookupEffects(Correction.NONE, None, False),
    *(LookupEffects(c, o) for c in Correction for o in (*Outside, None) if c is not Correction.NONE),
    *(LookupEffects(c, None, False) for c in Correction if c is not Correction.NONE),
    *(LookupEffects(c, Outside.UNCORRECTED, False, stretched=True) for c in Correction),
    LookupEffects(Correction.ORIENTED_BOX, Outside.UNCORRECTED, hardening=True),
    LookupEffects(Correction.TURNED_BOX, None, False, stretched=True, hardening=True),
    *(LookupEffects(c, Outside.OWN, steps=2) for c in Correction if c is not Correction.NONE),
    LookupEffects(Correction.ALIGNED_BOX, None, False, steps=2),
]


@pytest.mark.sweep
@pytest.mark.parametrize("effects", LOOKUPS, ids=lambda e: e.label)
def test_the_lookup_group_computes_the_formula(scene, rng, effects) -> None:
    outputs = lookup(effects, DIRECTION, POSITION + OFFSET)
    sample = lookup_inputs(rng, effects.correction)
    values = {name: array.astype(np.float32) for name, array in sample.items()}
    found = evaluate_group(groups.formula_group(lookup_formula(effects)), values)
    expected = evaluate(outputs, values)
    exact = evaluate(outputs, values, np.float64)
    spread = conditioning(outputs, values, exact, rng)
    for name in outputs:
        check_like_numpy(found[name], expected[name], exact[name], spread[name])


def conditioning(
    outputs: dict[str, Expr], values: dict[str, np.ndarray], exact: dict[str, np.ndarray], rng: np.random.Generator
) -> dict[str, np.ndarray]:
    """How far each exact result moves when its inputs move by the rounding of float32: the least that any may err."""
    spread = {name: np.full_like(result, EPS) for name, result in exact.items()}
    for _ in range(16):
        moved = {n: v * (1.0 + EPS * rng.uniform(-1.0, 1.0, v.shape)) for n, v in values.items()}
        for name, result in evaluate(outputs, moved, np.float64).items():
            change = np.abs(result - exact[name])
            spread[name] = np.maximum(spread[name], change.max(-1, keepdims=True) if change.ndim > 1 else change)
    return spread


def check_like_numpy(found: np.ndarray, expected: np.ndarray, exact: np.ndarray, unit_size: np.ndarray) -> None:
    """The shader differs from NumPy's float32 by at most 16 units and what NumPy itself errs.

    The unit is what one rounding of the inputs does to the result. Cycles may fuse products with sums, which rounds
    differently.
    """
    error = np.abs(found - expected)
    allowed = np.abs(expected - exact) + 16.0 * unit_size
    worst = np.unravel_index((error - allowed).argmax(), error.shape)
    assert (error <= allowed).all(), f"case {worst}: {found[worst]} where NumPy has {expected[worst]}"


@pytest.mark.parametrize("facets", [(MIRRORS,), (dielectric_facets(1.5), METAL)], ids=len)
def test_the_dominant_direction_group_computes_the_formula(scene, rng, facets) -> None:
    normal, incoming = unit(rng, CASES), unit(rng, CASES)
    incoming *= np.sign((normal * incoming).sum(-1, keepdims=True))
    values = {
        "Metallic": rng.random(CASES),
        "Roughness": np.where(rng.random(CASES) < 0.2, 0.0, rng.random(CASES)),
        "Normal": normal,
        "Incoming": incoming,
    }
    values = {k: np.asarray(v, np.float32) for k, v in values.items()}
    formula = dominant(facets)
    found = evaluate_group(groups.formula_group(formula), values)
    expected = evaluate(formula.outputs, values)
    exact = evaluate(formula.outputs, values, np.float64)
    for name in formula.outputs:
        check_like_numpy(found[name], expected[name], exact[name], np.float32(32.0 * EPS))


SURFACES = [
    SurfaceEffects((Dielectric.of(1.5, 0.5),)),
    SurfaceEffects((Dielectric.of(1.45, None), Metal(tinted=True))),
    SurfaceEffects((Metal(pure=True),)),
    SurfaceEffects((TintedMetal(True),), distribution=Distribution.BECKMANN),
    SurfaceEffects((Multiscatter(), Dielectric.of(1.5, 0.8))),
    SurfaceEffects((Multiscatter(), Dielectric.of(1.5, None))),
    SurfaceEffects((Dielectric.of(4.0, 0.5), Metal())),
    SurfaceEffects((Multiscatter(), Metal(tinted=True, pure=True))),
]


@pytest.mark.parametrize("effects", SURFACES, ids=lambda e: e.label)
def test_the_surface_group_computes_the_formula(scene, rng, effects) -> None:
    outputs = surface(effects)
    normal, incoming = unit(rng, CASES), unit(rng, CASES)
    incoming *= np.sign((normal * incoming).sum(-1, keepdims=True))
    incoming[: CASES // 8] = normal[: CASES // 8]
    values = {
        "Radiance": 10.0 ** rng.uniform(-3.0, 3.0, (CASES, 3)),
        "Base Color": rng.random((CASES, 3)),
        "Metallic": rng.random(CASES),
        "Captured": rng.random(CASES).round(),
        "Roughness": np.where(rng.random(CASES) < 0.2, 0.0, rng.random(CASES)),
        "Specular IOR Level": rng.random(CASES),
        "Specular Tint": rng.random((CASES, 3)),
        "Edge Tint": rng.random((CASES, 3)),
        "Offset": np.where(rng.random((CASES, 1)) < 0.5, 0.0, 0.1 * unit(rng, CASES)),
        "Normal": normal,
        "Incoming": incoming,
    }
    values = {k: np.asarray(v, np.float32) for k, v in values.items()}
    found = evaluate_group(groups.surface_group(effects), values)
    expected = evaluate(outputs, values)
    exact = evaluate(outputs, values, np.float64)
    # Terms of the fitted polynomials are some thirty times their sum, so that rounding differently shows as much more.
    unit_size = 32.0 * EPS * values["Radiance"]
    check_like_numpy(found["Reflection"], expected["Reflection"], exact["Reflection"], unit_size)
    unit_size = 32.0 * EPS * values["Base Color"]
    check_like_numpy(found["Diffuse Color"], expected["Diffuse Color"], exact["Diffuse Color"], unit_size)


def test_equal_operations_become_one_node(scene) -> None:
    tree = bpy.data.node_groups.new("shared", "ShaderNodeTree")
    product = (vector("a") + vector("b")) * (vector("a") + vector("b"))
    node_builder.emit(tree, {"First": product, "Second": ex.dot(vector("a") + vector("b"), product)})
    operations = sorted(node.operation for node in tree.nodes if node.bl_idname == "ShaderNodeVectorMath")
    assert operations == ["ADD", "DOT_PRODUCT", "MULTIPLY"]
    assert len(tree.nodes) == len(operations) + 2, "and the ends of the group"


def test_operations_on_different_constants_stay_apart(scene) -> None:
    values = {"s": np.array([1.0, 2.0, 3.0], np.float32)}
    found = evaluate_expressions({"Result": (scalar("s") + 1.0) * (scalar("s") + 2.0)}, values)["Result"]
    assert found.tolist() == [6.0, 12.0, 20.0]


def _computes(node: bpy.types.Node) -> tuple[str, str, str]:
    called = getattr(node, "node_tree", None)
    return node.bl_idname, getattr(node, "operation", ""), called.name if called else ""


@pytest.mark.parametrize("outputs", [*map(lookup, LOOKUPS), *map(surface, SURFACES)])
def test_no_two_nodes_of_a_formula_compute_the_same(scene, outputs) -> None:
    tree = bpy.data.node_groups.new("formula", "ShaderNodeTree")
    node_builder.emit(tree, outputs, node_builder.Surroundings(group_of=groups.formula_group))

    def value(socket: bpy.types.NodeSocket) -> object:
        if socket.is_linked:
            source = socket.links[0].from_socket
            return source.node.name, source.identifier
        plain = getattr(socket, "default_value", None)
        return tuple(plain) if hasattr(plain, "__len__") else plain

    seen = [
        (_computes(node), tuple(value(s) for s in node.inputs if s.enabled))
        for node in tree.nodes
        if not node.bl_idname.startswith(("NodeGroup", "NodeFrame"))
    ]
    assert len(seen) == len(set(seen))


def test_a_constant_output_and_an_operation_of_constants_keep_their_values(scene) -> None:
    outputs = {"Number": ex.lift(1.25), "Vector": ex.lift((1.0, -2.0, 3.0)), "Sum": operation(Op.ADD, 1.0, 2.5) + S}
    found = evaluate_expressions(outputs, {"s": np.zeros(2)})
    assert found["Number"].tolist() == [1.25, 1.25]
    assert found["Vector"].tolist() == [[1.0, -2.0, 3.0]] * 2
    assert found["Sum"].tolist() == [3.5, 3.5]
