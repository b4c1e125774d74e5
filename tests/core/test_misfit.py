"""How far a box is from a room: rooms of which that is known exactly."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.accuracy import colours, misfit_pictures, misfit_words
from pcc_addon.core.accuracy.misfit import Fit, Sightings, Viewers, at, misfit
from pcc_addon.core.accuracy.sequences import evenly, sphere
from pcc_addon.core.cubemap import CROSS, FACES
from pcc_addon.core.errors import ProbeError
from pcc_addon.core.probe import Source
from tests.core import boxes
from tests.core.triangle_rooms import RESOLUTION, cuboid, rectangle, scene, spec_of, surveyed

HALF, CENTRE, TURN = (3.0, 2.5, 1.4), (10.0, -7.0, 1.4), 0.4
NOBODY = Sightings(np.zeros((0, 3)), ())


def matrix(half: tuple[float, float, float] = HALF) -> np.ndarray:
    c, s = np.cos(TURN), np.sin(TURN)
    m = np.eye(4)
    m[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) * half
    m[:3, 3] = CENTRE
    return m


def found(half: tuple[float, float, float] = HALF, **meshes: object):
    """The misfit of a box in a room of `HALF` with some meshes in it."""
    spec = spec_of(matrix(half), capture_offset=(0.3, -0.2, 0.1))
    triangles = scene(spec.capture_point, Room=cuboid(CENTRE, HALF, TURN), **meshes)
    return misfit(spec, surveyed(spec, triangles))


@pytest.mark.parametrize("kind", boxes.KINDS)
def test_an_empty_room_fits_at_its_edges_too(kind: str) -> None:
    m = boxes.matrix(kind, np.random.default_rng(5))
    spec = spec_of(m, capture_offset=(0.1, -0.05, 0.07))
    corners, vertices = cuboid((0, 0, 0), (1, 1, 1))
    room = (corners @ m[:3, :3].T + m[:3, 3], vertices)
    fit = misfit(spec, surveyed(spec, scene(spec.capture_point, Room=room)))
    assert np.abs(fit.offsets).max() < 1e-4 and fit.angles.max() < 1e-4
    assert fit.share(Fit.ON).share == pytest.approx(1.0)
    assert list(misfit_words.lines(fit, NOBODY)) == ["The box is on what is seen, within 1 cm, in 100 % of directions"]


@pytest.mark.parametrize("more", [0.1, -0.1])
def test_a_box_of_another_size_is_off_by_that_along_its_axes(more: float) -> None:
    fit = found(tuple(h + more for h in HALF))
    axes = fit.spec.box.face_normals
    for way in (*axes, *-axes):
        assert at(fit.offsets, way) == pytest.approx(-more, rel=2e-3)
    missed = Fit.BEFORE if more > 0 else Fit.BEYOND
    assert fit.share(missed).share == pytest.approx(1.0)
    [first, second] = misfit_words.lines(fit, NOBODY)
    assert "in 0 % of directions" in first and f"cm {missed.value} the box in 100 % of directions" in second


def test_a_thing_in_the_room_has_the_solid_angle_and_the_distance_that_it_has() -> None:
    spec = spec_of(matrix())
    table = rectangle((*CENTRE[:2], 0.7), (0.5, 0, 0), (0, 0.5, 0))
    fit = misfit(spec, surveyed(spec, scene(spec.capture_point, Room=cuboid(CENTRE, HALF, TURN), Table=table)))
    before = fit.share(Fit.BEFORE)
    a, d = 0.5, 0.7  # a square of half side a at depth d
    assert 4.0 * np.pi * before.share == pytest.approx(
        4.0 * np.arcsin(a * a / (a * a + d * d)), rel=0.05
    )  # half a texel
    assert at(fit.offsets, np.array([0.0, 0.0, -1.0])) == pytest.approx(-0.7, rel=1e-3)
    assert fit.share(Fit.BEYOND).share < 0.002 and fit.share(Fit.NOTHING).share == 0.0


def test_viewers_are_off_by_the_angle_that_a_drawing_gives() -> None:
    spec = spec_of(np.diag([2.0, 2.0, 2.0, 1.0]))
    sheet = rectangle((1.0, 0, 0), (0, 0.5, 0), (0, 0, 0.5))
    triangles = scene(spec.capture_point, Room=cuboid((0, 0, 0), (2, 2, 2)), Sheet=sheet)
    viewer = Viewers(np.array([[0.0, 1.0, 0.0]]))
    fit = misfit(spec, surveyed(spec, triangles), viewer)
    # From (0, 1) by way of (1, 0) the ray leaves the box at (2, −1).
    assert at(fit.angles, np.array([1.0, 0.0, 0.0])) == pytest.approx(np.arctan2(1.0, 2.0), abs=0.03)
    behind = misfit(spec, surveyed(spec, triangles), Viewers(viewer.points, np.array([[-1.0, 0.0, 0.0]])))
    assert at(behind.angles, np.array([1.0, 0.0, 0.0])) == 0.0


def test_where_nothing_is_the_world_is_off_by_the_way_to_the_viewer() -> None:
    spec = spec_of(np.diag([2.0, 2.0, 2.0, 1.0]))
    nothing = np.zeros((2 * RESOLUTION, 4 * RESOLUTION), np.float32)
    fit = misfit(spec, nothing, Viewers(np.array([[0.0, 1.0, 0.0]])))
    assert fit.share(Fit.NOTHING).share == pytest.approx(1.0) and np.isinf(fit.offsets).all()
    assert at(fit.angles, np.array([1.0, 0.0, 0.0])) == pytest.approx(np.arctan2(1.0, 2.0), abs=0.03)
    [_, last] = misfit_words.lines(fit, NOBODY)
    assert last.startswith("Nothing is there in 100 % of directions")
    assert misfit_pictures.scale_end(fit) == 0.01
    assert len(np.unique(misfit_pictures.all_around(fit)[0:2].reshape(-1, 3), axis=0)) == 1


def test_the_largest_troubles_are_named_first() -> None:
    fit = found(Table=cuboid((10.5, -7.2, 0.7), (0.8, 0.6, 0.05)), Stool=cuboid((9.0, -6.5, 0.2), (0.2, 0.2, 0.2)))
    ways = sphere(2000)
    down = at(fit.offsets, ways) < -0.01
    near = np.linalg.norm(
        fit.spec.capture_point + ways * at(fit.walls + fit.offsets, ways)[:, None] - (9, -6.5, 0.2), axis=-1
    )
    names = tuple("" if not d else "Stool" if n < 0.4 else "Table" for d, n in zip(down, near, strict=True))
    assert misfit_words.seen_there(fit, Sightings(ways, names), Fit.BEFORE) == ("Table", "Stool")
    [_, line, *_] = misfit_words.lines(fit, Sightings(ways, names))
    assert "before the box" in line and "('Table' and 'Stool')" in line


def test_a_picture_has_the_colours_of_its_metres_and_names_its_faces() -> None:
    fit = found(Table=cuboid((10.5, -7.2, 0.7), (0.8, 0.6, 0.05)))
    end = misfit_pictures.scale_end(fit)
    whole = misfit_pictures.all_around(fit)
    height, width = fit.offsets.shape
    row, column = np.unravel_index(fit.offsets.argmin(), fit.offsets.shape)
    expected = colours.as_bytes(misfit_pictures.coloured(fit.offsets[row, column], end))
    assert np.array_equal(whole[height - 1 - row, column], expected)
    unfolded = misfit_pictures.cross(fit)
    n = fit.spec.resolution
    assert unfolded.shape[1] == 4 * n and unfolded.shape[0] > 3 * n and whole.shape[1] == width
    assert (unfolded[: n - 1, : n - 1] == 24).all()  # no face lies there
    for face in FACES:
        c, r = CROSS[face.name]
        middle = unfolded[r * n + n // 2, c * n + n // 2]
        expected = colours.as_bytes(misfit_pictures.coloured(at(fit.offsets, np.array(face.forward, float)), end))
        assert np.abs(middle.astype(int) - expected).max() <= 40, face.name
        letters = unfolded[r * n : r * n + n // 3, c * n : c * n + n // 3] == 20
        assert letters.all(-1).sum() > 10, face.name


def test_faces_of_the_cross_that_touch_show_the_same_where_they_do() -> None:
    ways = {f.name: (np.array(f.forward), np.array(f.right), np.array(f.up)) for f in FACES}
    cells = {cell: name for name, cell in CROSS.items()}
    for (column, row), name in cells.items():
        _, right, up = ways[name]
        if (column + 1, row) in cells:
            assert np.array_equal(ways[cells[column + 1, row]][0], right) and np.array_equal(
                ways[cells[column + 1, row]][2], up
            )
        if (column, row + 1) in cells:
            assert np.array_equal(ways[cells[column, row + 1]][0], -up)
            assert np.array_equal(ways[cells[column, row + 1]][1], right)


def test_probes_that_cannot_be_compared_are_refused() -> None:
    outside = spec_of(matrix(), capture_offset=(4.0, 0.0, 0.0))
    with pytest.raises(ProbeError, match="not inside its box"):
        misfit(outside, np.zeros((2 * RESOLUTION, 4 * RESOLUTION)))
    with pytest.raises(ProbeError, match="from elsewhere"):
        misfit(spec_of(matrix(), source=Source.WORLD), np.zeros((2 * RESOLUTION, 4 * RESOLUTION)))
    with pytest.raises(ValueError, match="128×256"):
        misfit(spec_of(matrix()), np.zeros((4, 8)))


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_sequences_are_even(dimensions: int) -> None:
    points = evenly(4000, dimensions)
    assert points.min() >= 0.0 and points.max() < 1.0
    counts = np.histogramdd(points, [np.linspace(0, 1, 5)] * dimensions)[0]
    assert np.ptp(counts) <= 0.35 * counts.mean()
    assert np.abs(sphere(4000).mean(0)).max() < 1e-3


@pytest.mark.parametrize(
    ("metres", "words"), [(1.26, "1.3 m"), (0.99, "99 cm"), (0.04, "4 cm"), (0.0021, "2 mm"), (0.999, "1.0 m")]
)
def test_lengths_in_words(metres: float, words: str) -> None:
    assert misfit_words.length(metres) == words


@pytest.mark.parametrize(
    ("share", "words"),
    [
        (0.0, "0 %"),
        (1.0, "100 %"),
        (0.12, "12 %"),
        (0.0042, "0.4 %"),
        (1e-5, "less than 0.1 %"),
        (0.9999, "more than 99.9 %"),
        (0.995, "99.5 %"),
    ],
)
def test_shares_in_words(share: float, words: str) -> None:
    assert misfit_words.per_cent(share) == words


@pytest.mark.parametrize(("angle", "words"), [(112.3, "112°"), (9.97, "10°"), (0.42, "0.4°"), (0.0, "0.0°")])
def test_angles_in_words(angle: float, words: str) -> None:
    assert misfit_words.degrees(angle) == words


def test_what_is_nowhere_has_no_metres() -> None:
    spec = spec_of(np.diag([2.0, 2.0, 2.0, 1.0]))
    fit = misfit(spec, np.zeros((2 * RESOLUTION, 4 * RESOLUTION), np.float32))
    assert fit.share(Fit.NOTHING).metres == 0.0 and fit.degrees == pytest.approx(fit.share(Fit.NOTHING).degrees)
