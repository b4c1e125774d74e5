"""What a probe's formula gives: its outputs, its pictures by policy, directions near the poles, and its titles."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside

ALL = [
    LookupEffects(correction, outside, offset, facing)
    for correction, outside, offset, facing in itertools.product(
        Correction, [*Outside, None], (True, False), (True, False)
    )
]
CORRECTED = [c for c in Correction if c is not Correction.NONE]
MIRRORED = {"Direction": lookup.MIRRORED, "Offset": (0.0, 0.0, 0.0)}
UP, DOWN = (1.0, 0.5, 0.25), (0.125, 2.0, 4.0)
SKY = np.concatenate([np.full((4, 16, 3), DOWN), np.full((4, 16, 3), UP)]).astype(np.float32)
AT = {
    "Incoming": np.array([0.0, 0.6, 0.8]),
    "Normal": np.array([0.0, 0.0, 1.0]),
    "Box Centre": np.zeros(3),
    **{f"Face Normal {axis}": row for axis, row in zip("XYZ", np.eye(3), strict=True)},
    "Turn Mirror": np.array([0.0, 1.0, 0.0]),
    "Half Widths": np.full(3, 2.0),
    "Capture Point": np.zeros(3),
    "Padding": 0.0,
    "Falloff": 1.0,
    "Boundary": 1e-6,
}


def test_titles_say_what_is_done() -> None:
    assert LookupEffects(Correction.NONE).label == "none"
    assert LookupEffects(Correction.ALIGNED_BOX, None, False).label == "aligned box, inside, centred"
    turned = LookupEffects(Correction.TURNED_BOX, Outside.OWN, True, facing=True)
    assert turned.label == "turned box, outside own, offset, seen from outside"
    assert LookupEffects(Correction.ORIENTED_BOX, Outside.BLACK).label == "oriented box, outside black, offset"
    labels = {effects.label for effects in ALL if effects.correction is not Correction.NONE}
    assert len(labels) == len(CORRECTED) * 4 * 2 * 2
    assert lookup.lookup_formula(turned).title == f"Lookup, {turned.label}"


def shown(effects: LookupEffects, x: float, *, shares: bool = False) -> dict[str, np.ndarray]:
    """What a probe shows at a point on the x axis, of a surface that looks up and reflects the upper half."""
    formula = lookup.probe(effects, {"Sharp": 8, "Blurred": 8}, MIRRORED, shares=shares)
    inputs = {**AT, "Position": np.array([[x, 0.0, 0.0]])}
    return evaluate(formula.outputs, inputs, pictures={"Sharp": SKY, "Blurred": 2.0 * SKY})


@pytest.mark.parametrize("correction", CORRECTED)
def test_inside_every_picture_is_read_and_the_weight_is_given_where_surfaces_keep_their_own_lobe(
    correction: Correction,
) -> None:
    for outside in (*Outside, None):
        found = shown(LookupEffects(correction, outside), 0.0)
        assert set(found) == {"Sharp", "Blurred"} | ({"Weight"} if outside is Outside.OWN else set())
        np.testing.assert_allclose(found["Sharp"], [UP], rtol=1e-6)
        np.testing.assert_allclose(found["Blurred"], 2.0 * found["Sharp"], rtol=1e-6)


@pytest.mark.parametrize("correction", CORRECTED)
def test_halfway_out_only_black_darkens(correction: Correction) -> None:
    """Half a metre into a falloff of one."""
    for outside, share in ((Outside.OWN, 1.0), (Outside.UNCORRECTED, 1.0), (Outside.BLACK, 0.5), (None, 1.0)):
        found = shown(LookupEffects(correction, outside), 2.5)
        np.testing.assert_allclose(found["Sharp"], [np.multiply(UP, share)], rtol=1e-5)
        if outside is Outside.OWN:
            np.testing.assert_allclose(found["Weight"], 0.5, rtol=1e-5)


def test_the_classic_lookup_never_darkens_or_weighs() -> None:
    for outside in (*Outside, None):
        found = shown(LookupEffects(Correction.NONE, outside), 50.0)
        assert set(found) == {"Sharp", "Blurred"}
        np.testing.assert_allclose(found["Sharp"], UP, rtol=1e-6)


@pytest.mark.parametrize("correction", CORRECTED)
@pytest.mark.parametrize("stretched", [False, True])
def test_what_is_nearer_to_the_surface_than_to_the_capture_point_is_shown_sharper(
    correction: Correction, stretched: bool
) -> None:
    """A ray straight up from below the capture point at the centre: alpha counts as often as the distances say."""
    effects = LookupEffects(correction, None, False, stretched=stretched, hardening=True)
    formula = lookup.probe(effects, {"Sharp": 8}, {"Direction": (0.0, 0.0, 1.0), "Offset": (0.0, 0.0, 0.0)})
    for z, ratio in ((0.0, 1.0), (1.5, 0.25), (-0.5, 1.25), (1.999, 0.35**2), (-1.0, 1.5), (2.0, 0.35**2)):
        inputs = {**AT, "Position": np.array([[0.0, 0.0, z]])}
        spread = evaluate(formula.outputs, inputs, np.float64, pictures={"Sharp": SKY})["Spread"]
        assert spread == pytest.approx(math.sqrt(ratio), rel=1e-9)


def test_sharpness_is_told_by_the_way_from_the_capture_point_not_from_the_centre() -> None:
    effects = LookupEffects(Correction.ALIGNED_BOX, None, True, hardening=True)
    formula = lookup.probe(effects, {"Sharp": 8}, {"Direction": (0.0, 0.0, 1.0), "Offset": (0.0, 0.0, 0.0)})
    inputs = {**AT, "Position": np.array([[0.0, 0.0, 1.0]]), "Capture Point": np.array([1.5, 0.0, 0.0])}
    spread = evaluate(formula.outputs, inputs, np.float64, pictures={"Sharp": SKY})["Spread"]
    assert spread == pytest.approx(math.sqrt(1.0 / 2.5), rel=1e-9)  # 1 m from the surface, 2.5 m from the camera


def test_sharpness_leaves_with_the_correction_where_that_fades() -> None:
    effects = LookupEffects(Correction.ALIGNED_BOX, Outside.UNCORRECTED, False, hardening=True)
    formula = lookup.probe(effects, {"Sharp": 8}, {"Direction": (0.0, 0.0, 1.0), "Offset": (0.0, 0.0, 0.0)})
    for x, share in ((1.9, 1.0), (2.5, 0.5), (3.5, 0.0)):
        inputs = {**AT, "Position": np.array([[x, 0.0, 1.5]])}
        spread = evaluate(formula.outputs, inputs, np.float64, pictures={"Sharp": SKY})["Spread"]
        near = max(math.sqrt(0.5 / math.hypot(2.0, x)), 0.35)
        assert spread == pytest.approx(1.0 + share * (near - 1.0), rel=1e-6)


def test_nothing_hardens_unless_asked_to_or_where_nothing_is_corrected() -> None:
    for effects in (LookupEffects(hardening=True, correction=Correction.NONE), *map(LookupEffects, Correction)):
        assert "Spread" not in lookup.probe(effects, {"Sharp": 8}).outputs


@pytest.mark.parametrize("correction", list(Correction))
def test_a_probe_that_shares_says_how_deep_a_point_lies(correction: Correction) -> None:
    for x, depth in ((0.5, 1.5), (2.25, -0.25)):
        assert "Depth" not in shown(LookupEffects(correction), x)
        np.testing.assert_allclose(shown(LookupEffects(correction), x, shares=True)["Depth"], [depth], rtol=1e-6)


def test_values_that_are_known_are_no_inputs() -> None:
    formula = lookup.probe(
        LookupEffects(Correction.ALIGNED_BOX, Outside.OWN), {"Sharp": 8}, {**MIRRORED, "Padding": 0.5}
    )
    assert "Padding" not in formula.inputs and "Falloff" in formula.inputs
    found = evaluate(formula.outputs, {**AT, "Position": np.array([2.5, 0.0, 0.0])}, pictures={"Sharp": SKY})
    assert found["Weight"] == 1.0, "half a metre out lies within the padding"


@pytest.mark.parametrize("height", [2, 16, 512, 4096])
def test_the_steepest_direction_is_half_a_texel_and_an_arc_cosines_error_from_the_pole(height: int) -> None:
    angle = math.atan(1.0 / lookup.steepest_slope(height))
    texel, lost = 0.5 * math.pi / height, 2.25 * 2.0**-24
    assert angle**2 == pytest.approx(texel**2 + 2.0 * lost, rel=1e-9)


def test_directions_are_kept_off_the_poles_and_others_stay() -> None:
    def kept(direction: tuple[float, float, float]) -> np.ndarray:
        inputs = {"Direction": np.array(direction), "Steepest": 100.0}
        return evaluate(lookup.OFF_POLES.outputs, inputs, np.float64)["Direction"]

    for direction in ((0.3, -0.4, 0.5), (-3e7, 4e7, 5e7), (-1e-3, 1e-3, -0.1), (1.0, 2.0, 0.0)):
        np.testing.assert_allclose(kept(direction), direction, rtol=1e-9)
    for sign in (1.0, -1.0):
        np.testing.assert_allclose(kept((0.003, -0.004, sign * 7.0)), [0.003, -0.004, sign * 0.5], rtol=1e-9)
        straight = kept((0.0, 0.0, sign))
        assert straight[0] > 0.0 and straight[1] == 0.0 and straight[2] / straight[0] == pytest.approx(sign * 100.0)


def test_a_picture_is_read_as_steeply_as_its_height_allows() -> None:
    """Straight up, half a texel off the pole: the topmost row alone."""
    for height in (8, 64):
        sky = np.zeros((height, 2 * height, 3), np.float32)
        sky[-1] = UP
        radiance = lookup.read_picture("Sky", height, lookup.DIRECTION)
        found = evaluate({"r": radiance}, {"Direction": np.array([0.0, 0.0, 1.0])}, pictures={"Sky": sky})["r"]
        np.testing.assert_allclose(found, UP, rtol=1e-3)
        texels = 2.5 * math.pi / height  # from the pole, in the third row
        aside = np.array([math.sin(texels), 0.0, math.cos(texels)])
        found = evaluate({"r": radiance}, {"Direction": aside}, pictures={"Sky": sky})["r"]
        np.testing.assert_allclose(found, 0.0, atol=1e-3)
