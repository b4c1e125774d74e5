"""How long measurements will take: guesses err on the safe side, and what is there already costs nothing."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pcc_addon.core.accuracy.foresight import LONG, Foresight, renders
from pcc_addon.core.accuracy.ladder import SAMPLES, ladder
from pcc_addon.core.accuracy.records import Kind, Measurement, Settings
from pcc_addon.core.accuracy.times import bake_work
from pcc_addon.core.probe import Engine

RUNG = Settings(Kind.PROBE, Engine.CYCLES, "BOX", 64, 16, frame_samples=4)
PER_SAMPLE = 1e-6


def measured(rung: Settings, bake: float, frame: float) -> Measurement:
    return Measurement(rung, 0.1, 0.1, None, bake, frame)


def foresight(*known: Measurement, frames: int = 1) -> Foresight:
    return Foresight(known, frames, 480 * 270, PER_SAMPLE, around_frame=0.1, around_bake=1.0)


def test_without_measurements_the_speed_of_path_tracing_tells() -> None:
    bake, frame = 1.0 + 6 * 64**2 * 16 * PER_SAMPLE, 0.1 + 480 * 270 * 4 * PER_SAMPLE
    assert foresight().seconds(RUNG, ()) >= bake + 3 * frame


def test_a_bake_that_is_there_is_not_paid_again() -> None:
    known = foresight(measured(RUNG, 50.0, 0.5))
    assert known.seconds(RUNG, ()) - known.seconds(RUNG, (RUNG.bake_key,)) >= 50.0


def test_path_tracing_needs_no_bake() -> None:
    path = Settings(Kind.PATH, Engine.CYCLES, "NONE", frame_samples=4)
    known = foresight(measured(RUNG, 50.0, 0.5), measured(path, 0.0, 0.5))
    assert known.seconds(path, ()) < 10.0


def test_two_bakes_that_took_the_same_do_not_make_large_ones_look_cheap() -> None:
    twice = replace(RUNG, bake_samples=64)
    known = foresight(measured(RUNG, 1.0, 0.5), measured(twice, 1.0, 0.5))
    large = replace(RUNG, resolution=1024, bake_samples=1024)
    assert known.seconds(large, ()) >= 6 * 1024**2 * 1024 * PER_SAMPLE / 2.0


def test_one_bake_does_not_make_larger_ones_look_dear() -> None:
    """Most of a small bake's seconds are spent around its samples."""
    known = foresight(measured(RUNG, 2.0, 0.5))
    larger = replace(RUNG, resolution=128)
    assert known.seconds(larger, ()) - known.seconds(larger, (larger.bake_key,)) < 1.3 * (2.0 + 1.6)


@pytest.mark.parametrize(("seconds", "frames", "expected"), [(0.1, 1, 3), (LONG, 1, 1), (0.1, 3, 3), (60.0, 2, 2)])
def test_only_one_short_frame_is_rendered_again(seconds: float, frames: int, expected: int) -> None:
    assert renders(seconds, frames) == expected


def test_the_ladder_has_each_rung_once_and_relief_only_where_it_can_be_set() -> None:
    for engine in Engine:
        for names in (("NONE", "BOX"), ("NONE", "BOX", "RELIEF")):
            rungs = ladder(engine, names, halves=True)
            assert len(set(rungs)) == len(rungs)
            assert {rung.correction for rung in rungs if rung.kind is Kind.PROBE} == set(names)
            assert all((rung.steps > 0) == (rung.correction == "RELIEF") for rung in rungs)
            assert all(not rung.ray_tracing or engine is Engine.EEVEE for rung in rungs)
            assert any(rung.kind is Kind.SPHERE for rung in rungs) == (engine is Engine.EEVEE)
    assert not any(rung.half_float for rung in ladder(Engine.CYCLES, ("BOX",), halves=False))


def test_two_probes_are_tried_with_the_best_correction_where_there_are_two() -> None:
    rungs = ladder(Engine.EEVEE, ("NONE", "BOX", "RELIEF"), halves=True, pairs=True)
    alone, paired = ([rung for rung in rungs if rung.paired is two] for two in (False, True))
    assert {rung.correction for rung in paired} == {"RELIEF"}
    assert {replace(rung, paired=False) for rung in paired} < set(alone)
    assert all(bake_work(rung) == 2.0 * bake_work(replace(rung, paired=False)) for rung in paired)


def test_what_was_measured_takes_as_long_again() -> None:
    """A line through all that was measured may pass below it, and then the best once more would not end in time."""
    dear = replace(RUNG, resolution=1024)
    known = foresight(
        measured(RUNG, 2.0, 0.5), measured(replace(RUNG, resolution=128), 2.0, 0.5), measured(dear, 90, 5)
    )
    assert known.seconds(dear, ()) >= 95.0
    assert known.seconds(dear, (dear.bake_key,)) < 10.0
    other_frames = replace(dear, frame_samples=64)
    assert known.seconds(other_frames, ()) - known.seconds(other_frames, (dear.bake_key,)) >= 90.0


def test_path_tracing_is_measured_raw_and_denoised_at_all_samples() -> None:
    path = [rung for rung in ladder(Engine.CYCLES, ("BOX",), halves=False) if rung.kind is Kind.PATH]
    assert {(rung.frame_samples, rung.frame_denoise) for rung in path} == {(n, d) for n in SAMPLES for d in (0, 1)}


def test_a_first_frame_of_eevee_is_thought_as_slow_as_its_slowest() -> None:
    path = Settings(Kind.PATH, Engine.EEVEE, "NONE", frame_samples=4)
    sphere = Settings(Kind.SPHERE, Engine.EEVEE, resolution=128, frame_samples=4)
    assert foresight(measured(path, 0.0, 5.0)).seconds(sphere, ()) >= 2 * 5.0  # shaders are compiled in a frame before
