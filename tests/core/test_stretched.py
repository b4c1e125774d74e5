"""A picture that was not captured in the box is stretched to it: against the box's own unit cube."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.lookup_plan import Receivers, lookup_effects
from pcc_addon.core.probe import Box, ProbeSpec, Source

from . import boxes
from .boxes import unit

INSIDE, ANY = Receivers(True, False), Receivers()


def turned(degrees: float, signs: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> np.ndarray:
    """A box of 6 × 4 × 3 m, turned about the vertical after it was mirrored."""
    a = np.radians(degrees)
    m = np.eye(4)
    m[:2, :2] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
    m[:3, :3] = m[:3, :3].round(15) @ np.diag(np.multiply(signs, (3.0, 2.0, 1.5)))
    m[:3, 3] = (3.0, -2.0, 1.5)
    return m


def matrices() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(3)
    found = {kind: boxes.matrix(kind, rng) for kind in boxes.KINDS}
    for degrees in (30.0, 90.0, 180.0, -135.0, 1e-7):
        found[f"turned by {degrees}"] = turned(degrees)
    for signs in ((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0), (-1.0, -1.0, 1.0), (-1.0, 1.0, -1.0)):
        found[f"mirrored {signs}"] = turned(0.0, signs)
        found[f"turned and mirrored {signs}"] = turned(40.0, signs)
    return found


BOXES = pytest.mark.parametrize("m", matrices().values(), ids=matrices().keys())


def spec_of(m: np.ndarray, **settings: object) -> ProbeSpec:
    return ProbeSpec("Hall", Box.from_matrix("Hall", m), source=Source.IMAGE, **settings)


def look(
    spec: ProbeSpec, effects: LookupEffects, points: np.ndarray, rays: np.ndarray, dtype: type = np.float64
) -> dict[str, np.ndarray]:
    box = spec.box
    inputs = {
        "Position": points,
        "Direction": rays,
        "Normal": rays,
        "Box Centre": box.centre,
        **{f"Face Normal {axis}": row for axis, row in zip("XYZ", box.face_normals, strict=True)},
        "Turn Mirror": box.turn_mirror,
        "Half Widths": box.half_widths,
        "Padding": 0.0,
        "Falloff": 0.5,
        "Boundary": spec.boundary,
    }
    return evaluate(formula.lookup(effects, formula.DIRECTION), inputs, dtype)


def through_unit_cube(m: np.ndarray, points: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Where rays from inside leave the cube [−1, 1]³ that the box is there: as the articles have it, o + t d."""
    inverse = np.linalg.inv(m)
    o, d = points @ inverse[:3, :3].T + inverse[:3, 3], rays @ inverse[:3, :3].T
    with np.errstate(divide="ignore"):
        t = np.maximum((-1.0 - o) / d, (1.0 - o) / d).min(-1)
    return o + t[:, None] * d


@BOXES
def test_a_stretched_picture_is_looked_up_where_the_ray_leaves_the_unit_cube(m: np.ndarray) -> None:
    rng = np.random.default_rng(5)
    points, rays = boxes.inside(m, 300, rng), boxes.directions(300, rng)
    hits = through_unit_cube(m, points, rays)
    np.testing.assert_allclose(np.abs(hits).max(-1), 1.0)
    spec = spec_of(m)
    for receivers in (INSIDE, ANY):
        effects = lookup_effects(spec, receivers, spec.capture_point, Source.IMAGE)
        found = look(spec, effects, points, rays)["Direction"]
        np.testing.assert_allclose(unit(found), unit(hits), atol=1e-9)


@BOXES
def test_every_correction_that_keeps_the_boxs_axes_agrees_with_the_general_one(m: np.ndarray) -> None:
    rng = np.random.default_rng(6)
    spec = spec_of(m, outside=Outside.UNCORRECTED)
    points, rays = boxes.inside(m, 200, rng, reach=1.3), boxes.directions(200, rng)
    effects = lookup_effects(spec, ANY, spec.capture_point, Source.IMAGE)
    general = LookupEffects(Correction.ORIENTED_BOX, Outside.UNCORRECTED, False, facing=True, stretched=True)
    assert effects.outside is Outside.UNCORRECTED and effects.stretched
    expected, found = (look(spec, e, points, rays)["Direction"] for e in (general, effects))
    np.testing.assert_allclose(unit(found), unit(expected), atol=1e-7)


@BOXES
def test_far_outside_and_without_correction_the_picture_is_turned_but_not_stretched(m: np.ndarray) -> None:
    rng = np.random.default_rng(7)
    rays = boxes.directions(100, rng)
    points = m[:3, 3] + 100.0 * boxes.directions(100, rng)
    turned_with_it = unit(rays @ spec_of(m).box.face_normals.T)
    outside = spec_of(m, outside=Outside.UNCORRECTED)
    classic = spec_of(m, corrected=False)
    for spec in (outside, classic):
        effects = lookup_effects(spec, ANY, spec.capture_point, Source.IMAGE)
        np.testing.assert_allclose(unit(look(spec, effects, points, rays)["Direction"]), turned_with_it, atol=1e-9)


def test_a_cube_along_the_worlds_axes_is_as_if_captured_from_its_centre() -> None:
    m = np.diag([2.0, 2.0, 2.0, 1.0])
    rng = np.random.default_rng(8)
    points, rays = boxes.inside(m, 100, rng), boxes.directions(100, rng)
    spec = spec_of(m)
    found = look(spec, LookupEffects(Correction.ALIGNED_BOX, None, False, stretched=True), points, rays)["Direction"]
    captured = look(spec, LookupEffects(Correction.ALIGNED_BOX, None, False), points, rays)["Direction"]
    np.testing.assert_allclose(found, captured, rtol=1e-12)


def test_the_articles_scale_is_what_multiplies_the_direction() -> None:
    """min(size) / size by axis."""
    inputs = {"Half Widths": np.array([3.0, 1.0, 2.0])}
    found = evaluate({"s": formula.stretch(Correction.ALIGNED_BOX)}, inputs)["s"]
    np.testing.assert_allclose(found, [1.0 / 3.0, 1.0, 0.5], rtol=1e-6)
    mirrored = evaluate({"s": formula.stretch(Correction.TURNED_BOX)}, inputs)["s"]
    np.testing.assert_allclose(mirrored, [1.0 / 3.0, -1.0, 0.5], rtol=1e-6)


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1e3, 1e6])
def test_boxes_of_any_size_and_shape_give_finite_directions(size: float) -> None:
    rng = np.random.default_rng(9)
    m = np.diag([size, 1.0, 1.0 / size, 1.0])
    spec = spec_of(m)
    points = np.concatenate([boxes.inside(m, 200, rng, 1.0), boxes.directions(50, rng) * 1e6])
    for outside in (None, Outside.UNCORRECTED, Outside.OWN):
        effects = LookupEffects(Correction.ORIENTED_BOX, outside, False, stretched=True)
        found = look(spec, effects, points, boxes.directions(250, rng), np.float32)["Direction"]
        assert np.isfinite(found).all() and found.any(-1).all()


def test_a_probe_calls_for_the_cheapest_lookup_that_keeps_its_axes() -> None:
    def correction(m: np.ndarray) -> Correction:
        spec = spec_of(m)
        effects = lookup_effects(spec, INSIDE, (9.0, 9.0, 9.0), Source.IMAGE)
        assert effects.stretched and not effects.offset and effects.outside is None
        return effects.correction

    assert correction(turned(0.0)) is Correction.ALIGNED_BOX
    assert correction(turned(30.0)) is Correction.TURNED_BOX
    assert correction(turned(0.0, (-1.0, -1.0, 1.0))) is Correction.TURNED_BOX, "half a turn"
    for signs in ((-1.0, 1.0, 1.0), (1.0, 1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, -1.0)):
        assert correction(turned(0.0, signs)) is Correction.ORIENTED_BOX
        assert correction(turned(30.0, signs)) is Correction.ORIENTED_BOX
    assert correction(boxes.matrix("rotated", np.random.default_rng(1))) is Correction.ORIENTED_BOX


def test_what_a_picture_is_decides_and_not_what_the_next_will_be() -> None:
    spec = spec_of(turned(0.0), capture_offset=(0.5, 0.0, 0.0))
    np.testing.assert_array_equal(spec.capture_point, spec.box.centre)
    baked = lookup_effects(spec, INSIDE, (3.5, -2.0, 1.5), Source.BAKE)
    assert baked == LookupEffects(Correction.ALIGNED_BOX, None, offset=True)
    for source in (Source.IMAGE, Source.WORLD):
        assert lookup_effects(spec, INSIDE, (3.5, -2.0, 1.5), source).stretched


def test_an_animated_probe_is_ready_for_any_box() -> None:
    spec = spec_of(turned(0.0), animated=True)
    assert lookup_effects(spec, INSIDE, spec.capture_point, Source.IMAGE) == LookupEffects(
        Correction.ORIENTED_BOX, Outside.OWN, offset=False, facing=True, stretched=True
    )
    classic = spec_of(turned(0.0), animated=True, corrected=False)
    assert lookup_effects(classic, INSIDE, spec.capture_point, Source.IMAGE).stretched
    still = spec_of(turned(0.0), corrected=False)
    assert not lookup_effects(still, INSIDE, spec.capture_point, Source.IMAGE).stretched, "the world's axes are its own"


def test_titles_say_it() -> None:
    stretched = LookupEffects(Correction.ALIGNED_BOX, None, False, stretched=True)
    assert stretched.label == "aligned box, inside, centred, stretched"
    assert LookupEffects(Correction.NONE, None, False, stretched=True).label == "none, along the box's axes"
