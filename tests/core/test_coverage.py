"""How much of a surface probes have: shares and the rest add up to one, nothing steps, outer sides are outside."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import choice
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.probe import Box, ProbeSpec

from . import boxes
from .sharing import parts_of

ROUNDOFF = 2.0**-24


def coverage_of(depths: np.ndarray, weights: np.ndarray, fade: float = 0.25) -> tuple[np.ndarray, np.ndarray]:
    """Of boxes that are apart."""
    return parts_of(depths, weights, [fade] * depths.shape[1])


def weight_at(depth: np.ndarray, falloff: float = 0.25) -> np.ndarray:
    return evaluate(
        {"w": formula.faded(formula.scalar("Depth"), formula.FALLOFF)}, {"Depth": depth, "Falloff": falloff}
    )["w"]


def test_the_shares_and_the_rest_add_up_to_one() -> None:
    rng = np.random.default_rng(1)
    depths = rng.uniform(-0.5, 0.3, (5000, 8)).astype(np.float32)
    shares, own = coverage_of(depths, weight_at(depths))
    assert (shares >= 0.0).all() and (own >= 0.0).all()
    np.testing.assert_allclose(shares.sum(-1) + own, 1.0, atol=4 * 8 * ROUNDOFF)
    assert own.max() > 0.3 and own.min() == 0.0


def test_a_point_in_one_box_alone_shows_that_probe_and_no_other_exactly() -> None:
    """Exactly: Cycles then reads no other picture."""
    for room in range(5):
        depths = np.full((1, 5), -3.0)
        depths[0, room] = 0.7
        shares, own = coverage_of(depths, weight_at(depths))
        np.testing.assert_array_equal(shares[0], np.eye(5)[room])
        assert own[0] == 0.0


def test_a_point_far_from_all_keeps_its_own_lobe() -> None:
    shares, own = coverage_of(np.full((1, 3), -2.0), np.zeros((1, 3)))
    assert not shares.any() and own[0] == 1.0


def test_through_a_doorway_the_shares_do_not_step() -> None:
    """Two rooms, twelve centimetres apart, and a walk from one into the other."""
    x = np.linspace(-0.5, 0.6, 11_001)
    depths = np.stack([-x, x - 0.12], -1)  # metres below the wall of each
    shares, own = coverage_of(depths, weight_at(depths))
    assert shares[0].tolist() == [1.0, 0.0] and shares[-1].tolist() == [0.0, 1.0]
    assert np.abs(np.diff(shares, axis=0)).max() < 0.005
    assert np.abs(np.diff(own)).max() < 0.005 and own.max() < 0.15


def test_a_box_over_another_is_shown_in_all_of_itself_and_fades_beyond() -> None:
    """On a floor that both stand on, too."""
    depth = np.linspace(-0.5, 0.1, 601)
    for below in (2.0, 0.01):
        depths = np.stack([np.full_like(depth, below), depth], -1)
        shares, own = parts_of(depths, weight_at(depths), [0.25, 0.25], apart=[(), ()])
        assert not own.any()
        assert (np.diff(shares[:, 1]) >= -1e-7).all()
        np.testing.assert_array_equal(shares[depth >= 0.0, 1], 1.0)
        assert not shares[depth <= -0.25, 1].any()
        np.testing.assert_allclose(np.interp([-0.1875, -0.125], depth, shares[:, 1]), [0.15625, 0.5], atol=2e-3)
        assert np.abs(np.diff(shares[:, 1])).max() < 0.01


def test_what_shows_its_own_picture_outside_fades_by_depth_where_it_is_over_others() -> None:
    """Its weight is 1 everywhere."""
    depths = np.array([[2.0, 0.1], [2.0, -0.125], [2.0, -0.3]])
    shares, _ = parts_of(depths, np.ones((3, 2)), [0.25, 0.25], apart=[(), ()])
    np.testing.assert_allclose(shares[:, 1], [1.0, 0.5, 0.0], atol=1e-6)


@pytest.mark.parametrize("depth", [1.0, 2.0, 7.0])
@pytest.mark.parametrize("captured", [0.0, 1.0])
def test_paths_that_left_a_diffuse_surface_meet_the_own_lobe_only(depth: float, captured: float) -> None:
    inputs = {"Coverage": np.array([0.0, 0.3, 1.0]), "Diffuse Depth": depth, "Captured": captured}
    found = evaluate(choice.own_share(None).outputs, inputs)
    np.testing.assert_array_equal(found["Share"], 1.0)
    np.testing.assert_array_equal(found["Covered"], 0.0)


@pytest.mark.parametrize("limit", [None, 0.0, 0.6])
def test_captures_see_nothing_of_the_own_lobe(limit: float | None) -> None:
    inputs = {"Coverage": np.array([0.0, 0.3, 1.0]), "Diffuse Depth": 0.0, "Captured": 1.0, "Roughness": 0.7}
    np.testing.assert_array_equal(evaluate(choice.own_share(limit).outputs, inputs)["Share"], 0.0)


def test_what_grows_too_rough_is_handed_over_without_a_step() -> None:
    roughness = np.linspace(0.0, 1.0, 1001)
    inputs = {"Coverage": 1.0, "Diffuse Depth": 0.0, "Captured": 0.0, "Roughness": roughness}
    found = evaluate(choice.own_share(0.6).outputs, inputs)
    share = found["Share"]
    np.testing.assert_allclose(found["Covered"] + share, 1.0, atol=ROUNDOFF)
    assert not share[roughness <= 0.54].any() and (share[roughness >= 0.6] == 1.0).all()
    assert np.abs(np.diff(share)).max() < 0.02
    only_mirrors = evaluate(choice.own_share(0.0).outputs, {**inputs, "Roughness": 0.0})["Share"]
    assert only_mirrors == 1.0


@pytest.mark.parametrize("kind", boxes.KINDS)
def test_the_outer_side_of_a_wall_on_the_box_is_outside_and_the_inner_side_inside(kind: str) -> None:
    rng = np.random.default_rng(3)
    m = boxes.matrix(kind, rng, (300.0, -200.0, 30.0))
    spec = ProbeSpec("Hall", Box.from_matrix("Hall", m), outside=Outside.OWN)
    corners = rng.uniform(-0.9, 0.9, (300, 3))
    axis, side = rng.integers(0, 3, 300), rng.choice([-1.0, 1.0], 300)
    corners[np.arange(300), axis] = side
    points = m[:3, 3] + corners @ m[:3, :3].T
    normals = spec.box.face_normals[axis] * side[:, None]
    effects = LookupEffects(Correction.ORIENTED_BOX, Outside.OWN, offset=False, facing=True)
    inputs = {
        "Position": points,
        "Box Centre": spec.box.centre,
        **{f"Face Normal {name}": row for name, row in zip("XYZ", spec.box.face_normals, strict=True)},
        "Half Widths": spec.box.half_widths,
        "Padding": spec.influence_padding,
        "Falloff": spec.influence_falloff,
        "Boundary": spec.boundary,
    }

    def weight(facing: np.ndarray) -> np.ndarray:
        eye = boxes.unit(facing + 0.3 * boxes.directions(300, np.random.default_rng(4)))
        return evaluate(formula.lookup(effects), {**inputs, "Normal": facing, "Incoming": eye})["Weight"]

    np.testing.assert_array_equal(weight(normals), 0.0)
    np.testing.assert_array_equal(weight(-normals), 1.0)
    across = boxes.unit(np.cross(normals, boxes.directions(300, rng)))  # a floor that runs on through a doorway
    np.testing.assert_array_equal(weight(across), 1.0)


def test_things_in_the_room_may_face_any_way() -> None:
    rng = np.random.default_rng(5)
    effects = LookupEffects(Correction.ALIGNED_BOX, Outside.OWN, offset=False, facing=True)
    inputs = {
        "Position": rng.uniform(-1.99, 1.99, (500, 3)),
        "Normal": boxes.directions(500, rng),
        "Incoming": boxes.directions(500, rng),
        "Box Centre": np.zeros(3),
        "Half Widths": np.full(3, 2.0),
        "Padding": 0.01,
        "Falloff": 0.25,
        "Boundary": 1e-5,
    }
    np.testing.assert_array_equal(evaluate(formula.lookup(effects), inputs)["Weight"], 1.0)
