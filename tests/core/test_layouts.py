"""Every layout of a cubemap, by marks that show where each direction ended: the OpenGL table is the reference."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest

from pcc_addon.core import equirect, layouts
from pcc_addon.core.errors import ProbeError
from pcc_addon.core.layouts import Layout
from pcc_addon.core.prefilter import shrink

# The OpenGL specification's table: from a direction r to a face, s to the right and t downwards in its picture.
TABLE = {
    "px": lambda s, t: (1.0 + 0.0 * s, -t, -s),
    "nx": lambda s, t: (-1.0 + 0.0 * s, -t, s),
    "py": lambda s, t: (s, 1.0 + 0.0 * s, t),
    "ny": lambda s, t: (s, -1.0 + 0.0 * s, -t),
    "pz": lambda s, t: (s, -t, 1.0 + 0.0 * s),
    "nz": lambda s, t: (-s, -t, -1.0 + 0.0 * s),
}
SKETCHES = {
    Layout.HORIZONTAL_CROSS: [". py . .", "nx pz px nz", ". ny . ."],
    Layout.VERTICAL_CROSS: [". py .", "nx pz px", ". ny .", ". zn ."],  # zn: nz on its head
    Layout.HORIZONTAL_STRIP: ["px nx py ny pz nz"],
    Layout.VERTICAL_STRIP: ["px", "nx", "py", "ny", "pz", "nz"],
}
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
FACES = np.concatenate([np.eye(3), -np.eye(3)])
WITH_FACES = pytest.mark.parametrize("layout", list(SKETCHES), ids=lambda layout: layout.words)


def colour(r: np.ndarray) -> np.ndarray:
    """A mark that no other direction of an engine's space has: red to the right, green up, blue ahead."""
    return r / np.linalg.norm(r, axis=-1, keepdims=True) * 0.5 + 0.5


def to_engine(d: np.ndarray) -> np.ndarray:
    """Blender's directions in an engine's space: Z is up there, Y is ahead."""
    return d[..., [0, 2, 1]]


def face(name: str, n: int) -> np.ndarray:
    """A marked face as its file holds it: the first row at the top."""
    at = (np.arange(n) + 0.5) * (2.0 / n) - 1.0
    s, t = np.meshgrid(at, at)
    return colour(np.stack(TABLE[name](s, t), -1)).astype(np.float32)


def sheet(layout: Layout, n: int) -> np.ndarray:
    """A marked cubemap in a layout, as Blender reads it: the first row at the bottom."""
    cells = {
        ".": np.full((n, n, 3), 7.0, np.float32),
        "zn": face("nz", n)[::-1, ::-1],
        **{f: face(f, n) for f in TABLE},
    }
    rows = [np.concatenate([cells[name] for name in row.split()], 1) for row in SKETCHES[layout]]
    return np.concatenate(rows)[::-1]


def check_marks(picture: np.ndarray, tolerance: float) -> None:
    """The marks at every corner and beside it, on every face and beside its middle; at poles half a texel is lost."""
    inward = CORNERS + 0.02 * np.roll(CORNERS, 1, 0)  # beside each corner, on one of its faces
    for d in (CORNERS, inward, FACES, FACES + 0.3 * np.roll(FACES, 1, 1) + 0.6 * np.roll(FACES, 2, 1)):
        np.testing.assert_allclose(equirect.lookup(picture, d), colour(to_engine(d)), atol=tolerance)


@WITH_FACES
def test_each_face_and_corner_is_where_it_belongs(layout: Layout) -> None:
    picture = layouts.from_picture(sheet(layout, 64), layout, 64)
    assert picture.shape == (128, 256, 3) and picture.dtype == np.float32
    check_marks(picture, 7e-3)


@WITH_FACES
def test_a_mirrored_a_turned_and_a_swapped_face_would_show(layout: Layout) -> None:
    def faulty(change) -> np.ndarray:
        faces = list(layouts.unfold(sheet(layout, 32), layout))
        return layouts.from_faces(change(faces), 32)

    for k in range(6):
        for turn in (lambda f: f[::-1], lambda f: f[:, ::-1], lambda f: f[::-1, ::-1], lambda f: f.swapaxes(0, 1)):
            with pytest.raises(AssertionError):
                check_marks(faulty(lambda faces, k=k, turn=turn: [*faces[:k], turn(faces[k]), *faces[k + 1 :]]), 0.05)
        with pytest.raises(AssertionError):
            check_marks(faulty(lambda faces, k=k: [*faces[k:], *faces[:k]] if k else faces[::-1]), 0.05)


@pytest.mark.parametrize("layout", [Layout.HORIZONTAL_CROSS, Layout.VERTICAL_CROSS], ids=lambda layout: layout.words)
def test_the_marked_crosses_are_ones_to_fold(layout: Layout) -> None:
    """Of the test itself: neighbours in a cross meet without a step, so that their marks are those of a real one."""
    n = 64
    whole = sheet(layout, n)[::-1]
    rows = [row.split() for row in SKETCHES[layout]]
    met = 0
    for r, c in itertools.product(range(layout.rows), range(layout.columns)):
        here = whole[r * n : (r + 1) * n, c * n : (c + 1) * n]
        if c + 1 < layout.columns and "." not in (rows[r][c], rows[r][c + 1]):
            np.testing.assert_allclose(here[:, -1], whole[r * n : (r + 1) * n, (c + 1) * n], atol=0.03)
            met += 1
        if r + 1 < layout.rows and "." not in (rows[r][c], rows[r + 1][c]):
            np.testing.assert_allclose(here[-1], whole[(r + 1) * n, c * n : (c + 1) * n], atol=0.03)
            met += 1
    assert met == 5, "as many edges as hold six faces together"


def test_six_pictures_are_taken_in_the_engines_order() -> None:
    pictures = [face(name, 32)[::-1] for name in ("px", "nx", "py", "ny", "pz", "nz")]
    faces = layouts.six_faces(pictures, list("abcdef"))
    check_marks(layouts.from_faces(faces, 32), 0.013)


def test_an_equirectangular_picture_looks_as_blenders_worlds_do() -> None:
    """Its middle is +X, its left quarter +Y, up is up."""
    d = equirect.directions(256, 128)
    picture = layouts.from_picture(colour(to_engine(d)).astype(np.float32), Layout.EQUIRECTANGULAR, 32)
    assert picture.shape == (64, 128, 3)
    check_marks(picture, 0.016)
    np.testing.assert_allclose(picture[32, 63:65].mean(0), colour(to_engine(np.array([1.0, 0.0, 0.0]))), atol=0.02)
    np.testing.assert_allclose(picture[32, 31:33].mean(0), colour(to_engine(np.array([0.0, 1.0, 0.0]))), atol=0.02)


def test_an_equirectangular_picture_of_the_right_size_stays_as_it_is() -> None:
    picture = np.random.default_rng(1).random((64, 128, 3), np.float32)
    np.testing.assert_array_equal(layouts.from_picture(picture, Layout.EQUIRECTANGULAR, 32), picture)


def test_a_larger_one_is_averaged_and_keeps_its_energy() -> None:
    """A single bright texel is neither lost nor doubled."""
    picture = np.zeros((192, 384, 3), np.float32)
    picture[101, 200], picture[3, 17], picture[191, 383] = 1000.0, 500.0, 200.0
    found = layouts.from_picture(picture, Layout.EQUIRECTANGULAR, 16)
    np.testing.assert_allclose(found, shrink(picture, 32), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("m", [5, 32, 48, 100, 257])
def test_faces_of_any_size_keep_constants_and_the_mean(m: int) -> None:
    rng = np.random.default_rng(m)
    constant = layouts.from_faces([np.full((m, m, 3), 0.7, np.float32)] * 6, 32)
    np.testing.assert_allclose(constant, 0.7, rtol=1e-6)
    faces = [rng.random((m, m, 3), np.float32) for _ in range(6)]
    at = (np.arange(m) + 0.5) * (2.0 / m) - 1.0
    share = (1.0 + at[:, None] ** 2 + at**2) ** -1.5
    truth = np.mean([(f * share[..., None]).sum((0, 1)) / share.sum() for f in faces], 0)
    picture = layouts.from_faces(faces, 32)
    weights = equirect.solid_angles(128, 64)
    found = (picture * weights[:, None, None]).sum((0, 1)) / (weights.sum() * 128)
    np.testing.assert_allclose(found, truth, atol=0.02)
    assert min(f.min() for f in faces) <= picture.min() and picture.max() <= max(f.max() for f in faces)


def test_there_is_no_seam_where_faces_without_borders_meet() -> None:
    """Of a smooth radiance, errors at edges are no larger than the texel's square elsewhere allows."""
    errors = []
    for n in (32, 64):
        picture = layouts.from_faces(layouts.unfold(sheet(Layout.HORIZONTAL_STRIP, n), Layout.HORIZONTAL_STRIP), n)
        truth = colour(to_engine(equirect.directions(4 * n, 2 * n)))
        errors.append(np.abs(picture - truth).max())
    assert errors[0] < 2e-3 and errors[1] < errors[0] / 3.0


@pytest.mark.parametrize(("width", "height", "layout"), [
    (2048, 1024, Layout.EQUIRECTANGULAR), (400, 300, Layout.HORIZONTAL_CROSS), (300, 400, Layout.VERTICAL_CROSS),
    (600, 100, Layout.HORIZONTAL_STRIP), (7, 42, Layout.VERTICAL_STRIP), (2, 1, Layout.EQUIRECTANGULAR),
])  # fmt: skip
def test_layouts_are_told_by_their_shapes(width: int, height: int, layout: Layout) -> None:
    assert layouts.layout_of("sky", width, height) is layout


@pytest.mark.parametrize(("width", "height", "hint"), [
    (600, 101, "as horizontal strip its squares would be 100×101 pixels"),
    (400, 301, "as horizontal cross its squares would be 100×100.333 pixels"),
    (300, 399, "as vertical cross its squares would be 100×99.75 pixels"),
    (2048, 1025, "as equirectangular its squares would be 1024×1025 pixels"),
    (512, 512, None), (3, 2, None), (1000, 1, None), (1, 1000, None),
])  # fmt: skip
def test_what_is_no_layout_is_refused_with_its_size_and_what_is_accepted(width: int, height: int, hint: str) -> None:
    with pytest.raises(ProbeError) as caught:
        layouts.layout_of("sky.png", width, height)
    message = str(caught.value)
    assert message.startswith(f"picture 'sky.png': {width}×{height} pixels") and "\n" not in message
    assert ("squares would be" in message) == (hint is not None) and (hint or "") in message
    for words in ("equirectangular 2:1", "horizontal cross 4:3", "vertical cross 3:4", "strip 6:1", "strip 1:6", "six"):
        assert words in message


def test_six_faces_that_are_no_squares_or_of_several_sizes_are_refused() -> None:
    square = np.zeros((8, 8, 3), np.float32)
    names = ["px", "nx", "py", "ny", "pz", "nz"]
    with pytest.raises(ProbeError, match=re.escape("picture 'ny': 9×8 pixels is no square")):
        layouts.six_faces([*[square] * 3, np.zeros((8, 9, 3)), *[square] * 2], names)
    with pytest.raises(ProbeError, match=re.escape("picture 'nz': 4×4 pixels, but 'px' has 8×8")):
        layouts.six_faces([*[square] * 5, np.zeros((4, 4, 3))], names)
