"""Relief against rooms whose exact answer is known: rays meet what stands in them, and the box where nothing does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pcc_addon.core import equirect, nearness
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import choice, lookup, relief
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.expression import Formula
from pcc_addon.core.probe import Box, ProbeSpec

ROWS = 512
HALF = np.array([4.0, 3.0, 1.4])


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


@dataclass(frozen=True)
class Block:
    """A solid block in a room, along the room's axes."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def distance(self, start: np.ndarray, ray: np.ndarray) -> np.ndarray:
        """(n,) metres along unit rays (n, 3) from outside; infinite where they miss."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack([(np.array(self.low) - start) / ray, (np.array(self.high) - start) / ray])
        near, far = np.nanmin(ends, 0).max(-1), np.nanmax(ends, 0).min(-1)
        return np.where((near <= far) & (near > 1e-9), near, np.inf)


def to_walls(start: np.ndarray, ray: np.ndarray) -> np.ndarray:
    """(n,) metres along unit rays from inside the room to its walls."""
    with np.errstate(divide="ignore"):
        return ((HALF - start * np.sign(ray)) / np.abs(ray)).min(-1)


def room_spec(turn: float = 0.0, centre=(0.0, 0.0, 0.0), capture=(0.0, 0.0, 0.0), resolution: int = 64) -> ProbeSpec:
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) * HALF
    matrix[:3, 3] = centre
    return ProbeSpec("Hall", Box.from_matrix("Hall", matrix), capture_offset=capture, resolution=resolution)


def captured(blocks: list[Block], capture, rows: int = ROWS, turn: float = 0.0) -> np.ndarray:
    """(h, 2h, 3) nearness in a room at the origin, turned about the vertical."""
    rays = equirect.directions(2 * rows, rows).reshape(-1, 3) @ turned(turn)
    start = np.broadcast_to(np.asarray(capture, float), rays.shape)
    far = np.minimum.reduce([to_walls(start, rays), *(block.distance(start, rays) for block in blocks)])
    return np.repeat((1.0 / far).reshape(rows, 2 * rows, 1), 3, -1).astype(np.float32)


def turned(turn: float) -> np.ndarray:
    """(3, 3): rows of the room's axes to the world's, for row vectors: world @ turned = local."""
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def inputs(spec: ProbeSpec, position: np.ndarray, ray: np.ndarray) -> dict[str, np.ndarray]:
    box = spec.box
    return {
        "Position": position,
        "Direction": ray,
        "Offset": np.zeros_like(position),
        "Normal": np.broadcast_to((0.0, 0.0, 1.0), position.shape),
        "Box Centre": np.broadcast_to(box.centre, position.shape),
        **{
            f"Face Normal {a}": np.broadcast_to(n, position.shape) for a, n in zip("XYZ", box.face_normals, strict=True)
        },
        "Turn Mirror": np.broadcast_to(box.turn_mirror, position.shape),
        "Half Widths": np.broadcast_to(box.half_widths, position.shape),
        "Capture Point": np.broadcast_to(spec.capture_point, position.shape),
        "Padding": np.array(0.01),
        "Falloff": np.array(0.25),
        "Boundary": np.array(spec.boundary),
    }


def found(
    effects: LookupEffects, values: Mapping[str, np.ndarray], picture: np.ndarray, dtype: type = np.float64
) -> dict[str, np.ndarray]:
    outputs = Formula("Found", lookup.found_along(effects, lookup.DIRECTION)).outputs
    return evaluate(outputs, values, dtype, {relief.PICTURE: picture})


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def floor_rays(rng: np.random.Generator, count: int, keep_off: list[Block] = ()) -> tuple[np.ndarray, np.ndarray]:
    """Rays that leave the floor upwards, from beside blocks."""
    at = rng.uniform(-0.98, 0.98, (count, 3)) * HALF
    at[:, 2] = -HALF[2]
    ray = unit(rng.normal(size=(count, 3)))
    ray[:, 2] = np.abs(ray[:, 2]) + 0.02
    for block in keep_off:
        inside = ((at[:, :2] > np.array(block.low)[:2]) & (at[:, :2] < np.array(block.high)[:2])).all(-1)
        at, ray = at[~inside], ray[~inside]
    return at, unit(ray)


WHOLE = LookupEffects(Correction.ORIENTED_BOX, None, steps=64, refinements=12)
TABLE = Block((0.6, -0.5, -1.4), (1.8, 0.7, -0.6))


def test_in_an_empty_room_it_is_the_box(rng) -> None:
    at, ray = floor_rays(rng, 4000)
    spec = room_spec(capture=(0.5, -0.3, 0.2))
    picture = captured([], spec.capture_point)
    box = found(LookupEffects(Correction.ORIENTED_BOX, None), inputs(spec, at, ray), picture)["Direction"]
    angle = np.linalg.norm(unit(found(WHOLE, inputs(spec, at, ray), picture)["Direction"]) - unit(box), axis=-1)
    assert np.percentile(angle, 97) < 1e-4  # edges of the room are rounded off by texels
    assert angle.max() < 2.0 * np.pi / ROWS


def exact_direction(spec: ProbeSpec, at: np.ndarray, ray: np.ndarray, blocks: list[Block]) -> np.ndarray:
    far = np.minimum.reduce([to_walls(at, ray), *(block.distance(at, ray) for block in blocks)])
    return at + ray * far[:, None] - spec.capture_point


def is_seen(spec: ProbeSpec, point: np.ndarray, blocks: list[Block]) -> np.ndarray:
    """Which points (n, 3) on surfaces nothing hides from the capture point."""
    way = point - spec.capture_point
    length = np.linalg.norm(way, axis=-1)
    ray, start = way / length[:, None], np.broadcast_to(spec.capture_point, way.shape)
    return np.minimum.reduce([block.distance(start, ray) for block in blocks]) > length - 1e-6


@pytest.mark.parametrize("correction", [Correction.ALIGNED_BOX, Correction.TURNED_BOX, Correction.ORIENTED_BOX])
def test_rays_meet_what_stands_in_the_room(rng, correction) -> None:
    """All that leave from what the capture point sees, pass nothing hidden, and end on what it sees."""
    turn = 0.0 if correction is Correction.ALIGNED_BOX else 0.4
    spec = room_spec(turn, capture=(-0.8, 0.2, 0.4))
    at, ray = floor_rays(rng, 20000, [TABLE])
    local = np.array([-0.8, 0.2, 0.4])
    plain = room_spec(capture=(-0.8, 0.2, 0.4))
    meets = np.isfinite(TABLE.distance(at, ray))
    way = exact_direction(plain, at, ray, [TABLE])
    sees = is_seen(plain, at, [TABLE]) & is_seen(plain, local + way * (1.0 - 1e-4), [TABLE])
    at, ray, way = (a[meets & sees] for a in (at, ray, way))
    assert len(at) > 200
    world = turned(turn).T
    picture = captured([TABLE], local, turn=turn)
    effects = LookupEffects(correction, None, steps=64, refinements=12)
    shown = unit(found(effects, inputs(spec, at @ world, ray @ world), picture)["Direction"])
    off = np.linalg.norm(shown - unit(way @ world), axis=-1)
    box = unit(found(LookupEffects(correction, None), inputs(spec, at @ world, ray @ world), picture)["Direction"])
    off_box = np.linalg.norm(box - unit(way @ world), axis=-1)
    assert np.median(off) < 2e-3 < 0.1 < np.median(off_box)
    assert np.percentile(off, 95) < 0.02  # the last ones graze an edge


def test_more_steps_and_refinements_come_nearer(rng) -> None:
    spec = room_spec(capture=(-0.8, 0.2, 0.4))
    at, ray = floor_rays(rng, 20000, [TABLE])
    way = exact_direction(spec, at, ray, [TABLE])
    hits = np.isfinite(TABLE.distance(at, ray)) & is_seen(spec, at, [TABLE])
    hits &= is_seen(spec, spec.capture_point + way * (1.0 - 1e-4), [TABLE])
    at, ray, way = (a[hits] for a in (at, ray, way))
    picture = captured([TABLE], spec.capture_point)

    def off(steps: int, refinements: int) -> float:
        effects = LookupEffects(Correction.ORIENTED_BOX, None, steps=steps, refinements=refinements)
        shown = found(effects, inputs(spec, at, ray), picture)["Direction"]
        return float(np.minimum(np.linalg.norm(unit(shown) - unit(way), axis=-1), 0.1).mean())

    assert off(16, 0) > 1.5 * off(16, 2) > 1.2 * off(16, 6)
    assert off(3, 6) > 1.1 * off(12, 6) > off(32, 6)


def test_what_hides_nothing_on_the_way_is_passed(rng) -> None:
    """Rays that stay before all that was captured end on the box exactly: no hole, no false edge."""
    spec = room_spec(capture=(-0.8, 0.2, 0.4))
    at, ray = floor_rays(rng, 20000, [TABLE])
    picture = captured([TABLE], spec.capture_point)
    length = to_walls(at, ray)
    places = np.linspace(0.0, 0.999, 200)
    points = at + ray * (length[:, None] * places[:, None, None])
    clear = np.all([is_seen(spec, p, [TABLE]) for p in points], 0)
    at, ray = at[clear], ray[clear]
    assert len(at) > 5000
    shown = unit(found(WHOLE, inputs(spec, at, ray), picture)["Direction"])
    box = unit(found(LookupEffects(Correction.ORIENTED_BOX, None), inputs(spec, at, ray), picture)["Direction"])
    off = np.linalg.norm(shown - box, axis=-1)
    assert np.percentile(off, 99) < 1e-3 and (off > 0.05).mean() < 2e-3  # whose way grazes the table by a texel


def test_what_starts_behind_something_comes_out_first(rng) -> None:
    spec = room_spec(capture=(-2.0, 0.0, 0.4))
    wall = Block((0.0, -1.0, -1.4), (0.1, 1.0, 0.2))
    at = np.array([[0.5, 0.0, -1.4]])
    away = unit(np.array([[1.0, 0.0, 0.5]]))
    picture = captured([wall], spec.capture_point)
    box = found(LookupEffects(Correction.ORIENTED_BOX, None), inputs(spec, at, away), picture)["Direction"]
    assert np.allclose(found(WHOLE, inputs(spec, at, away), picture)["Direction"], box), "it never comes out"


@pytest.mark.parametrize("outside", [None, *Outside])
@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), dtype=st.sampled_from([np.float32, np.float64]), far=st.sampled_from([0, 1e4]))
def test_nothing_is_undefined_wherever_it_starts(outside, seed, dtype, far) -> None:
    """On walls, looking out, in corners, at and towards the capture point, far from the origin, through holes."""
    rng = np.random.default_rng(seed)
    spec = room_spec(rng.uniform(0, 7), rng.uniform(-far, far, 3), rng.uniform(-0.5, 0.5, 3))
    local = rng.uniform(-1.2, 1.2, (64, 3))
    local = np.where(rng.random((64, 3)) < 0.3, np.sign(local), local)
    at = spec.box.centre + local @ spec.box.axes.T
    at[:4] = spec.capture_point
    ray = unit(rng.normal(size=(64, 3)))
    ray[4:12] = unit(spec.capture_point - at[4:12])
    ray[12:20] = np.eye(3)[rng.integers(0, 3, 8)] * rng.choice([-1.0, 1.0], (8, 1))
    picture = captured([TABLE], (0.0, 0.0, 0.0), 16) * rng.choice([0.0, 1.0, 1e6], (16, 32, 1)).astype(np.float32)
    effects = LookupEffects(Correction.ORIENTED_BOX, outside, steps=5, refinements=3, hardening=True)
    shown = found(effects, inputs(spec, at, ray), picture, dtype)
    for name, value in shown.items():
        assert np.isfinite(value).all(), name
    assert ((shown["Weight"] >= 0.0) & (shown["Weight"] <= 1.0)).all()
    if outside is Outside.UNCORRECTED:
        assert (np.linalg.norm(shown["Direction"], axis=-1) <= 1.0 + 1e-5).all()


def test_it_does_not_swim(rng) -> None:
    """A little to the side something a little to the side is seen, but for rays at the edge of something."""
    spec = room_spec(capture=(-0.8, 0.2, 0.4))
    at, ray = floor_rays(rng, 20000, [TABLE])
    picture = captured([TABLE], spec.capture_point)
    effects = LookupEffects(Correction.ORIENTED_BOX, None, steps=12, refinements=8)

    def shown(by: float) -> np.ndarray:
        return unit(found(effects, inputs(spec, at + np.array([by, 0.0, 0.0]), ray), picture, np.float32)["Direction"])

    still = shown(0.0)
    one, ten = (np.linalg.norm(shown(by) - still, axis=-1) for by in (1e-4, 1e-3))
    assert np.median(one) < 1e-4 and np.percentile(one, 98) < 1e-3, "what moves by 0.1 mm"
    assert (one > 0.01).mean() < 0.25 * (ten > 0.01).mean() + 1e-3, "jumps are in proportion to the way"


def test_its_places_begin_near_the_start_and_end_on_the_wall() -> None:
    for steps in (2, 12, 64):
        places = relief.places(steps)
        assert len(places) == steps and places[-1] == 1.0 and 0.0 < places[0] <= 1.0 / steps
        assert (np.diff(places) > 0.0).all()


def test_departure_is_that_of_what_stands_before_the_walls() -> None:
    spec = room_spec(0.3, (5.0, 1.0, 0.0), (0.2, 0.1, 0.3), resolution=32)
    walls = nearness.of_walls(spec)
    assert relief.departure(walls, walls) == 0.0
    assert relief.departure(walls * np.float32(1.0 + 1e-3), walls) == pytest.approx(1e-3, rel=1e-3)
    nearer = walls.copy()
    nearer[20, 7] *= 2.0
    assert relief.departure(nearer, walls) == pytest.approx(1.0)
    open_wall = walls.copy()
    open_wall[20, 7] = 0.0
    assert relief.departure(open_wall, walls) == pytest.approx(1.0)


@pytest.mark.parametrize("offset", [(0.0, 0.0, 1.4), (0.0, 0.0, 9.0), (4.0, 3.0, 1.4)])
def test_departure_is_finite_where_the_capture_point_is_not_in_the_box(offset) -> None:
    spec = room_spec(capture=offset, resolution=16)
    far = relief.departure(np.full((32, 64), 0.3, np.float32), nearness.of_walls(spec))
    assert relief.DEPARTS < far <= 1e6


def test_walls_are_as_near_as_geometry_says() -> None:
    spec = room_spec(capture=(0.5, -0.3, 0.2))
    ways = equirect.directions(32, 16).reshape(-1, 3)
    expected = 1.0 / to_walls(np.broadcast_to(spec.capture_point, ways.shape), ways)
    np.testing.assert_allclose(nearness.along(spec, ways), expected, rtol=1e-12)
    np.testing.assert_allclose(nearness.along(spec, 3.0 * ways), expected, rtol=1e-12)


def seen(spec: ProbeSpec, at: np.ndarray, ray: np.ndarray, picture: np.ndarray) -> np.ndarray:
    effects = LookupEffects(Correction.ORIENTED_BOX, None, steps=64, refinements=12)
    return found(effects, inputs(spec, at, ray), picture)["Seen"]


def test_it_knows_what_the_capture_point_cannot_see() -> None:
    """A wall stands between: rays before it are seen, those that start or end behind it are not."""
    spec = room_spec(capture=(-2.0, 0.0, 0.0))
    wall = Block((0.0, -3.0, -1.4), (0.1, 3.0, 0.7))
    picture = captured([wall], spec.capture_point)
    up, along = (0.0, 0.0, 1.0), unit(np.array([1.0, 0.0, 0.2]))
    at = np.array([[-1.0, 0.0, -1.4], [1.0, 0.0, -1.4], [-1.0, 0.0, -1.4]])
    assert np.allclose(seen(spec, at, np.array([up, up, along]), picture), [1.0, 0.0, 1.0], atol=1e-3)


@pytest.mark.sweep
@pytest.mark.parametrize(("steps", "refinements"), [(8, 3), (12, 4), (24, 6), (64, 12)])
@pytest.mark.parametrize("rows", [256, 512])
def test_what_passes_behind_an_edge_is_seen_nowhere_along_it(rng, steps, refinements, rows) -> None:
    """Between two texels of an edge a ray seems to meet something; a second probe must be asked all the same."""
    spec = room_spec(capture=(-2.0, 0.4, 0.3))
    at, ray = floor_rays(rng, 20000, [TABLE])
    way = exact_direction(spec, at, ray, [TABLE])
    starts, ends = is_seen(spec, at, [TABLE]), is_seen(spec, spec.capture_point + way * (1.0 - 1e-4), [TABLE])
    passes = starts & ~ends & np.isfinite(TABLE.distance(np.broadcast_to(spec.capture_point, way.shape), unit(way)))
    deep = passes & np.array([_hidden_by(spec, point) for point in spec.capture_point + way])
    effects = LookupEffects(Correction.ORIENTED_BOX, None, steps=steps, refinements=refinements)
    picture = captured([TABLE], spec.capture_point, rows=rows)
    shown = found(effects, inputs(spec, at, ray), picture)["Seen"].ravel()
    assert deep.sum() > 200 and shown[deep].mean() < 0.05
    assert shown[starts & ends].mean() > 0.9  # some pass behind the table on their way


def _hidden_by(spec: ProbeSpec, point: np.ndarray) -> bool:
    """Whether a point is a quarter farther from the capture point than what hides it."""
    way = point - spec.capture_point
    length = np.linalg.norm(way)
    return bool(1.25 * TABLE.distance(spec.capture_point[None], way[None] / length)[0] < length)


@settings(max_examples=200, deadline=None)
@given(*[st.floats(0.0, 1.0)] * 4)
def test_a_probe_yields_only_to_what_sees_better(weight, sees, before, coverage) -> None:
    values = {"Weight": weight, "Seen": sees, "Seen Before": before, "Coverage": coverage}
    left = float(evaluate(choice.YIELDING.outputs, {k: np.array(v) for k, v in values.items()}, np.float64)["Weight"])
    assert 0.0 <= left <= weight
    if sees == 1.0 or before == 0.0 or coverage == 0.0:
        assert left == weight
    # What it gives up is covered by those before it, so that no more of the surface's own lobe is seen.
    assert (
        left + coverage * (1.0 - left)
        >= weight + coverage * (1.0 - weight) - (weight - left) * (1.0 - coverage) - 1e-12
    )


def test_two_probes_show_what_each_of_them_sees() -> None:
    values = {"Seen": np.array([1.0, 0.0]), "Seen Before": np.array([0.0, 1.0]), "Share": np.array([1.0, 0.0])}
    assert evaluate(choice.SEEN_BY_BOTH.outputs, values, np.float64)["Seen"].tolist() == [1.0, 1.0]
