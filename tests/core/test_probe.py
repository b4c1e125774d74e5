"""Probes as data: boxes from matrices, capture points, what is refused and how it says so."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.errors import PccError, ProbeError
from pcc_addon.core.lookup_plan import Receivers, lookup_effects
from pcc_addon.core.probe import MAXIMUM_RESOLUTION, MINIMUM_RESOLUTION, Box, ProbeSpec

from . import boxes

KINDS = pytest.mark.parametrize("kind", boxes.KINDS)


def random_box(kind: str, seed: int) -> tuple[np.ndarray, Box]:
    m = boxes.matrix(kind, np.random.default_rng(seed))
    return m, Box.from_matrix("Hall", m)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.diag([1.0, 0.0, 1.0, 1.0]), "zero size along Y"),
        (np.diag([0.0, 1.0, 0.0, 1.0]), "zero size along X, Z"),
        (np.diag([1.0, np.nan, 1.0, 1.0]), "not finite"),
        (np.diag([1.0, np.inf, 1.0, 1.0]), "not finite"),
        (np.array([[1, 1, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), "flatten its box"),
        (np.array([[1, 0, 1, 0], [0, 1, 1, 0], [0, 0, 0, 0], [0, 0, 0, 1]]), "flatten its box"),
        (np.array([[1, 1, 1, 0], [2, 2, 3, 0], [3, 3, 1, 0], [0, 0, 0, 1]]), "flatten its box"),
    ],
)
def test_a_box_without_volume_is_refused_by_name(matrix: np.ndarray, message: str) -> None:
    with pytest.raises(ProbeError, match=f"probe 'Hall': .*{message}") as caught:
        Box.from_matrix("Hall", matrix)
    text = str(caught.value)
    assert isinstance(caught.value, PccError)
    assert ";" in text, "what is wrong; what to do"
    assert "\n" not in text


def test_a_translation_that_is_not_finite_is_refused() -> None:
    m = np.eye(4)
    m[0, 3] = np.nan
    with pytest.raises(ProbeError, match="not finite"):
        Box.from_matrix("Hall", m)


@pytest.mark.parametrize("scale", [1e-5, 1.0, 1e5])
@KINDS
def test_any_box_with_volume_is_accepted_whatever_its_size(kind: str, scale: float) -> None:
    m, _ = random_box(kind, 1)
    m[:3, :3] *= scale
    m[:3, 0] *= 1e-3  # a flat mirror's probe is not flattened
    box = Box.from_matrix("Hall", m)
    np.testing.assert_array_equal(box.axes, m[:3, :3])
    np.testing.assert_array_equal(box.centre, m[:3, 3])


@KINDS
def test_a_walk_along_a_half_edge_ends_on_its_face_and_stays_between_the_others(kind: str) -> None:
    m, box = random_box(kind, 2)
    np.testing.assert_allclose(np.linalg.norm(box.face_normals, axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(box.coordinates(m[:3, 3] + m[:3, :3].T), np.diag(box.half_widths), atol=1e-12)
    if kind != "sheared":
        np.testing.assert_allclose(box.half_widths, box.half_extents)


@KINDS
def test_half_extents_are_the_lengths_of_the_half_edges(kind: str) -> None:
    m, box = random_box(kind, 3)
    wall_centres = (m @ np.vstack([np.eye(3), np.ones(3)]))[:3]
    np.testing.assert_allclose(box.half_extents, np.sqrt(((wall_centres - m[:3, 3:]) ** 2).sum(0)))


def correction(axes: np.ndarray) -> Correction:
    m = np.eye(4)
    m[:3, :3] = axes
    return Box.from_matrix("Hall", m).correction


def test_boxes_are_aligned_only_along_the_worlds_axes_in_order() -> None:
    assert correction(np.diag([1.0, 2.0, 3.0])) is Correction.ALIGNED_BOX
    assert correction(np.diag([-1.0, 2.0, -3.0])) is Correction.ALIGNED_BOX
    assert correction(np.eye(3) + 1e-7 * np.eye(3, k=1)) is not Correction.ALIGNED_BOX, "it shows in a large room"
    for kind in ("rotated", "mirrored", "sheared"):
        assert random_box(kind, 4)[1].correction is Correction.ORIENTED_BOX


def test_boxes_are_turned_only_about_the_vertical_and_without_shear() -> None:
    half_extents = np.diag([4.0, 3.0, 0.5])
    for degrees in (-180, -90, -60, 10, 24, 45, 90, 135):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).astype(np.float32)
        assert correction(turn @ half_extents) is Correction.TURNED_BOX, "as Blender rounds it"
        assert correction(turn @ half_extents @ np.diag([-1.0, 1.0, 1.0])) is Correction.TURNED_BOX, "mirrored"
        assert correction(half_extents @ turn) is Correction.ORIENTED_BOX or degrees % 90 == 0, "sheared by a parent"
        lean = np.array([[1.0, 0.0, 1e-5], [0.0, 1.0, 0.0], [-1e-5, 0.0, 1.0]])
        assert correction(lean @ turn @ half_extents) is Correction.ORIENTED_BOX


@KINDS
def test_the_capture_point_lies_metres_along_the_boxs_own_axes(kind: str) -> None:
    m, box = random_box(kind, 5)
    for axis in range(3):
        for metres in (-0.25, 0.5):
            offset = tuple(metres if k == axis else 0.0 for k in range(3))
            moved = ProbeSpec("Hall", box, capture_offset=offset).capture_point - m[:3, 3]
            assert np.linalg.norm(moved) == pytest.approx(abs(metres))
            local = np.linalg.solve(m[:3, :3], moved)
            np.testing.assert_allclose(np.delete(local, axis), 0.0, atol=1e-12)
            assert np.sign(local[axis]) == np.sign(metres), "a mirrored axis takes the capture point with it"
    np.testing.assert_array_equal(ProbeSpec("Hall", box).capture_point, m[:3, 3])


def test_the_capture_point_of_a_turned_box_turns_with_it() -> None:
    m = np.array([[0.0, -2.0, 0.0, 10.0], [3.0, 0.0, 0.0, 20.0], [0.0, 0.0, 4.0, 30.0], [0.0, 0.0, 0.0, 1.0]])
    spec = ProbeSpec("Hall", Box.from_matrix("Hall", m), capture_offset=(1.0, 0.5, -0.25))
    np.testing.assert_allclose(spec.capture_point, [9.5, 21.0, 29.75])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"resolution": MINIMUM_RESOLUTION - 1}, f"between {MINIMUM_RESOLUTION} and {MAXIMUM_RESOLUTION}"),
        ({"resolution": MAXIMUM_RESOLUTION + 1}, f"between {MINIMUM_RESOLUTION} and {MAXIMUM_RESOLUTION}"),
        ({"samples": 0}, "at least 1"),
        ({"clip_start": 0.0}, "must be above 0"),
        ({"clip_start": -1.0}, "must be above 0"),
        ({"clip_start": 5.0, "clip_end": 5.0}, "below clip end 5 m"),
        ({"clip_start": float("nan")}, "must be above 0"),
        ({"clip_end": float("nan")}, "below clip end"),
        ({"capture_offset": (0.0, float("nan"), 0.0)}, "reset it"),
        ({"capture_offset": (float("inf"), 0.0, 0.0)}, "reset it"),
        ({"padding": -0.001}, "padding -0.001 m must be finite and not below 0"),
        ({"padding": float("inf")}, "padding inf m must be finite"),
        ({"padding": float("nan")}, "padding nan m must be finite"),
        ({"falloff": -1.0}, "falloff -1 m must be finite and not below 0"),
        ({"falloff": float(np.finfo(np.float32).max)}, "falloff .* must be finite"),
        ({"falloff": float("nan")}, "falloff nan m must be finite"),
    ],
)
def test_settings_that_cannot_be_baked_are_refused_by_name_with_a_remedy(change: dict, message: str) -> None:
    with pytest.raises(ProbeError, match=f"^probe 'Hall': .*{message}") as caught:
        ProbeSpec("Hall", Box.from_matrix("Hall", np.eye(4)), **change)
    assert "\n" not in str(caught.value)


def test_the_smallest_and_the_largest_settings_are_accepted() -> None:
    box = Box.from_matrix("Hall", np.eye(4))
    for resolution in (MINIMUM_RESOLUTION, MAXIMUM_RESOLUTION):
        ProbeSpec(
            "Hall", box, resolution=resolution, samples=1, clip_start=1e-6, clip_end=1e9, padding=0.0, falloff=0.0
        )


def test_specs_are_values_that_compare_hash_and_do_not_change() -> None:
    m, box = random_box("rotated", 6)
    one, same = ProbeSpec("Hall", box), ProbeSpec("Hall", Box.from_matrix("Hall", m.copy()))
    assert one == same
    assert hash(one) == hash(same)
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.samples = 3
    with pytest.raises(ProbeError):
        dataclasses.replace(one, samples=0)


def test_a_probe_calls_for_the_cheapest_correction_that_fits_its_box() -> None:
    for kind in boxes.KINDS:
        _, box = random_box(kind, 7)
        spec = ProbeSpec("Hall", box, outside=Outside.BLACK)
        expected = Correction.ALIGNED_BOX if kind == "unrotated" else Correction.ORIENTED_BOX
        aside = box.centre + 0.1
        fading, inside, watched = Receivers(False, False), Receivers(True, False), Receivers(True, True)
        assert lookup_effects(spec, fading, aside) == LookupEffects(expected, Outside.BLACK, True)
        assert lookup_effects(spec, inside, aside) == LookupEffects(expected, None, True)
        assert lookup_effects(spec, inside, spec.capture_point) == LookupEffects(expected, None, False)
        assert lookup_effects(spec, watched, aside) == LookupEffects(expected, Outside.BLACK, True, facing=True)
        assert lookup_effects(spec, Receivers(), aside) == LookupEffects(expected, Outside.BLACK, True, facing=True)
        assert lookup_effects(ProbeSpec("Hall", box, corrected=False), Receivers(), aside).correction is Correction.NONE


def test_far_from_the_origin_the_influence_grows_by_what_float32_cannot_tell() -> None:
    def widened(distance: float) -> float:
        m = np.eye(4)
        m[0, 3] = distance
        return ProbeSpec("Hall", Box.from_matrix("Hall", m), padding=0.01).influence_padding - 0.01

    assert 0.0 < widened(0.0) < 1e-5
    for distance in (1e3, 1e6):
        spacing = float(np.spacing(np.float32(distance)))
        assert spacing <= widened(distance) <= 10.0 * spacing


@given(
    kind=st.sampled_from(boxes.KINDS),
    seed=st.integers(0, 10_000),
    reach=st.floats(0.1, 3.0),
    padding=st.floats(0.0, 0.5),
    falloff=st.floats(0.0, 1.0),
    count=st.integers(1, 8),
)
def test_a_cloud_with_a_point_inside_the_influence_overlaps(
    kind: str, seed: int, reach: float, padding: float, falloff: float, count: int
) -> None:
    m, box = random_box(kind, seed)
    rng = np.random.default_rng(seed + 1)
    spec = ProbeSpec("Hall", box, padding=padding, falloff=falloff)
    corners = boxes.inside(m, count, rng, reach)
    shares = rng.dirichlet(np.ones(count), 20)
    within = shares @ corners  # points of the cloud's convex hull
    normals = {f"Face Normal {axis}": row for axis, row in zip("XYZ", box.face_normals, strict=True)}
    inputs = {
        "Half Widths": box.half_widths,
        "Padding": spec.influence_padding,
        "Falloff": spec.influence_falloff,
        **normals,
    }
    q = formula.along_face_normals(Correction.ORIENTED_BOX, formula.POSITION)
    weights = evaluate(
        {"w": formula.faded(formula.depth(q), formula.FALLOFF)},
        {"Position": np.vstack([corners, within]) - box.centre, **inputs},
        np.float64,
    )["w"]
    if (weights > 0.0).any():
        assert spec.overlaps(corners)


@KINDS
def test_a_cloud_around_the_whole_box_overlaps(kind: str) -> None:
    """None of its corners lies inside."""
    m, box = random_box(kind, 8)
    corners = m[:3, 3] + 10.0 * (np.indices((2, 2, 2)).reshape(3, 8).T * 2.0 - 1.0) @ m[:3, :3].T
    assert ProbeSpec("Hall", box).overlaps(corners)


@KINDS
def test_a_cloud_beyond_a_wall_does_not_overlap(kind: str) -> None:
    m, box = random_box(kind, 9)
    spec = ProbeSpec("Hall", box, padding=0.1, falloff=0.2)
    cloud = np.random.default_rng(10).uniform(-1.0, 1.0, (20, 3))
    for axis in range(3):
        for side in (-1.0, 1.0):
            local = cloud.copy()
            local[:, axis] = side * (1.0 + 0.301 / box.half_widths[axis] + np.abs(cloud[:, axis]))
            assert not spec.overlaps(m[:3, 3] + local @ m[:3, :3].T)
            local[0, axis] = side * (1.0 + 0.299 / box.half_widths[axis])
            assert spec.overlaps(m[:3, 3] + local @ m[:3, :3].T)
