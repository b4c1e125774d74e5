"""The reflection lookup against geometry done another way: planes through corners, exact arithmetic, invariants."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.expression import vector
from pcc_addon.core.probe import STEEPEST_FALLOFF, Box, ProbeSpec

from . import boxes
from .boxes import unit

ORIENTED_BLACK = LookupEffects(Correction.ORIENTED_BOX, Outside.BLACK)
ORIENTED = LookupEffects(Correction.ORIENTED_BOX, Outside.UNCORRECTED)
ALIGNED_BLACK = LookupEffects(Correction.ALIGNED_BOX, Outside.BLACK)
CLASSIC = LookupEffects(Correction.NONE)
ALL_EFFECTS = [LookupEffects(c, o, f) for c in Correction for o in Outside for f in (True, False)]
KINDS = pytest.mark.parametrize("kind", boxes.KINDS)
BOTH_DTYPES = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def look(
    effects: LookupEffects,
    m: np.ndarray,
    points: np.ndarray,
    incoming: np.ndarray,
    normals: np.ndarray,
    capture: np.ndarray | None = None,
    padding: float = 0.0,
    falloff: float = 0.25,
    dtype: type = np.float64,
) -> dict[str, np.ndarray]:
    box = Box.from_matrix("test", m)
    inputs = {
        "Position": points,
        "Incoming": incoming,
        "Normal": normals,
        "Box Centre": box.centre,
        **{f"Face Normal {axis}": row for axis, row in zip("XYZ", box.face_normals, strict=True)},
        "Turn Mirror": box.turn_mirror,
        "Half Widths": box.half_widths,
        "Capture Point": box.centre if capture is None else capture,
        "Padding": padding,
        "Falloff": max(falloff, STEEPEST_FALLOFF),
    }
    return evaluate(formula.lookup(effects), inputs, dtype)


def mirrored(incoming: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Half a turn about the normal (Rodrigues), which takes the eye's direction to the reflected one."""
    parallel = np.einsum("...i,...i->...", incoming, normals)[..., None] * normals
    return parallel - (incoming - parallel)


def exit_through_planes(m: np.ndarray, point: np.ndarray, ray: np.ndarray) -> float:
    """The distance at which a ray from inside first meets one of the six planes through the box's corners."""
    nearest = np.inf
    for k, side in itertools.product(range(3), (-1.0, 1.0)):
        first, second = (m[:3, j] for j in range(3) if j != k)
        normal = np.cross(first, second)
        speed = normal @ ray
        if speed != 0.0:
            t = normal @ (m[:3, 3] + side * m[:3, k] - point) / speed
            nearest = min(nearest, t if t > 0.0 else np.inf)
    return nearest


def exit_distance(o: object, d: object, dtype: type) -> np.ndarray:
    """To the wall of the box [−1, 1]³; 0 for what is nearer than `formula.ON_WALL`."""
    inputs = {"q": np.asarray(o, np.float64), "back": -np.asarray(d, np.float64), "Half Widths": np.ones(3)}
    nearness = evaluate({"n": formula.nearness(vector("q"), vector("back"))}, inputs, dtype)["n"]
    return np.where(nearness * formula.ON_WALL > 0.5, 0.0, 1.0 / nearness)


@KINDS
def test_a_ray_from_inside_hits_the_wall_that_the_planes_say(kind: str) -> None:
    rng = np.random.default_rng(1)
    for _ in range(8):
        m = boxes.matrix(kind, rng)
        points = boxes.inside(m, 40, rng)
        incoming, normals = boxes.directions(40, rng), boxes.directions(40, rng)
        capture = boxes.inside(m, 1, rng)[0]
        rays = mirrored(incoming, normals)
        hits = [p + exit_through_planes(m, p, r) * r for p, r in zip(points, rays, strict=True)]
        found = look(ORIENTED_BLACK, m, points, incoming, normals, capture)
        np.testing.assert_allclose(unit(found["Direction"]), unit(np.array(hits) - capture), rtol=1e-9, atol=1e-9)
        np.testing.assert_array_equal(found["Weight"], 1.0)


@KINDS
def test_inside_the_uncorrected_policy_looks_the_same_way(kind: str) -> None:
    rng = np.random.default_rng(2)
    m = boxes.matrix(kind, rng)
    points, incoming, normals = boxes.inside(m, 99, rng), boxes.directions(99, rng), boxes.directions(99, rng)
    black = look(ORIENTED_BLACK, m, points, incoming, normals)["Direction"]
    found = look(ORIENTED, m, points, incoming, normals)["Direction"]
    np.testing.assert_allclose(found, unit(black), atol=1e-12)


@pytest.mark.parametrize("outside", list(Outside))
@pytest.mark.parametrize("signs", list(itertools.product((-1.0, 1.0), repeat=3)))
def test_the_aligned_form_equals_the_oriented_form_on_unrotated_boxes(outside: Outside, signs: tuple) -> None:
    rng = np.random.default_rng(3)
    m = boxes.matrix("unrotated", rng) @ np.diag([*signs, 1.0])
    points = boxes.inside(m, 200, rng, reach=1.3)
    incoming, normals = boxes.directions(200, rng), boxes.directions(200, rng)
    capture = boxes.inside(m, 1, rng)[0]
    aligned, oriented = (
        look(LookupEffects(c, outside), m, points, incoming, normals, capture)
        for c in (Correction.ALIGNED_BOX, Correction.ORIENTED_BOX)
    )
    np.testing.assert_allclose(unit(aligned["Direction"]), unit(oriented["Direction"]), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(aligned["Weight"], oriented["Weight"], rtol=1e-12, atol=1e-12)


@BOTH_DTYPES
@pytest.mark.parametrize("zeros", list(itertools.product((0.0, -0.0), repeat=2)))
@pytest.mark.parametrize(("axis", "side"), list(itertools.product(range(3), (-1.0, 1.0))))
def test_a_ray_along_an_axis_ends_at_that_axis_wall(axis: int, side: float, zeros: tuple, dtype: type) -> None:
    o = np.array([0.25, -0.5, 0.75])
    d = np.insert(np.array(zeros), axis, side * 2.0)
    expected = abs(side - o[axis]) / 2.0
    assert exit_distance(o, d, dtype) == pytest.approx(expected, rel=2.0 * np.finfo(dtype).eps)  # two reciprocals


@BOTH_DTYPES
def test_a_ray_in_a_plane_ends_at_the_nearer_of_two_walls(dtype: type) -> None:
    assert exit_distance([0.5, 0.0, 0.0], [0.5, -0.0, 0.25], dtype) == 1.0
    assert exit_distance([0.5, 0.0, 0.5], [0.25, 0.0, 0.5], dtype) == 1.0


@BOTH_DTYPES
def test_from_walls_edges_and_corners_rays_leave_at_once_or_cross_the_box(dtype: type) -> None:
    for o in itertools.product((-1.0, 0.0, 1.0), repeat=3):
        if any(o):
            assert exit_distance(o, o, dtype) == 0.0, o
            assert exit_distance(o, [-c for c in o], dtype) == 2.0, o


@BOTH_DTYPES
def test_a_ray_within_a_wall_runs_to_the_next_wall(dtype: type) -> None:
    rounding = 2.0 * np.finfo(dtype).eps
    assert exit_distance([1.0, 0.25, 0.0], [0.0, 1.0, 0.0], dtype) == pytest.approx(0.75, rel=rounding)
    assert exit_distance([1.0, -1.0, 0.25], [-0.0, 0.0, -1.0], dtype) == pytest.approx(1.25, rel=rounding)


@BOTH_DTYPES
def test_a_point_a_rounding_beyond_the_wall_is_on_it(dtype: type) -> None:
    eps = float(np.finfo(dtype).eps)
    beyond = 1.0 + 4.0 * eps
    assert exit_distance([beyond, 0.0, 0.0], [1.0, 0.0, 0.0], dtype) == pytest.approx(0.0, abs=5.0 * eps)
    assert exit_distance([beyond, 0.0, 0.0], [-1.0, 0.0, 0.0], dtype) == pytest.approx(2.0, rel=1e-5)


@KINDS
def test_from_every_capture_point_the_same_spot_of_the_wall_is_looked_up(kind: str) -> None:
    rng = np.random.default_rng(4)
    m = boxes.matrix(kind, rng)
    points, incoming, normals = boxes.inside(m, 99, rng), boxes.directions(99, rng), boxes.directions(99, rng)
    spots = []
    for capture in boxes.inside(m, 3, rng):
        directions = look(ORIENTED_BLACK, m, points, incoming, normals, capture)["Direction"]
        spots.append([capture + exit_through_planes(m, capture, d) * d for d in directions])
    np.testing.assert_allclose(spots[0], spots[1], atol=1e-9)
    np.testing.assert_allclose(spots[0], spots[2], atol=1e-9)


@pytest.mark.parametrize("outside", [*Outside, None])
@pytest.mark.parametrize("correction", [c for c in Correction if c is not Correction.NONE])
def test_the_centred_form_equals_the_offset_form_where_the_capture_point_is_the_centre(
    correction: Correction, outside: Outside | None
) -> None:
    rng = np.random.default_rng(32)
    m = boxes.matrix("rotated" if correction is Correction.ORIENTED_BOX else "unrotated", rng)
    points, incoming, normals = boxes.inside(m, 99, rng), boxes.directions(99, rng), boxes.directions(99, rng)
    centred, offset = (look(LookupEffects(correction, outside, o), m, points, incoming, normals) for o in (False, True))
    np.testing.assert_array_equal(centred["Direction"], offset["Direction"])


@pytest.mark.parametrize("outside", [*Outside, None])
@pytest.mark.parametrize("turn", [0.3, -2.4, math.pi / 2, math.pi, -math.pi, 1e-6])
def test_the_turned_form_equals_the_oriented_form_on_boxes_turned_about_the_vertical(
    outside: Outside | None, turn: float
) -> None:
    rng = np.random.default_rng(31)
    c, s = math.cos(turn), math.sin(turn)
    for signs in itertools.product((-1.0, 1.0), repeat=3):
        m = boxes.matrix("unrotated", rng) @ np.diag([*signs, 1.0])
        m[:3, :3] = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ m[:3, :3]
        assert Box.from_matrix("test", m).correction is Correction.TURNED_BOX
        points = boxes.inside(m, 100, rng, reach=1.0 if outside is None else 1.3)
        incoming, normals = boxes.directions(100, rng), boxes.directions(100, rng)
        turned, oriented = (
            look(LookupEffects(correction, outside), m, points, incoming, normals, points[0] * 0.5 + m[:3, 3] * 0.5)
            for correction in (Correction.TURNED_BOX, Correction.ORIENTED_BOX)
        )
        np.testing.assert_allclose(unit(turned["Direction"]), unit(oriented["Direction"]), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(turned["Weight"], oriented["Weight"], rtol=1e-9, atol=1e-9)


def test_where_the_spot_is_the_capture_point_itself_nothing_breaks() -> None:
    up = np.array([0.0, 0.0, 1.0])
    found = look(ORIENTED, np.eye(4), np.zeros(3), up, up, capture=up, dtype=np.float32)
    assert np.isfinite(found["Direction"]).all()


def test_the_classic_lookup_needs_no_box_and_mirrors_about_the_normal() -> None:
    rng = np.random.default_rng(5)
    incoming, normals = boxes.directions(99, rng), boxes.directions(99, rng)
    found = evaluate(formula.lookup(CLASSIC), {"Incoming": incoming, "Normal": normals}, np.float64)
    np.testing.assert_allclose(found["Direction"], mirrored(incoming, normals), atol=1e-14)
    assert found["Weight"] == 1.0


def _walk_out(effects: LookupEffects, m: np.ndarray, **settings: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Walk through the wall at local +X, 0.01 m a step; returns metres beyond the wall and the lookups there."""
    outward = np.cross(m[:3, 1], m[:3, 2])
    outward *= np.sign(outward @ m[:3, 0]) / np.linalg.norm(outward)
    metres = np.arange(-0.5, 1.0, 0.01)
    points = m[:3, 3] + m[:3, 0] + metres[:, None] * outward
    incoming = np.broadcast_to([0.6, 0.0, 0.8], points.shape)
    normals = np.broadcast_to([0.0, 0.0, 1.0], points.shape)
    return metres, look(effects, m, points, incoming, normals, **settings)


@pytest.mark.parametrize("kind", ["unrotated", "rotated", "mirrored"])
def test_the_weight_is_1_inside_0_beyond_the_falloff_and_falls_steadily_between(kind: str) -> None:
    m = boxes.matrix(kind, np.random.default_rng(6))
    metres, found = _walk_out(ORIENTED_BLACK, m, padding=0.1, falloff=0.4)
    weight = found["Weight"]
    np.testing.assert_array_equal(weight[metres < 0.0999], 1.0)
    np.testing.assert_array_equal(weight[metres > 0.5001], 0.0)
    between = (metres > 0.12) & (metres < 0.48)
    assert ((weight[between] > 0.0) & (weight[between] < 1.0)).all()
    steps = np.diff(weight)
    assert (steps <= 1e-12).all()
    assert (np.abs(steps) < 2.0 * 0.01 / 0.4).all(), "no step where the fall begins, ends or is steepest"
    np.testing.assert_allclose(np.interp(0.3, metres, weight), 0.5, atol=1e-9)
    assert np.abs(np.diff(steps)).max() < 0.005, "no kink either"


def test_beyond_the_falloff_the_uncorrected_policy_is_the_classic_lookup() -> None:
    m = boxes.matrix("rotated", np.random.default_rng(7))
    metres, found = _walk_out(ORIENTED, m, padding=0.1, falloff=0.4)
    _, classic = _walk_out(CLASSIC, m)
    _, black = _walk_out(ORIENTED_BLACK, m, padding=0.1, falloff=0.4)
    assert found["Weight"] == 1.0, "it never darkens"
    np.testing.assert_allclose(found["Direction"][metres > 0.51], classic["Direction"][metres > 0.51], atol=1e-12)
    inside = metres < 0.09
    np.testing.assert_allclose(found["Direction"][inside], unit(black["Direction"][inside]), atol=1e-12)
    assert np.linalg.norm(np.diff(found["Direction"], axis=0), axis=-1).max() < 0.2, "the view never jumps"


def test_without_falloff_there_is_an_edge_and_nothing_else() -> None:
    metres, found = _walk_out(ORIENTED_BLACK, np.diag([2.0, 1.0, 3.0, 1.0]), padding=0.105, falloff=0.0)
    np.testing.assert_array_equal(found["Weight"], (metres < 0.105).astype(float))


@KINDS
def test_far_from_the_origin_float32_loses_no_more_than_its_inputs_did(kind: str) -> None:
    """Both precisions start from the same float32 numbers: only what the formula itself adds is measured.

    Multiplying by the 4×4 inverse before subtracting the centre would lose some 10⁻³ here.
    """
    rng = np.random.default_rng(8)
    m = boxes.matrix(kind, rng, centre=(20000.0, -35000.0, 9000.0)).astype(np.float32).astype(np.float64)
    points = boxes.inside(m, 500, rng, reach=0.95).astype(np.float32)
    incoming = boxes.directions(500, rng).astype(np.float32)
    normals = boxes.directions(500, rng).astype(np.float32)
    capture = (m[:3, 3] + 0.25).astype(np.float32)
    single = look(ORIENTED_BLACK, m, points, incoming, normals, capture, dtype=np.float32)["Direction"]
    double = look(ORIENTED_BLACK, m, points, incoming, normals, capture)["Direction"]
    size = np.linalg.norm(m[:3, :3])
    assert np.abs(single - double).max() < 2e-5 * size


@pytest.mark.parametrize("distance", [0.0, 1e2, 1e4, 1e6])
@pytest.mark.parametrize("kind", ["unrotated", "rotated", "mirrored"])
def test_a_surface_on_a_wall_is_inside_and_does_not_flicker(kind: str, distance: float) -> None:
    rng = np.random.default_rng(9)
    for _ in range(5):
        m = boxes.matrix(kind, rng, centre=tuple(distance * boxes.directions(1, rng)[0]))
        spec = ProbeSpec("test", Box.from_matrix("test", m), padding=0.0, falloff=0.0)
        local = rng.uniform(-1.0, 1.0, (300, 3))
        local[np.arange(300), rng.integers(0, 3, 300)] = rng.choice([-1.0, 1.0], 300)
        local[:8] = list(itertools.product((-1.0, 1.0), repeat=3))
        points = m[:3, 3] + local @ m[:3, :3].T
        v = boxes.directions(300, rng)
        effects = LookupEffects(spec.box.correction, Outside.BLACK)
        found = look(effects, m, points, v, v, padding=spec.influence_padding, falloff=0.0, dtype=np.float32)
        np.testing.assert_array_equal(found["Weight"], 1.0)


# Exact zeros and ones (axis-parallel rays), denormals and ordinary values.
component = st.one_of(st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-40, -1e-20]), st.floats(-1.0, 1.0, width=32))
unit_vector = st.tuples(component, component, component).map(
    lambda v: tuple(np.divide(v, np.linalg.norm(v) or 1.0))  # the zero vector too: a mesh may have such normals
)
coordinate = st.one_of(st.sampled_from([0.0, 1.0, -1.0, 2.0]), st.floats(-1e6, 1e6, width=32))
half_extent = st.floats(1e-3, 1e3)


@given(
    effects=st.sampled_from(ALL_EFFECTS),
    incoming=unit_vector,
    normal=unit_vector,
    point=st.tuples(coordinate, coordinate, coordinate),
    centre=st.tuples(coordinate, coordinate, coordinate),
    extents=st.tuples(half_extent, half_extent, half_extent),
    falloff=st.one_of(st.just(0.0), st.floats(0.0, 1e3)),
    seed=st.integers(0, 99),
)
def test_finite_inputs_never_give_nan_or_infinity(
    effects: LookupEffects,
    incoming: tuple,
    normal: tuple,
    point: tuple,
    centre: tuple,
    extents: tuple,
    falloff: float,
    seed: int,
) -> None:
    m = np.eye(4)
    m[:3, :3] = np.diag(extents)
    if effects.correction is Correction.ORIENTED_BOX and seed:
        m[:3, :3] = boxes.rotation(np.random.default_rng(seed)) @ m[:3, :3]
    m[:3, 3] = centre
    for dtype in (np.float32, np.float64):
        arrays = (np.array(v) for v in (point, incoming, normal))
        found = look(effects, m, *arrays, falloff=falloff, dtype=dtype)
        assert np.isfinite(found["Direction"]).all()
        assert 0.0 <= found["Weight"] <= 1.0
