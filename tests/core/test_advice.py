"""What a report recommends, and whether its reasons are true."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.accuracy import labels
from pcc_addon.core.accuracy.advice import Winner, advice, frames_of
from pcc_addon.core.accuracy.front import error_of, undominated
from pcc_addon.core.accuracy.path_curve import best_in_time, fastest_to, path_curves
from pcc_addon.core.accuracy.records import CostReport, Kind, Measurement, Settings
from pcc_addon.core.probe import Engine

from .cost_reports import PROBE, example, path, probe, report

few = st.integers(1, 8)
probes = st.builds(lambda e, b, f: probe(e / 20, b * 5.0, f * 1.0), few, few, few)
paths = st.builds(lambda k, e, f, on: path(4**k, e / 20, f / 2, on), st.integers(0, 4), few, few, st.booleans())
reports = st.builds(
    lambda ones, others, target, budget, planned, noise: report(
        *ones, *others, target=target, budget=budget, planned=planned, noise=noise
    ),
    st.lists(probes, max_size=8),
    st.lists(paths, max_size=6),
    st.none() | st.floats(0.01, 0.5),
    st.none() | st.floats(1.0, 60.0),
    st.none() | st.integers(1, 12),
    st.sampled_from([0.0, 0.04]),
)


@given(reports)
def test_no_dominated_rung_is_ever_recommended(found: CostReport) -> None:
    result = advice(found)
    measured = found.measurements
    values = [(error_of(found, m), m.bake_seconds, m.frame_seconds) for m in measured]
    front = {values[i] for i in undominated(found)}
    chosen = [*([] if result.recommended is None else [result.recommended]), *(p.measurement for p in result.presets)]
    for i in chosen:
        assert measured[i].settings.kind is Kind.PROBE and values[i] in front
    assert (result.recommended is None) == (not front)


@given(reports)
def test_a_target_is_met_by_the_least_seconds_or_by_none(found: CostReport) -> None:
    result = advice(found)
    if found.target is None or result.recommended is None:
        assert result.meets_target is None
        return
    frames = frames_of(found)
    rungs = [m for m in found.measurements if m.settings.kind is Kind.PROBE]
    good = [m for m in rungs if error_of(found, m) <= found.target]
    chosen = found.measurements[result.recommended]
    assert result.meets_target == bool(good) == (chosen in good)
    if good:
        least = min(m.bake_seconds + frames * m.frame_seconds for m in good)
        assert chosen.bake_seconds + frames * chosen.frame_seconds == least
        assert any("meets the target" in sentence for sentence in result.sentences)
    else:
        assert any("No setting of the probe meets the target" in sentence for sentence in result.sentences)


@given(reports)
def test_paid_after_is_where_the_sums_meet(found: CostReport) -> None:
    result = advice(found)
    if result.paid_after is None:
        return
    assert result.recommended is not None and result.same_error is not None
    rung, n = found.measurements[result.recommended], result.paid_after
    assert rung.bake_seconds + n * rung.frame_seconds <= n * result.same_error.seconds * (1 + 1e-9)
    if n > 1:
        assert rung.bake_seconds + (n - 1) * rung.frame_seconds > (n - 1) * result.same_error.seconds * (1 - 1e-9)
    assert result.same_error.error <= error_of(found, rung) * (1 + 1e-9) + 1e-8


@given(reports)
def test_the_winner_is_who_takes_less_time(found: CostReport) -> None:
    """Recomputed from the curves: at the target where it is met, else at the rung's own error."""
    result = advice(found)
    curves = path_curves(found)
    if result.recommended is None or not curves:
        assert result.winner is Winner.UNKNOWN
        return
    rung = found.measurements[result.recommended]
    wanted = found.target if result.meets_target and found.target is not None else error_of(found, rung)
    rival = fastest_to(curves, wanted)
    if rival is None:
        assert result.winner is Winner.PROBE
    elif rival.seconds <= rung.frame_seconds:
        assert result.winner is Winner.PATH
    elif found.planned is None:
        assert result.winner is Winner.PROBE
    else:
        with_probe = rung.bake_seconds + found.planned * rung.frame_seconds
        if not math.isclose(with_probe, found.planned * rival.seconds, rel_tol=1e-9):
            assert (result.winner is Winner.PROBE) == (with_probe < found.planned * rival.seconds)


@given(reports)
def test_the_reason_why_path_tracing_wins_is_true(found: CostReport) -> None:
    result = advice(found)
    told = [sentence for sentence in result.sentences if sentence.startswith("Path tracing wins here")]
    assert len(told) == (result.winner is Winner.PATH)
    if not told:
        return
    assert result.sentences[0] == told[0] and result.recommended is not None
    rung = found.measurements[result.recommended]
    errors = [error_of(found, m) for m in found.measurements if m.settings.kind is Kind.PROBE]
    reached = best_in_time(path_curves(found), rung.frame_seconds)
    if "the probe's error stays at" in told[0]:
        assert reached is not None and min(errors) > reached.error
        assert labels.error(min(errors)) in told[0] and labels.error(reached.error) in told[0]
    elif "is no cheaper" in told[0]:
        assert reached is not None and reached.error <= error_of(found, rung) * (1 + 1e-9) + 1e-8
        assert result.same_error is not None and result.same_error.seconds <= rung.frame_seconds
    elif "are too few" in told[0] or "is too few" in told[0]:
        assert found.planned is not None and str(found.planned) in told[0]
    else:
        assert "meets the target" in told[0] and result.meets_target


def only(measurements: list[Measurement], **more: object) -> CostReport:
    return report(*measurements, **more)


PATHS = [path(n, 0.4 / math.sqrt(n), 0.1 * n) for n in (4, 16, 64)]  # 20 % in 0.4 s, 5 % in 6.4 s


def test_the_bake_pays_for_itself() -> None:
    """5 % takes path tracing 6.4 s; the probe takes 1.4 s a frame and 20 s before: four frames."""
    result = advice(only([probe(0.05, 20.0, 1.4), *PATHS]))
    assert (result.winner, result.paid_after) == (Winner.PROBE, 4)
    assert result.same_error is not None and result.same_error.seconds == pytest.approx(6.4)
    assert result.same_time is not None and result.same_time.error == pytest.approx(0.4 / math.sqrt(14))
    assert result.sentences == (
        "The best setting of the probe is box, 256 px faces, 64 samples denoised; frame 64 samples: error 5.0 %; it "
        "bakes in 20 s and takes 1.4 s a frame.",
        "The bake of 20 s has paid for itself after 4 frames: path tracing takes 6.4 s a frame to the same error of "
        "5.0 %, the probe 1.4 s.",
        "In the same 1.4 s a frame path tracing has an error of 11 %, the probe 5.0 %.",
    )


def test_the_better_of_raw_and_denoised_is_the_rival() -> None:
    denoised = [path(n, math.hypot(0.03, 0.1 / math.sqrt(n)), 0.3 + 0.1 * n, True) for n in (1, 4, 16)]
    result = advice(only([probe(0.05, 20.0, 0.5), *PATHS, *denoised]))
    assert result.same_error is not None and result.same_error.denoised
    assert result.same_error.seconds < 1.5
    assert "denoised path tracing takes" in result.sentences[1]


def test_too_few_frames_are_path_traced() -> None:
    found = only([probe(0.05, 20.0, 1.4), *PATHS], planned=3)
    result = advice(found)
    assert (result.winner, result.paid_after) == (Winner.PATH, 4)
    assert result.sentences[0] == (
        "Path tracing wins here, because 3 frames are too few for a bake of 20 s: path tracing with an error of 5.0 % "
        "is done with all of them in 19 s, the probe in 24 s."
    )
    assert advice(replace(found, planned=4)).winner is Winner.PROBE


def test_one_frame_is_too_few_in_good_english() -> None:
    assert "1 frame is too few" in advice(only([probe(0.05, 20.0, 1.4), *PATHS], planned=1)).sentences[0]


def test_path_tracing_wins_where_the_probes_error_has_a_floor() -> None:
    result = advice(only([probe(0.30, 20.0, 6.4), probe(0.31, 5.0, 6.4), *PATHS]))
    assert result.winner is Winner.PATH and result.paid_after is None
    assert result.sentences[0] == (
        "Path tracing wins here, because the probe's error stays at 30 % or above in all of 2 measured settings, and "
        "path tracing reaches 5.0 % in the same 6.4 s a frame."
    )


def test_path_tracing_wins_where_the_frame_is_no_cheaper() -> None:
    """Another rung has 4 %, so the floor is not the reason: this one's frame is slow."""
    fine = probe(0.04, 90.0, 9.0, replace(PROBE, resolution=1024))
    result = advice(only([probe(0.1, 20.0, 2.0), fine, *PATHS], target=0.1))
    assert result.winner is Winner.PATH
    assert (
        "a frame with the probe is no cheaper (2.0 s; path tracing has the same error in 1.6 s)" in result.sentences[0]
    )
    assert "At an error of 4.0 % the probe wins" in " ".join(result.sentences)


def test_a_target_may_need_no_probe_though_the_probe_is_better() -> None:
    result = advice(only([probe(0.02, 20.0, 2.0), *PATHS], target=0.2))
    assert result.winner is Winner.PATH and result.paid_after is not None
    assert result.sentences[0] == (
        "Path tracing wins here, because it meets the target of 20 % in 0.4 s a frame (path tracing), and the probe, "
        "whose error is 2.0 %, takes 2.0 s."
    )


def test_the_cheapest_that_meets_the_target_depends_on_the_frames() -> None:
    quick, frugal = probe(0.05, 10.0, 2.0), probe(0.04, 50.0, 1.0, replace(PROBE, resolution=512))
    assert advice(only([quick, frugal, *PATHS], target=0.06, planned=5)).recommended == 0
    assert advice(only([quick, frugal, *PATHS], target=0.06, planned=100)).recommended == 1
    assert advice(only([quick, frugal, *PATHS], target=0.045, planned=5)).recommended == 1


def test_the_best_within_the_budget() -> None:
    quick, frugal = probe(0.08, 10.0, 2.0), probe(0.04, 50.0, 1.0, replace(PROBE, resolution=512))
    assert advice(only([quick, frugal])).recommended == 1
    assert advice(only([quick, frugal], budget=30.0)).recommended == 0
    assert "within 30 s" in advice(only([quick, frugal], budget=30.0)).sentences[0]
    nothing_fits = advice(only([quick, frugal], budget=1.0))
    assert nothing_fits.recommended == 1
    assert "that was measured, none of them within 1.0 s, is box" in nothing_fits.sentences[0]
    both = advice(only([quick, frugal], budget=30.0, target=0.01)).sentences[0]
    assert both.startswith("No setting of the probe meets the target of 1.0 %; the best within 30 s is box, 256 px")
    neither = advice(only([quick, frugal], budget=1.0, target=0.01)).sentences[0]
    assert neither.startswith("No setting of the probe meets the target of 1.0 %, and none fits 1.0 s; the best is box")


def test_errors_that_another_seed_would_swap_count_as_equal() -> None:
    quick, fine = probe(0.0410, 10.0, 1.0), probe(0.0400, 50.0, 1.0, replace(PROBE, resolution=512))
    assert advice(only([quick, fine])).recommended == 0


def test_without_a_probe_or_a_rival_nothing_is_compared() -> None:
    empty, alone = advice(only(PATHS)), advice(only([probe(0.05, 20.0, 1.4)]))
    assert empty.winner is alone.winner is Winner.UNKNOWN
    assert empty.recommended is None and empty.presets == ()
    assert "nothing to recommend" in empty.sentences[0]
    assert "Frames without the probe were not measured" in alone.sentences[1]


def test_what_nothing_else_reaches() -> None:
    blurred = [path(n, 0.1, 0.1 * n, True) for n in (4, 16)]
    result = advice(only([probe(0.05, 20.0, 1.4), *blurred]))
    assert result.winner is Winner.PROBE and result.same_error is None
    assert "Nothing without the probe came to its error of 5.0 %" in result.sentences[1]


def test_a_frame_that_path_tracing_cannot_make_at_all() -> None:
    result = advice(only([probe(0.3, 2.0, 0.01), *PATHS]))
    assert result.same_time is None and "no picture at all in the 0.01 s" in " ".join(result.sentences)


def test_extrapolated_numbers_say_so() -> None:
    assert "(extrapolated to 1600 samples)" in advice(only([probe(0.01, 20.0, 1.4), *PATHS])).sentences[1]


def test_blenders_own_sphere_probe_is_told_of() -> None:
    sphere = Measurement(Settings(Kind.SPHERE, Engine.EEVEE, resolution=256), 0.4, 0.2, None, 1.0, 0.1)
    told = " ".join(advice(only([probe(0.05, 20.0, 1.4), sphere])).sentences)
    words = "an error of 40 % at its best (with a box, 256 px, 0.1 s a frame); this probe 5.0 %."
    assert f"Blender's own sphere probe has {words}" in told


def test_moving_pictures_are_told_of_beside_path_tracing_of_the_same_time() -> None:
    moving = [replace(one, flicker=0.5) for one in PATHS]
    told = advice(only([replace(probe(0.05, 20.0, 1.4), flicker=0.08), *moving])).sentences[-1]
    assert told == (
        "From frame to frame its changes are off by 8.0 % of the truth's own; path tracing, 16 samples, 1.6 s a frame, "
        "by 50 %."
    )


def test_doubtful_errors_are_told_of() -> None:
    clear, blurred = (advice(only([probe(0.05, 20.0, 1.4)], noise=noise)) for noise in (0.01, 0.04))
    assert "trust" not in " ".join(clear.sentences)
    assert "64% of the measured error's square is noise of the truth itself" in blurred.sentences[-1]


def test_what_is_lost_in_noise_is_not_taken_for_perfect() -> None:
    """Errors below the truth's noise count as the least that can be told, so that path tracing can equal them."""
    good = [path(n, 0.4 / math.sqrt(n), 0.1 * n) for n in (4, 16, 64, 256, 1024)]
    found = only([probe(0.01, 20.0, 1.4), *good], noise=0.012)
    result = advice(found)
    assert error_of(found, found.measurements[0]) == pytest.approx(0.012 * math.sqrt(0.21))
    assert result.same_error is not None and result.same_error.error == pytest.approx(0.0055, rel=0.01)
    assert "how small only a truth with more samples can tell" in result.sentences[-1]


def test_eevee_without_probes_is_called_so() -> None:
    eevee = [path(n, 0.2, 0.1 * n, engine=Engine.EEVEE) for n in (4, 16)]
    told = advice(only([probe(0.3, 20.0, 1.4), *eevee])).sentences[0]
    assert told.startswith("EEVEE without probes wins here, because the probe's error stays at 30 % or above")


def test_presets_go_from_cheap_to_good() -> None:
    found = example()
    presets = advice(found).presets
    rungs = [found.measurements[preset.measurement] for preset in presets]
    assert [preset.name for preset in presets] == ["Preview", "Medium", "Final"]
    assert [m.bake_seconds for m in rungs] == sorted(m.bake_seconds for m in rungs)
    assert rungs[0].bake_seconds < rungs[2].bake_seconds / 10
    errors = [error_of(found, m) for m in rungs]
    best = min(error_of(found, m) for m in found.measurements if m.settings.kind is Kind.PROBE)
    assert errors[0] <= 2.0 * best and errors[1] <= 1.25 * best and errors[2] <= 1.05 * best
    assert presets[2].sentence.startswith("Final: relief (16 steps, 6 refinements), ")


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.0042, "0.0042 s"),
        (0.42, "0.42 s"),
        (0.9999, "1.0 s"),
        (1.44, "1.4 s"),
        (9.99, "10 s"),
        (119.0, "119 s"),
        (119.6, "2 min"),
        (200.0, "3 min 20 s"),
        (3599.7, "1 h"),
        (7500.0, "2 h 5 min"),
    ],
)
def test_seconds_in_words(value: float, words: str) -> None:
    assert labels.seconds(value) == words


@pytest.mark.parametrize(
    ("value", "words"),
    [(0.0, "0 %"), (0.00042, "0.042 %"), (0.009, "0.9 %"), (0.0412, "4.1 %"), (0.0996, "10 %"), (1.25, "125 %")],
)
def test_errors_in_words(value: float, words: str) -> None:
    assert labels.error(value) == words
