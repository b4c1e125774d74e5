"""The influence of a probe: faces that differ, fading by normal, weight; and several that share a place."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.effects.records import Correction, LookupEffects
from pcc_addon.core.errors import ProbeError
from pcc_addon.core.influence import Influence
from pcc_addon.core.lookup_plan import Receivers, lookup_effects
from pcc_addon.core.probe import Box, ProbeSpec

from . import boxes
from .scenes import spec
from .sharing import random_probes, shared, steepest, weight_and_depth

ROUNDOFF = 2.0**-24
LOW, HIGH = (0.3, -0.1, 0.0), (-0.2, 0.4, 1.0)
FALLOFF_LOW, FALLOFF_HIGH = (0.1, 0.2, 0.3), (0.4, 0.5, 0.0)


def turned(mirrored: bool) -> np.ndarray:
    m = boxes.matrix("unrotated", np.random.default_rng(2))
    c, s = np.cos(2.2), np.sin(2.2)
    m[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ m[:3, :3]
    m[:3, 1] *= -1.0 if mirrored else 1.0
    return m


def flipped() -> np.ndarray:
    m = boxes.matrix("unrotated", np.random.default_rng(3))
    m[:3, 0] *= -1.0
    return m


MATRICES = {
    "aligned": (boxes.matrix("unrotated", np.random.default_rng(1)), Correction.ALIGNED_BOX),
    "aligned, mirrored": (flipped(), Correction.ALIGNED_BOX),
    "turned": (turned(False), Correction.TURNED_BOX),
    "turned, mirrored": (turned(True), Correction.TURNED_BOX),
    **{kind: (boxes.matrix(kind, np.random.default_rng(4)), Correction.ORIENTED_BOX) for kind in boxes.KINDS},
}


def local(spec: ProbeSpec, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Points around a box in world space, and their metres along the box's own axes."""
    metres = np.random.default_rng(seed).uniform(-2.0, 2.0, (count, 3)) + spec.box.half_widths * [1, -1, 1]
    return spec.box.centre + metres @ np.linalg.inv(spec.box.face_normals).T, metres


def smooth(x: np.ndarray) -> np.ndarray:
    cut = np.clip(x, 0.0, 1.0)
    return cut * cut * (3.0 - 2.0 * cut)


@pytest.mark.parametrize("kind", MATRICES)
def test_each_face_reaches_and_fades_as_it_is_told(kind: str) -> None:
    """Lows are the faces at the own axes' negative ends, whichever way the shader's coordinates run."""
    m, correction = MATRICES[kind]
    influence = Influence(LOW, HIGH, FALLOFF_LOW, FALLOFF_HIGH)
    spec = ProbeSpec("Hall", Box.from_matrix("Hall", m), padding=0.0, influence=influence)
    points, metres = local(spec, 4000)
    found, depth = weight_and_depth(spec, points, points, np.float64, correction)
    below = np.stack([metres + spec.box.half_widths + LOW, spec.box.half_widths + HIGH - metres], 1)
    below = below + spec.influence_padding
    falloffs = np.maximum([FALLOFF_LOW, FALLOFF_HIGH], 1e-9)
    np.testing.assert_allclose(found, smooth((1.0 + below / falloffs).min((1, 2))), atol=1e-6)
    np.testing.assert_allclose(depth, (below * 0.5 / falloffs).min((1, 2)), rtol=1e-6, atol=1e-6)
    assert 0.05 < (found == 1.0).mean() < 0.95 and ((found > 0.0) & (found < 1.0)).mean() > 0.05


def test_faces_that_say_the_same_as_the_box_need_nothing() -> None:
    box = Box.from_matrix("Hall", np.eye(4))
    plain = ProbeSpec("Hall", box, falloff=0.3)
    same = ProbeSpec("Hall", box, falloff=9.0, influence=Influence(falloff_low=(0.3,) * 3, falloff_high=(0.3,) * 3))
    centre = box.centre
    assert lookup_effects(plain, Receivers(), centre) == lookup_effects(same, Receivers(), centre)
    assert plain.influence_falloff == same.influence_falloff == 0.3
    for influence in (Influence(low=(0.0, 0.1, 0.0)), Influence(falloff_high=(0.3, 0.3, 0.2))):
        assert lookup_effects(ProbeSpec("Hall", box, falloff=0.3, influence=influence), Receivers(), centre).per_face


def test_only_what_is_asked_for_is_computed() -> None:
    box = Box.from_matrix("Hall", np.eye(4))

    def effects(**influence: object) -> LookupEffects:
        return lookup_effects(
            ProbeSpec("Hall", box, influence=Influence(**influence)), Receivers(True, False), box.centre
        )

    plain = LookupEffects(Correction.ALIGNED_BOX, None, offset=False)
    assert effects() == plain and effects(priority=4, excluded=frozenset({"Vase"})) == plain
    assert effects(weight=0.5) == LookupEffects(Correction.ALIGNED_BOX, None, offset=False, weighted=True)
    assert effects(normal_fade=0.5) == LookupEffects(Correction.ALIGNED_BOX, None, offset=False, by_normal=True)
    labels = [effects(**one).label for one in ({}, {"weight": 0.5}, {"normal_fade": 0.5}, {"low": (0.0, 0.0, 1.0)})]
    assert len(set(labels)) == 4


def cube(**settings: object) -> ProbeSpec:
    """The cube from −2 to 2, without padding."""
    return ProbeSpec("Hall", Box.from_matrix("Hall", np.diag([2.0, 2.0, 2.0, 1.0])), padding=0.0, **settings)


def test_surfaces_that_face_away_fade_near_the_border_as_unity_has_it() -> None:
    """Gone from a cosine of 0.6 on and untouched up to 0.2 at the border; untouched wherever they face deep below."""
    spec = cube(influence=Influence(normal_fade=0.5))
    cosines = np.array([1.0, 0.6, 0.4, 0.2, 0.0, -1.0])
    normals = np.stack([cosines, np.sqrt(1.0 - cosines**2), np.zeros(6)], -1)

    def left(x: float) -> np.ndarray:
        points = np.tile([x, 0.0, 0.0], (6, 1))
        return weight_and_depth(spec, points, normals, np.float64, Correction.ALIGNED_BOX)[0]

    np.testing.assert_allclose(left(2.0), [0.0, 0.0, 0.5, 1.0, 1.0, 1.0], atol=1e-5)
    np.testing.assert_allclose(left(1.75), [0.5, 0.5, 0.75, 1.0, 1.0, 1.0], atol=1e-5)
    np.testing.assert_allclose(left(1.5), 1.0, atol=1e-5)
    np.testing.assert_array_equal(left(0.0), 1.0)


def test_a_weight_leaves_the_rest_to_the_own_lobe_whatever_is_shown_outside() -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.99, 0.0, 0.0]])
    weight, _ = weight_and_depth(
        cube(influence=Influence(weight=0.25)), points, points, np.float64, Correction.ALIGNED_BOX
    )
    np.testing.assert_array_equal(weight, 0.25)


@pytest.mark.parametrize(
    ("influence", "words"),
    [
        ({"low": (np.nan, 0.0, 0.0)}, "not finite"),
        ({"falloff_low": (-1.0, 0.0, 0.0)}, "falloffs of its faces"),
        ({"falloff_high": (np.inf, 0.0, 0.0)}, "falloffs of its faces"),
        ({"low": (0.0, -3.0, 0.0), "high": (0.0, -1.0, 0.0)}, "no size along Y;"),
        ({"normal_fade": -1.0}, "normal fade"),
        ({"weight": 1.5}, "not between 0 and 1"),
        ({"weight": -0.5}, "not between 0 and 1"),
    ],
)
def test_what_no_shader_can_show_is_refused_by_name(influence: dict, words: str) -> None:
    with pytest.raises(ProbeError, match=f"probe 'Hall': .*{words}"):
        cube(influence=Influence(**influence))


def test_the_influence_decides_what_is_inside_and_the_box_what_is_enclosed() -> None:
    spec = cube(influence=Influence(low=(-1.0, 0.0, 0.0), high=(3.0, 0.0, 0.0)), falloff=0.5)
    at = {x: np.array([[x, 0.0, 0.0]]) for x in (-2.6, -1.6, -1.2, -0.9, 1.9, 4.9, 5.2, 5.6)}
    assert [x for x, point in at.items() if spec.contains(point)] == [-0.9, 1.9, 4.9]
    assert [x for x, point in at.items() if spec.overlaps(point)] == [-1.2, -0.9, 1.9, 4.9, 5.2]
    assert [x for x, point in at.items() if spec.holds(point)] == [-1.6, -1.2, -0.9, 1.9]


def test_who_shows_a_probe_is_said_by_receivers_and_excluded() -> None:
    assert Influence().accepts("Vase")
    assert not Influence(excluded=frozenset({"Vase"})).accepts("Vase")
    only = Influence(receivers=frozenset({"Vase", "Table"}), excluded=frozenset({"Table"}))
    assert [name for name in ("Vase", "Table", "Chair") if only.accepts(name)] == ["Vase"]


@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_what_several_probes_have_and_the_rest_add_up_to_one(seed: int, count: int) -> None:
    """Within 4 units in the last place a probe, for boxes, influences, priorities and weights of all sorts."""
    rng = np.random.default_rng(seed)
    specs = random_probes(rng, count)
    parts, own = shared(specs, rng.uniform(-5.0, 5.0, (400, 3)), boxes.directions(400, rng))
    assert (parts >= 0.0).all() and (parts <= 1.0).all() and (own >= 0.0).all()
    assert np.abs(parts.sum(-1, dtype=np.float64) + own - 1.0).max() <= 4 * count * ROUNDOFF


@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_no_place_steps_wherever_boxes_overlap_touch_or_cut_each_other(seed: int, count: int) -> None:
    """Pairs of points from a tenth of a micrometre to a centimetre apart, many of them across walls."""
    rng = np.random.default_rng(seed)
    specs = random_probes(rng, count)
    n = 2000
    places = np.concatenate([rng.uniform(-5.0, 5.0, (n, 3)), *(on_walls(spec, n // count, rng) for spec in specs)])
    length = 10.0 ** rng.uniform(-7.0, -2.0, len(places))
    aside = boxes.directions(len(places), rng) * length[:, None]
    normals = boxes.directions(len(places), rng)
    (before, own_before), (after, own_after) = (
        shared(specs, places + side * aside, normals, np.float64) for side in (-0.5, 0.5)
    )
    allowed = steepest(specs) * length + 1e-9
    assert (np.abs(after - before) <= allowed[:, None]).all()
    assert (np.abs(own_after - own_before) <= allowed).all()


def on_walls(spec: ProbeSpec, count: int, rng: np.random.Generator) -> np.ndarray:
    """Points (count, 3) on the walls of a box, their padding or the border of the influence."""
    local = rng.uniform(-1.0, 1.0, (count, 3))
    axis, high = rng.integers(0, 3, count), rng.integers(0, 2, count)
    beyond = np.where(rng.random(count) < 0.5, spec.influence_reach[high, axis], 0.0)
    local[np.arange(count), axis] = (2 * high - 1) * (1.0 + beyond / spec.box.half_widths[axis])
    return spec.box.centre + local @ spec.box.axes.T


def test_touching_rooms_hand_over_within_a_fifth_of_the_falloff() -> None:
    """Two boxes with a wall in common, a walk from one into the other; before, the shares stepped from 0 to 1."""
    specs = [spec("Left", padding=0.0), spec("Right", 4.0, padding=0.0)]
    x = np.linspace(1.8, 2.2, 4001)
    points = np.stack([x, 0.0 * x, 0.0 * x], -1)
    parts, own = shared(specs, points, np.tile([0.0, 0.0, 1.0], (len(x), 1)), np.float64)
    assert np.abs(np.diff(parts, axis=0)).max() < 0.005
    low, high = (parts[np.abs(x - at).argmin()] for at in (1.9, 2.1))
    np.testing.assert_allclose([low, high], [[1.0, 0.0], [0.0, 1.0]], atol=1e-6)
    assert own.max() < 0.05


@pytest.mark.parametrize(
    ("first", "second", "shown"), [(0, 0, "Small"), (1, 0, "Large"), (0, 1, "Small"), (-1, -1, "Small")]
)
def test_where_boxes_overlap_priority_decides_and_then_the_smaller_one(first: int, second: int, shown: str) -> None:
    large = ProbeSpec("Large", Box.from_matrix("L", np.diag([4.0, 4.0, 4.0, 1.0])), influence=Influence(priority=first))
    small = ProbeSpec("Small", Box.from_matrix("S", np.eye(4)), influence=Influence(priority=second))
    for specs in ([large, small], [small, large]):
        parts, _ = shared(specs, np.zeros((1, 3)), np.ones((1, 3)))
        assert [spec.name for spec, part in zip(specs, parts[0], strict=True) if part == 1.0] == [shown]
