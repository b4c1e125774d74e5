"""What path tracing reaches in what time, and lines through times, on laws that are known."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.accuracy.lines import Line, fitted
from pcc_addon.core.accuracy.path_curve import PathCurve, best_in_time, fastest_to, path_curves
from pcc_addon.core.accuracy.records import Kind, Measurement
from pcc_addon.core.accuracy.times import Times, bake_work
from pcc_addon.core.probe import Engine

from .cost_reports import PROBE, path, probe, report

positive = st.floats(1e-3, 1e3)


def raw(*samples: int, noise: float = 0.5, start: float = 0.4, slope: float = 0.05) -> list[Measurement]:
    return [path(n, noise / math.sqrt(n), start + slope * n) for n in samples]


def curve(*measurements: Measurement, noise: float = 0.0) -> PathCurve:
    (only,) = path_curves(report(*measurements, noise=noise))
    return only


@given(positive, positive)
def test_a_line_is_found_again(start: float, slope: float) -> None:
    line = fitted([(x, start + slope * x) for x in (1.0, 4.0, 16.0)])
    assert line.start == pytest.approx(start, rel=1e-6, abs=1e-6 * slope)
    assert line.slope == pytest.approx(slope, rel=1e-6, abs=1e-6 * start)


@given(st.lists(st.tuples(positive, positive), min_size=1, max_size=6))
def test_no_line_is_ever_negative(points: list[tuple[float, float]]) -> None:
    line = fitted(points)
    assert line.start >= 0.0 and line.slope >= 0.0 and line.at(2000.0) > 0.0


def test_seconds_that_fall_are_level() -> None:
    assert fitted([(1.0, 3.0), (10.0, 2.0)]).slope == 0.0


def test_times_that_grow_faster_than_work_go_through_zero() -> None:
    assert fitted([(1.0, 1.0), (10.0, 20.0)]).start == 0.0


def test_one_point_is_proportional() -> None:
    assert fitted([(4.0, 8.0)]) == Line(0.0, 2.0)
    assert fitted([(4.0, 8.0), (4.0, 8.0)]) == Line(0.0, 2.0)


@pytest.mark.parametrize("samples", [1.0, 3.0, 4.0, 10.0, 16.0, 64.0, 200.0, 5000.0])
def test_noise_falls_with_the_root_of_the_samples(samples: float) -> None:
    point = curve(*raw(4, 16, 64)).at(samples)
    assert point.error == pytest.approx(0.5 / math.sqrt(samples), rel=1e-6)
    assert point.seconds == pytest.approx(0.4 + 0.05 * samples, rel=1e-6)
    assert point.measured == (4 <= samples <= 64)


def test_measured_points_are_kept_as_they_are() -> None:
    measured = [path(4, 0.3, 1.0), path(16, 0.11, 2.0), path(64, 0.09, 9.0)]
    found = curve(*measured)
    for one in measured:
        point = found.at(one.settings.frame_samples)
        assert (point.error, point.seconds) == (pytest.approx(one.rmse), pytest.approx(one.frame_seconds))


@given(
    st.lists(st.tuples(st.floats(1e-4, 2.0), st.floats(0.01, 100.0)), min_size=1, max_size=6),
    st.booleans(),
    st.sampled_from(Engine),
)
def test_more_samples_are_never_worse_and_never_faster(
    points: list[tuple[float, float]], denoised: bool, engine: Engine
) -> None:
    found = curve(*(path(3**k, error, seconds, denoised, engine) for k, (error, seconds) in enumerate(points, 1)))
    walk = [found.at(1.3**k) for k in range(50)]
    for one, other in pairwise(walk):
        assert other.error <= one.error * (1 + 1e-9) and other.seconds >= one.seconds * (1 - 1e-9)


@given(st.floats(0.006, 0.4))
def test_time_and_error_lead_to_each_other(error: float) -> None:
    found = curve(*raw(4, 16, 64, 256))
    reached = found.reaching(error)
    assert reached is not None and reached.error == pytest.approx(error, rel=1e-6) and reached.error <= error
    back = found.in_time(reached.seconds)
    assert back is not None and back.samples == pytest.approx(reached.samples, rel=1e-6)


def test_what_is_faster_than_one_sample_has_no_picture() -> None:
    found = curve(*raw(4, 16))
    assert found.in_time(0.44) is None
    least = found.in_time(0.4500001)
    assert least is not None and least.samples == pytest.approx(1.0, rel=1e-3)


def test_an_error_that_one_sample_has_already() -> None:
    point = curve(*raw(4, 16)).reaching(0.9)
    assert point is not None and point.samples == 1.0


def test_a_denoisers_bias_stays() -> None:
    found = curve(*(path(n, math.hypot(0.02, 0.3 / math.sqrt(n)), 1.0 + 0.1 * n, True) for n in (4, 16, 64)))
    assert found.reaching(0.0199) is None
    point = found.reaching(0.0202)
    assert point is not None and not point.measured
    assert point.samples == pytest.approx(0.3**2 / (0.0202**2 - 0.02**2), rel=1e-3)


def test_a_single_denoised_point_promises_nothing_better() -> None:
    found = curve(path(16, 0.05, 2.0, True))
    assert found.reaching(0.0499) is None and found.reaching(0.05) is not None


def test_eevee_has_a_bias_without_a_denoiser_too() -> None:
    assert curve(path(16, 0.3, 2.0, engine=Engine.EEVEE)).reaching(0.2) is None


def test_raw_path_tracing_reaches_everything_in_the_end() -> None:
    point = curve(path(16, 0.1, 2.0)).reaching(0.001)
    assert point is not None and point.samples == pytest.approx(160_000, rel=1e-6) and not point.measured


def test_the_truths_noise_is_no_bias() -> None:
    """Measured against a truth with noise, errors seem to level off; they do not."""
    measured = [path(n, math.hypot(0.5 / math.sqrt(n), 0.03), 0.05 * n) for n in (16, 64, 256)]
    point = curve(*measured, noise=0.03).reaching(0.01)
    assert point is not None and point.samples == pytest.approx(2500, rel=1e-6)


def test_raw_and_denoised_compete() -> None:
    denoised = [path(n, math.hypot(0.03, 0.1 / math.sqrt(n)), 1.0 + 0.05 * n, True) for n in (1, 4, 16)]
    curves = path_curves(report(*raw(1, 4, 16, 64), *denoised))
    assert [found.denoised for found in curves] == [False, True]
    soon, fine = best_in_time(curves, 1.5), fastest_to(curves, 0.01)
    assert soon is not None and soon.denoised and soon.words == "denoised path tracing"
    assert fine is not None and not fine.denoised and fine.words == "path tracing"
    at_once = best_in_time(curves, 0.5)
    assert at_once is not None and not at_once.denoised
    assert best_in_time(curves, 0.1) is None and fastest_to((), 0.5) is None


def test_two_measurements_of_the_same_samples_count_once() -> None:
    assert len(curve(path(4, 0.2, 1.0), path(4, 0.3, 1.2)).points) == 1


def test_seconds_of_bakes_follow_texels_and_samples() -> None:
    rungs = [
        replace(PROBE, resolution=size, bake_samples=samples) for size, samples in ((64, 16), (128, 16), (256, 64))
    ]
    times = Times.fitted_to([probe(0.1, 1.5 + 3e-6 * bake_work(rung), 2.0, rung) for rung in rungs])
    big = replace(PROBE, resolution=1024, bake_samples=256)
    assert times.bake(big) == pytest.approx(1.5 + 3e-6 * 1024**2 * 256, rel=1e-6)


def test_seconds_of_frames_follow_their_samples() -> None:
    rungs = [(replace(PROBE, frame_samples=n, bake_samples=n), n) for n in (4, 16, 64)]
    times = Times.fitted_to([probe(0.1, 1.0, 0.3 + 0.02 * n, rung) for rung, n in rungs])
    assert times.frame(replace(PROBE, frame_samples=256)) == pytest.approx(0.3 + 0.02 * 256, rel=1e-6)


def test_the_likest_rungs_tell_and_others_where_there_are_none() -> None:
    relief = replace(PROBE, correction="RELIEF", steps=8)
    box, march = probe(0.1, 4.0, 1.0), probe(0.1, 6.0, 3.0, relief)
    times = Times.fitted_to([box, march])
    assert (times.bake(PROBE), times.bake(relief)) == (pytest.approx(4.0), pytest.approx(6.0))
    assert (times.frame(PROBE), times.frame(relief)) == (pytest.approx(1.0), pytest.approx(3.0))
    assert Times.fitted_to([box]).bake(relief) == pytest.approx(4.0)
    assert times.frame(replace(PROBE, engine=Engine.EEVEE)) is None


def test_path_tracing_bakes_nothing_and_nothing_is_known_of_nothing() -> None:
    empty = Times.fitted_to([])
    assert empty.bake(path(4, 0.1, 1.0).settings) == 0.0 and empty.bake(PROBE) is None


def test_rungs_that_share_a_bake_count_it_once() -> None:
    again = replace(PROBE, correction="NONE")
    assert again.bake_key == PROBE.bake_key
    other = replace(PROBE, resolution=512)
    once = Times.fitted_to([probe(0.1, 4.0, 1.0), probe(0.1, 10.0, 1.0, other)])
    twice = Times.fitted_to([probe(0.1, 4.0, 1.0), probe(0.1, 10.0, 1.0, other), probe(0.1, 4.0, 1.0, again)])
    assert once.bakes == twice.bakes


@pytest.mark.parametrize(
    "changed",
    [
        {"kind": Kind.SPHERE},
        {"resolution": 512},
        {"bake_samples": 16},
        {"bake_denoise": False},
        {"half_float": True},
        {"correction": "RELIEF"},
    ],
    ids=str,
)
def test_what_changes_a_bake_changes_its_key(changed: dict[str, object]) -> None:
    assert replace(PROBE, **changed).bake_key != PROBE.bake_key  # type: ignore[arg-type]


def test_what_only_changes_the_look_shares_the_bake() -> None:
    relief = replace(PROBE, correction="RELIEF", steps=8)
    for changed in (
        {"frame_samples": 4},
        {"frame_denoise": True},
        {"ray_tracing": True},
        {"steps": 16, "refinements": 2},
    ):
        assert replace(relief, **changed).bake_key == relief.bake_key  # type: ignore[arg-type]
    sphere = replace(PROBE, kind=Kind.SPHERE)
    assert replace(sphere, correction="RELIEF").bake_key == sphere.bake_key  # it has none
