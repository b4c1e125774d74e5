"""Which faces lookups can read: never another, by the real formula and its texels, and not simply all."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core import equirect, reach
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.cubemap import FACES
from pcc_addon.core.effects import lookup
from pcc_addon.core.effects.records import Correction, LookupEffects
from pcc_addon.core.prefilter import mixed_within, prefilter
from pcc_addon.core.probe import Box, ProbeSpec
from pcc_addon.core.reach import EVERY_FACE, Facets, reachable

from . import boxes
from .boxes import unit

NAMES = [face.name for face in FACES]


def facets(*rows: tuple[float, float, float, float]) -> Facets:
    """From normals and offsets."""
    table = np.array(rows, np.float64)
    return Facets(table[:, :3], table[:, 3])


def probe_in(matrix: np.ndarray, capture_point: np.ndarray, **settings: object) -> ProbeSpec:
    box = Box.from_matrix("Room", matrix)
    offset = (np.asarray(capture_point) - box.centre) @ np.linalg.inv(box.axes / box.half_extents).T
    return ProbeSpec("Room", box, tuple(float(c) for c in offset), **settings)


def room(x: float = 0.0, y: float = 0.0, z: float = 1.2) -> ProbeSpec:
    """A room of 5 × 4 × 2.5 m on z = 0, and where its picture is taken."""
    matrix = np.diag([2.5, 2.0, 1.25, 1.0])
    matrix[2, 3] = 1.25
    return probe_in(matrix, np.array([x, y, z]))


def missing(spec: ProbeSpec, *rows: tuple, beyond: float = 0.0, widening: float = mixed_within(1024, 0.0)) -> set[str]:
    return set(NAMES) - reachable(spec, spec.capture_point, facets(*rows), beyond, widening)


def lookups(
    spec: ProbeSpec, points: np.ndarray, incoming: np.ndarray, normal: np.ndarray, dtype: type = np.float64
) -> np.ndarray:
    """Directions that the shader's formula reads at points of a surface, off the poles of a picture."""
    box = spec.box
    inputs = {
        "Position": points,
        "Incoming": incoming,
        "Normal": np.broadcast_to(normal, points.shape),
        "Box Centre": box.centre,
        **{f"Face Normal {axis}": row for axis, row in zip("XYZ", box.face_normals, strict=True)},
        "Turn Mirror": box.turn_mirror,
        "Half Widths": box.half_widths,
        "Capture Point": spec.capture_point,
    }
    found = lookup.lookup(LookupEffects(box.correction, None, True), lookup.MIRRORED)
    direction = evaluate({"Direction": found["Direction"]}, inputs, dtype)["Direction"]
    given_now = {"Direction": direction, "Steepest": lookup.steepest_slope(HEIGHT)}
    return evaluate(lookup.OFF_POLES.outputs, given_now, dtype)["Direction"]


HEIGHT = 64


def faces_of_texels(directions: np.ndarray) -> set[str]:
    """The faces that made the four texels which a bilinear lookup of each direction mixes."""
    centres = equirect.directions(2 * HEIGHT, HEIGHT)
    u, v = equirect.coordinates(directions)
    column, row = (np.floor(c).astype(int) for c in (u * 2 * HEIGHT - 0.5, v * HEIGHT - 0.5))
    found = set()
    for right in (0, 1):
        for up in (0, 1):
            texels = centres[np.clip(row + up, 0, HEIGHT - 1), (column + right) % (2 * HEIGHT)]
            axis = np.abs(texels).argmax(-1)
            negative = np.take_along_axis(texels, axis[:, None], -1)[:, 0] < 0.0
            found |= set((2 * axis + negative).tolist())
    return {NAMES[k] for k in found}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@given(
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from(boxes.KINDS),
    far=st.sampled_from([0.0, 50.0, 4000.0]),
    wall=st.sampled_from([None, 0, 1, 2, 3, 4, 5]),
    size=st.sampled_from([1.0, 1.0, 1.2]),
)
def test_no_lookup_reads_another_face(
    dtype: type, seed: int, kind: str, far: float, wall: int | None, size: float
) -> None:
    """A flat surface somewhere in the box, reaching out of it too, or on one of its walls, seen from anywhere."""
    rng = np.random.default_rng(seed)
    m = boxes.matrix(kind, rng, (far + 3.0, -2.0, 1.5)).astype(np.float32).astype(np.float64)
    spec = probe_in(m, boxes.inside(m, 1, rng, 0.9)[0])
    points = boxes.inside(m, 400, rng, size)
    if wall is None:
        normal = unit(rng.normal(size=3))
        point = boxes.inside(m, 1, rng, 0.9)[0]
        points = points - np.outer((points - point) @ normal, normal)
        points = points[(np.abs(spec.box.coordinates(points)) <= size * spec.box.half_widths).all(1)]
    else:
        axis, end = wall % 3, 1.0 if wall < 3 else -1.0
        normal = -end * spec.box.face_normals[axis]
        steps = rng.uniform(-1.0, 1.0, (400, 3))
        steps[:, axis] = end
        points = m[:3, 3] + steps @ m[:3, :3].T
    if not len(points):
        return
    incoming = boxes.directions(len(points), rng)
    grazing = rng.random(len(points)) < 0.3
    incoming[grazing] = unit(incoming[grazing] - np.outer(incoming[grazing] @ normal * rng.uniform(0.9, 1.0), normal))
    incoming *= np.where(incoming @ normal < 0.0, -1.0, 1.0)[:, None]
    incoming = incoming[incoming @ normal > 1e-3]
    points = points[: len(incoming)]
    offset = float((points @ normal).min())
    beyond = max(float((np.abs(spec.box.coordinates(points)) - spec.box.half_widths).max()), 0.0)
    allowed = reachable(spec, spec.capture_point, facets((*normal, offset)), beyond, mixed_within(HEIGHT, 0.0))
    read = faces_of_texels(lookups(spec, points, incoming, normal, dtype))
    assert read <= allowed


@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(boxes.KINDS))
def test_what_is_said_is_what_the_walls_show(seed: int, kind: str) -> None:
    """Against many points of the walls: what is clearly above a surface is reachable, what is clearly below is not."""
    rng = np.random.default_rng(seed)
    m = boxes.matrix(kind, rng)
    spec = probe_in(m, boxes.inside(m, 1, rng, 0.8)[0])
    normal = unit(rng.normal(size=3))
    offset = float(boxes.inside(m, 1, rng, 0.9)[0] @ normal)
    grid = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 60)] * 2), -1).reshape(-1, 2)
    walls = [np.insert(grid, axis, end, 1) for axis in range(3) for end in (-1.0, 1.0)]
    points = m[:3, 3] + np.concatenate(walls) @ m[:3, :3].T
    way = points - spec.capture_point
    axis = np.abs(way).argmax(-1)
    index = 2 * axis + (np.take_along_axis(way, axis[:, None], -1)[:, 0] < 0.0)
    heights = {NAMES[k]: (points[index == k] @ normal).max() for k in range(6) if (index == k).any()}
    found = reachable(spec, spec.capture_point, facets((*normal, offset)), 0.0, 0.0)
    step = 0.05 * float(np.linalg.norm(spec.box.half_extents))
    assert {name for name, height in heights.items() if height > offset} <= found
    assert not found & {name for name, height in heights.items() if height < offset - step}


@given(st.integers(0, 2**32 - 1))
def test_more_is_reached_the_wider_texels_are_mixed_and_the_farther_surfaces_reach_out(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = boxes.matrix("sheared", rng)
    spec = probe_in(m, boxes.inside(m, 1, rng, 0.8)[0])
    normal = unit(rng.normal(size=3))
    facet = facets((*normal, float(boxes.inside(m, 1, rng, 0.9)[0] @ normal)))
    widenings = [reachable(spec, spec.capture_point, facet, 0.0, w) for w in (0.0, 0.1, 0.3, 0.55, 0.7)]
    reaching = [reachable(spec, spec.capture_point, facet, beyond, 0.0) for beyond in (0.0, 0.1, 1.0)]
    for chain in (widenings, reaching):
        assert all(less <= more for less, more in itertools.pairwise(chain))
    assert widenings[-1] == EVERY_FACE


FLOOR = [(0.0, 0.0, 1.0, 0.0), (0.0, 0.0, -1.0, 0.0)]
TABLE = (0.0, 0.0, 1.0, 0.7)
BALL = [(*map(float, normal), 0.0) for normal in unit(np.array(list(np.ndindex(3, 3, 3))) - 1.0) if normal.any()]


def test_a_mirror_on_the_floor_never_shows_what_is_below() -> None:
    assert missing(room(), *FLOOR) == {"-Z"}


def test_sharp_levels_spare_it_too_and_blurred_ones_do_not() -> None:
    assert missing(room(), *FLOOR, widening=mixed_within(1024, 0.05)) == {"-Z"}
    assert missing(room(), *FLOOR, widening=mixed_within(1024, 0.1)) == set()
    assert missing(room(), *FLOOR, widening=mixed_within(32, 0.05)) == set(), "of small pictures texels are wide"


def test_near_a_wall_its_lower_part_is_seen_downwards() -> None:
    assert missing(room(x=1.4), *FLOOR) == set()
    assert missing(room(y=0.7, z=1.2), *FLOOR) == {"-Z"}
    assert missing(room(y=0.9, z=1.2), *FLOOR) == set()


def test_a_floor_of_tiles_at_several_heights_counts_from_the_lowest() -> None:
    assert missing(room(), *FLOOR, (0.0, 0.0, 1.0, 0.3)) == {"-Z"}
    assert missing(room(z=1.9), (0.0, 0.0, 1.0, 0.3)) == {"-Z"}
    assert missing(room(z=1.9), (0.0, 0.0, 1.0, 0.3), FLOOR[0]) == {"-Z"}
    assert missing(room(z=1.9), (0.0, 0.0, 1.0, -0.3), beyond=0.3) == set(), "what lies below the box looks past it"


def test_a_table_top_shows_the_floor_from_below_only() -> None:
    assert missing(room(), TABLE) == {"-Z"}
    assert missing(room(), TABLE, (0.0, 0.0, -1.0, -0.7)) == set()


def test_a_wall_mirror_shows_no_wall_behind_it_as_seen_from_near() -> None:
    mirror, its_back = (1.0, 0.0, 0.0, -2.5), (-1.0, 0.0, 0.0, 2.5)
    assert missing(room(x=-1.5), mirror, its_back) == {"-X"}
    assert missing(room(x=0.0), mirror, its_back) == set(), "−X holds parts of floor and ceiling there"


def test_a_mirror_that_stands_off_its_wall_is_seen_from_behind() -> None:
    mirror, its_back = (1.0, 0.0, 0.0, -2.4), (-1.0, 0.0, 0.0, 2.4)
    assert missing(room(x=-1.5), mirror) == {"-X"}
    assert missing(room(x=-1.5), mirror, its_back) == set()


def test_what_lies_on_a_wall_but_for_the_padding_shows_the_outside_with_its_back() -> None:
    for lift, spared in ((0.005, {"-Z"}), (-0.005, {"-Z"}), (0.05, set())):
        rows = [(0.0, 0.0, 1.0, lift), (0.0, 0.0, -1.0, -lift)]
        assert missing(room(), *rows, beyond=max(-lift, 0.0)) == spared


def test_a_ball_shows_everything() -> None:
    assert missing(room(), *BALL) == set()


def test_a_capture_point_on_or_beyond_a_wall_sees_any_way() -> None:
    for z in (0.0, -0.1, 2.5, 1e-7):
        assert missing(room(z=z), *FLOOR) == set()


def test_a_turned_room_has_its_faces_along_the_world() -> None:
    matrix = np.eye(4)
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    matrix[:3, :3] = turn @ np.diag([2.5, 2.0, 1.25])
    matrix[:3, 3] = (100.0, -50.0, 1.25)
    spec = probe_in(matrix, np.array([100.0, -50.0, 1.2]))
    assert spec.box.correction is Correction.TURNED_BOX
    assert missing(spec, *FLOOR) == {"-Z"}


@pytest.mark.parametrize("roughness", [0.0, 0.05, 0.1, 0.16])
@pytest.mark.parametrize("height", [64, 256])
def test_a_lookup_of_a_level_mixes_no_texel_farther_away(roughness: float, height: int) -> None:
    """A picture that is black near a direction is black there in its level."""
    rng = np.random.default_rng(3)
    texels = equirect.directions(2 * height, height)
    reach_of = mixed_within(height, roughness)
    near_pole = unit(np.array([[0.01, 0.02, 1.0], [-1.0, 0.001, -0.02], [0.3, -0.2, -1.0]]))
    for direction in [*boxes.directions(4, rng), *near_pole]:
        away = np.arccos(np.clip(texels @ direction, -1.0, 1.0))
        picture = np.where(away > reach_of, 1.0, 0.0)[..., None].repeat(3, -1)
        value = equirect.lookup(prefilter(picture, roughness), direction[None])
        assert value.max() < 1e-6
    assert reach_of < np.pi


def test_a_pyramid_holds_all_that_is_within_an_angle_of_a_face() -> None:
    rng = np.random.default_rng(5)
    edge = np.linspace(-1.0, 1.0, 41)
    rim = unit(np.array([(1.0, a, b) for a in edge for b in edge if max(abs(a), abs(b)) == 1.0]))
    for widening in (0.0, 0.05, 0.3, 0.6):
        aside = unit(np.cross(rim[:, None], boxes.directions(400, rng)))
        reached = rim[:, None] * np.cos(widening) + aside * np.sin(widening)
        opening = reach._opening(widening)
        assert opening is not None
        assert (np.abs(reached[..., 1:]) <= opening * reached[..., :1] * (1.0 + 1e-9)).all()
        assert np.abs(reached[..., 1:] / reached[..., :1]).max() > 0.97 * opening - 0.01
    assert reach._opening(0.63) is None and reach._opening(2.0) is None
