"""The front is a front, and what is measured next."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.accuracy.front import Axis, error_of, front, pareto, undominated
from pcc_addon.core.accuracy.records import CostReport, Kind, Settings
from pcc_addon.core.accuracy.refine import next_rung
from pcc_addon.core.probe import Engine

from .cost_reports import NOISE, PROBE, ladder, measured, path, probe, report

coordinates = st.integers(0, 6).map(float)  # few values, so that many are equal


def beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one != other and all(a <= b for a, b in zip(one, other, strict=True))


@given(st.lists(st.tuples(coordinates, coordinates, coordinates), max_size=30))
def test_the_front_is_what_nothing_beats(points: list[tuple[float, ...]]) -> None:
    kept = pareto(points)
    for i, point in enumerate(points):
        beaten = any(beats(other, point) for other in points)
        first = points.index(point) == i
        assert (i in kept) == (first and not beaten)
    assert [points[i] for i in kept] == sorted(points[i] for i in kept)


@given(st.lists(st.tuples(coordinates, coordinates), max_size=30))
def test_along_the_front_errors_fall(points: list[tuple[float, float]]) -> None:
    errors = [points[i][1] for i in pareto(points)]
    assert errors == sorted(set(errors), reverse=True)


@given(st.lists(st.tuples(coordinates, coordinates), max_size=12), st.randoms())
def test_the_order_of_points_makes_no_difference(points: list[tuple[float, float]], random: object) -> None:
    shuffled = list(points)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    assert {points[i] for i in pareto(points)} == {shuffled[i] for i in pareto(shuffled)}


def test_each_axis_has_its_own_front() -> None:
    found = report(
        path(4, 0.001, 0.01),  # better than all, and no setting of a probe
        probe(0.10, 1.0, 3.0),
        probe(0.05, 9.0, 1.0),
        probe(0.20, 5.0, 2.0),
    )
    assert front(found, Axis.BAKE) == (1, 2)
    assert front(found, Axis.FRAME) == (2,)
    assert undominated(found) == (1, 3, 2)  # by the seconds of the bake


def test_errors_are_without_the_truths_noise() -> None:
    found = report(probe(0.05, 1.0, 1.0), noise=0.03)
    assert abs(error_of(found, found.measurements[0]) - 0.04) < 1e-12


def run(seconds: float, rungs: tuple[Settings, ...]) -> tuple[CostReport, float]:
    """All of a run on known laws, and the seconds that were left in the end."""
    found, left = report(noise=NOISE, frames=(1, 2)), seconds
    while rung := next_rung(found, rungs, left):
        one = measured(rung)
        again = rung.bake_key in {m.settings.bake_key for m in found.measurements}
        left -= (0.0 if again else one.bake_seconds) + 2 * one.frame_seconds
        found = replace(found, measurements=(*found.measurements, one))
    return found, left


def test_a_run_stays_within_its_seconds() -> None:
    for seconds in (30.0, 120.0, 600.0):
        found, left = run(seconds, ladder())
        assert left > -0.02 * seconds and len(found.measurements) >= 5


def test_all_is_measured_where_there_is_time_and_nothing_twice() -> None:
    rungs = ladder()[::9]
    found, _ = run(1e9, rungs)
    order = [m.settings for m in found.measurements]
    assert sorted(map(repr, order)) == sorted(map(repr, rungs))


def test_the_same_run_again_is_the_same() -> None:
    assert run(200.0, ladder()) == run(200.0, ladder())


def test_coarse_rungs_of_each_kind_come_first() -> None:
    found, _ = run(600.0, ladder())
    first = [m.settings for m in found.measurements[:5]]
    assert {(s.kind, s.correction, s.frame_denoise) for s in first} == {
        (Kind.PATH, "NONE", False),
        (Kind.PATH, "NONE", True),
        (Kind.PROBE, "NONE", False),
        (Kind.PROBE, "BOX", False),
        (Kind.PROBE, "RELIEF", False),
    }
    assert all(s.resolution == 64 and s.bake_samples == 4 for s in first if s.kind is Kind.PROBE)


def test_ten_minutes_find_nearly_the_best_of_the_ladder() -> None:
    found, _ = run(600.0, ladder())
    errors = [m.rmse for m in found.measurements if m.settings.kind is Kind.PROBE]
    affordable = [m for m in map(measured, ladder()) if m.settings.kind is Kind.PROBE and m.bake_seconds < 120.0]
    assert min(errors) <= 1.05 * min(m.rmse for m in affordable)
    assert len(found.measurements) < len(ladder()) / 2


def test_path_tracing_is_measured_until_it_is_as_good_as_the_probe() -> None:
    found, _ = run(600.0, ladder())
    best = min(m.rmse for m in found.measurements if m.settings.kind is Kind.PROBE)
    denoised = [m for m in found.measurements if m.settings.kind is Kind.PATH and m.settings.frame_denoise]
    assert min(m.rmse for m in denoised) <= best
    assert len(denoised) < 7  # and not beyond


def test_rungs_beside_the_front_come_before_others() -> None:
    size, samples = replace(PROBE, resolution=512), replace(PROBE, bake_samples=256)
    far = replace(PROBE, resolution=64, bake_samples=16)
    rungs = (PROBE, replace(PROBE, resolution=128), size, samples, far)
    found = report(probe(0.05, 8.0, 1.0), probe(0.09, 2.0, 1.0, rungs[1]))
    assert next_rung(found, rungs, 1000.0) in (size, samples)


def test_a_direction_that_brought_nothing_is_left_for_later() -> None:
    half, double, samples = (
        replace(PROBE, resolution=128),
        replace(PROBE, resolution=512),
        replace(PROBE, bake_samples=256),
    )
    rungs = (PROBE, half, double, samples)
    flat = report(probe(0.0500, 8.0, 1.0), probe(0.0501, 2.0, 1.0, half), frames=())
    steep = report(probe(0.0500, 8.0, 1.0), probe(0.0801, 2.0, 1.0, half), frames=())
    assert next_rung(steep, rungs, 1000.0) == double  # as much work as the samples: the order of the ladder
    assert next_rung(flat, rungs, 1000.0) == samples


def test_what_takes_longer_than_is_left_is_not_begun() -> None:
    big = replace(PROBE, resolution=1024)
    small = report(probe(0.05, 8.0, 1.0))
    assert next_rung(small, (PROBE, big), 120.0) is None  # sixteen times the texels: 128 s, and a frame
    assert next_rung(small, (PROBE, big), 130.0) == big
    assert next_rung(small, (PROBE, big), 0.0) is None


def test_a_bake_that_is_there_costs_nothing_more() -> None:
    classic = replace(PROBE, correction="NONE")
    found = report(probe(0.05, 100.0, 1.0))
    assert next_rung(found, (PROBE, classic), 5.0) == classic
    assert next_rung(found, (PROBE, replace(classic, resolution=255)), 5.0) is None


def test_what_nothing_is_known_of_is_tried() -> None:
    strange = replace(PROBE, engine=Engine.EEVEE)
    assert next_rung(report(probe(0.05, 100.0, 1.0)), (PROBE, strange), 5.0) == strange
    assert next_rung(report(), (), 5.0) is None


def test_the_second_rung_of_a_kind_is_in_the_middle_of_the_ladder() -> None:
    sizes = tuple(replace(PROBE, resolution=size) for size in (32, 64, 128, 256, 512))
    found = report(probe(0.5, 1.0, 1.0, sizes[0]), frames=())
    assert next_rung(found, sizes, 1e9) == sizes[2]
    assert next_rung(found, sizes, 100.0) == sizes[1]  # 4 s and a frame are a twentieth, 16 s are not
    both = replace(found, measurements=(*found.measurements, probe(0.2, 16.0, 1.0, sizes[2])))
    assert next_rung(both, sizes, 1e9) in (sizes[1], sizes[3])  # beside the front


def test_ray_tracing_is_another_kind_of_picture_and_no_step() -> None:
    traced = replace(PROBE, ray_tracing=True)
    one, other, far = replace(traced, bake_samples=16), replace(PROBE, resolution=512), replace(traced, resolution=64)
    found = report(probe(0.05, 1.0, 1.0), probe(0.2, 1.0, 1.0, one), probe(0.3, 0.1, 1.0, far), frames=())
    assert next_rung(found, (PROBE, one, far, traced, other), 1e9) == other
