"""What shaders made by hand get of a probe, against rays and planes, and against what injected ones get."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup
from pcc_addon.core.effects.by_hand import by_hand, distance_formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.probe import Box
from tests.core.boxes import KINDS, directions, inside, matrix

RUNGS = (0.0, 0.25, 0.5)
HEIGHTS = {f"Level {k}": 8 for k in range(3)}
PICTURES = {f"Level {k}": np.random.default_rng(k).uniform(0.0, 4.0, (8, 16, 3)) for k in range(3)}


def box_inputs(m: np.ndarray) -> dict[str, np.ndarray | float]:
    box = Box.from_matrix("Box", m)
    return {
        "Box Centre": box.centre,
        "Half Widths": box.half_widths,
        **{f"Face Normal {axis}": box.face_normals[k] for k, axis in enumerate("XYZ")},
        "Capture Point": box.centre + 0.1,
        "Padding": 0.0,
        "Falloff": 0.5,
        "Boundary": 1e-6,
        "Shown": 1.0,
        "Offset": np.zeros(3),
    }


@pytest.mark.parametrize("kind", KINDS)
def test_the_distance_ends_on_the_wall(kind: str) -> None:
    """In the box's own coordinates, where it is [−1, 1]³: an independent way to tell."""
    rng = np.random.default_rng(3)
    m = matrix(kind, rng)
    start, ray = inside(m, 200, rng), directions(200, rng)
    outputs = distance_formula(Correction.ORIENTED_BOX).outputs
    found = evaluate(outputs, {**box_inputs(m), "Position": start, "Direction": ray}, np.float64)["Distance"].reshape(
        -1, 1
    )
    ends = (start + found * ray - m[:3, 3]) @ np.linalg.inv(m[:3, :3]).T
    np.testing.assert_allclose(np.abs(ends).max(-1), 1.0, rtol=1e-9)


@pytest.fixture
def case() -> dict[str, np.ndarray | float]:
    rng = np.random.default_rng(5)
    m = matrix("rotated", rng)
    views = {"Incoming": directions(50, rng), "Normal": directions(50, rng)}
    return {**box_inputs(m), **views, "Position": inside(m, 50, rng, reach=1.3), "Roughness": 0.25}


def shown(case: dict, effects: LookupEffects, **values: object) -> dict[str, np.ndarray]:
    found = evaluate(by_hand(effects, HEIGHTS, RUNGS).outputs, {**case, **values}, pictures=PICTURES)
    return {name: np.reshape(value, (50, -1)) for name, value in found.items()}


@pytest.mark.parametrize("outside", Outside)
def test_inside_it_is_what_injected_surfaces_show(case: dict, outside: Outside) -> None:
    """Unlinked, the direction is the reflected view; whatever a probe does outside, the weight tells where that is."""
    effects = LookupEffects(Correction.ORIENTED_BOX, outside, offset=True, facing=True)
    found = shown(case, effects, Direction=np.zeros((50, 3)))
    own = LookupEffects(Correction.ORIENTED_BOX, Outside.OWN, offset=True, facing=True)
    injected = lookup.probe(own, HEIGHTS, {"Direction": lookup.MIRRORED})
    expected = evaluate(injected.outputs, case, pictures=PICTURES)
    np.testing.assert_allclose(found["Radiance"], expected["Level 1"], rtol=1e-5)
    np.testing.assert_array_equal(found["Weight"], expected["Weight"].reshape(50, 1))
    assert 0.0 < (found["Weight"] == 1.0).mean() < 1.0


def test_a_direction_may_have_any_length(case: dict) -> None:
    effects = LookupEffects(facing=True)
    ray = directions(50, np.random.default_rng(9))
    short, long = (shown(case, effects, Direction=ray * size) for size in (1.0, 64.0))
    mirrored = shown(case, effects, Direction=np.zeros((50, 3)))
    for name in ("Radiance", "Distance"):
        np.testing.assert_allclose(short[name], long[name], rtol=1e-9)
        assert not np.allclose(short[name], mirrored[name])


def test_captures_see_none_of_it(case: dict) -> None:
    dark = shown(case, LookupEffects(facing=True), Direction=np.zeros((50, 3)), Shown=0.0)
    assert not dark["Radiance"].any() and dark["Weight"].any()
