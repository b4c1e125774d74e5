"""What an artist should do, from what was measured, in sentences that hold their numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from . import labels
from .front import error_of
from .metrics import trust_words
from .path_curve import PathCurve, PathPoint, best_in_time, fastest_to, path_curves
from .records import CostReport, Kind, Measurement

_AS_GOOD = 1.05  # errors within this factor count as equal: another seed would change their order
_PRESETS = (("Preview", 2.0), ("Medium", 1.25), ("Final", _AS_GOOD))  # times the best error


class Winner(str, Enum):
    """What to use here."""

    PROBE = "PROBE"
    PATH = "PATH"  # path tracing, without a probe
    UNKNOWN = "UNKNOWN"  # one of them was not measured


@dataclass(frozen=True)
class Preset:
    """One of the three named settings.

    Attributes:
        name: "Preview", "Medium" or "Final".
        measurement: the probe's rung, as an index of the report's measurements.
        sentence: it in words.
    """

    name: str
    measurement: int
    sentence: str


@dataclass(frozen=True)
class Advice:
    """What follows from a report.

    Attributes:
        recommended: the probe's rung to set, as an index of the measurements; None: no probe was measured.
        meets_target: whether its error is at most the target; None: none was asked for.
        winner: what to use.
        same_error: path tracing that has the same error in the least time; None: none reaches it, or none was measured.
        same_time: path tracing in the same seconds a frame; None: not even one sample fits, or none was measured.
        paid_after: frames after which bake and frames with the probe take no longer than path tracing to the same
            error; None: never, or there is nothing to compare.
        sentences: all of this in words, the most important first.
        presets: of the probe; empty where none was measured.
    """

    recommended: int | None
    meets_target: bool | None
    winner: Winner
    same_error: PathPoint | None
    same_time: PathPoint | None
    paid_after: int | None
    sentences: tuple[str, ...]
    presets: tuple[Preset, ...]


def advice(report: CostReport) -> Advice:
    """What follows from a report.

    The rung is the one with the least seconds for all frames, its bake included, among those that meet the target;
    where none does, or no target was asked for, among those within 5 % of the smallest error that the budget allows
    (bake and one frame of it). No other rung of the probe is better in one of error, bake and frame seconds and as good
    in the others. Errors are without the truth's noise, and path tracing is the better of raw and denoised.

    Path tracing wins where the bake never pays for itself, or not within the frames that the artist plans: at the
    error of the rung, or at the target where the rung meets one.
    """
    curves = path_curves(report)
    chosen = _chosen(report)
    if chosen is None:
        sentence = "No setting of the probe was measured, so there is nothing to recommend: give more seconds."
        return Advice(None, None, Winner.UNKNOWN, None, None, None, (sentence,), ())
    rung = report.measurements[chosen]
    reached = error_of(report, rung)
    meets = None if report.target is None else reached <= report.target
    same_error = fastest_to(curves, reached)
    same_time = best_in_time(curves, rung.frame_seconds)
    paid = _paid_after(rung, same_error)
    enough = fastest_to(curves, report.target) if meets and report.target is not None else same_error
    winner = _winner(report, curves, enough, _paid_after(rung, enough))
    recommendation = _recommendation(report, rung, meets)
    comparison = tuple(_comparison(report, curves, rung, winner, _Rivals(same_error, enough, same_time, paid)))
    first = comparison[:1] if winner is Winner.PATH else ()
    sentences = (
        *first,
        recommendation,
        *comparison[len(first) :],
        *_elsewhere(report, curves, rung, winner),
        *_spheres(report, rung),
        *_moving(report, rung),
        *_doubts(report, rung),
    )
    return Advice(chosen, meets, winner, same_error, same_time, paid, sentences, tuple(_presets(report)))


@dataclass(frozen=True)
class _Rivals:
    """Path tracing to compare a rung with: at its error, good enough for the target, in its time, and who pays when."""

    same_error: PathPoint | None
    enough: PathPoint | None
    same_time: PathPoint | None
    paid_after: int | None


def frames_of(report: CostReport) -> int:
    """How many frames bakes are shared by: those the artist plans, or else those that were measured."""
    return max(report.planned or len(report.frames), 1)


def _probes(report: CostReport) -> list[int]:
    return [i for i, m in enumerate(report.measurements) if m.settings.kind is Kind.PROBE]


def _total(report: CostReport, rung: Measurement) -> float:
    return rung.bake_seconds + frames_of(report) * rung.frame_seconds


def _cheapest(report: CostReport, places: Sequence[int], key: Callable[[Measurement], tuple[float, ...]]) -> int:
    return min(places, key=lambda i: (*key(report.measurements[i]), i))


def _chosen(report: CostReport) -> int | None:
    """The rung to recommend; ties in total time go to the smaller error, so that no rung beats it in all."""
    probes = _probes(report)
    if not probes:
        return None
    error = {i: error_of(report, report.measurements[i]) for i in probes}
    good = [i for i in probes if report.target is not None and error[i] <= report.target]
    if not good:
        within = _within_budget(report, probes) or probes
        good = [i for i in within if error[i] <= _AS_GOOD * min(error[k] for k in within)]
    return _cheapest(report, good, lambda m: (_total(report, m), error_of(report, m)))


def _within_budget(report: CostReport, places: Sequence[int]) -> list[int]:
    if report.budget is None:
        return list(places)
    measured = report.measurements
    return [i for i in places if measured[i].bake_seconds + measured[i].frame_seconds <= report.budget]


def _paid_after(rung: Measurement, rival: PathPoint | None) -> int | None:
    if rival is None or rival.seconds <= rung.frame_seconds:
        return None
    return max(1, math.ceil(rung.bake_seconds / (rival.seconds - rung.frame_seconds)))


def _winner(
    report: CostReport, curves: Sequence[PathCurve], enough: PathPoint | None, paid_after: int | None
) -> Winner:
    if not curves:
        return Winner.UNKNOWN
    if enough is None:
        return Winner.PROBE
    if paid_after is None or (report.planned is not None and report.planned < paid_after):
        return Winner.PATH
    return Winner.PROBE


def _recommendation(report: CostReport, rung: Measurement, meets: bool | None) -> str:
    target, budget = labels.error(report.target or 0.0), labels.seconds(report.budget or 0.0)
    costs = f"it bakes in {labels.seconds(rung.bake_seconds)} and takes {labels.seconds(rung.frame_seconds)} a frame"
    what = f"{labels.label(rung.settings)}: error {labels.error(error_of(report, rung))}; {costs}."
    if meets:
        return f"The cheapest setting of the probe that meets the target of {target} is {what}"
    within = report.budget is None or rung.bake_seconds + rung.frame_seconds <= report.budget
    limit = f" within {budget}" if report.budget is not None and within else ""
    begin = (
        "The best setting of the probe" if meets is None else f"No setting of the probe meets the target of {target}"
    )
    if not within:
        begin += f" that was measured, none of them within {budget}," if meets is None else f", and none fits {budget}"
    return f"{begin}{limit} is {what}" if meets is None else f"{begin}; the best{limit} is {what}"


def _comparison(
    report: CostReport, curves: Sequence[PathCurve], rung: Measurement, winner: Winner, rivals: _Rivals
) -> Iterator[str]:
    error, frame, bake = _told(report, rung)
    if winner is Winner.UNKNOWN:
        yield "Frames without the probe were not measured, so whether the bake pays for itself is not known."
        return
    if winner is Winner.PATH:
        assert rivals.enough is not None  # otherwise the probe wins
        why = _why_path_wins(report, rung, rivals.enough, rivals)
        yield f"{_capital(rivals.enough.name)} wins here, because {why}."
    if rivals.same_error is None:
        best = min((curve.points[-1] for curve in curves), key=lambda point: point.error)
        yield (
            f"Nothing without the probe came to its error of {error}, and none would with more samples, as far as the "
            f"measurements tell; the best was {best.words} with {labels.error(best.error)} in "
            f"{labels.seconds(best.seconds)} a frame."
        )
    elif rivals.paid_after is not None:
        yield (
            f"The bake of {bake} has paid for itself after {labels.counted(rivals.paid_after, 'frame')}: "
            f"{rivals.same_error.words} takes {_taken(rivals.same_error)} a frame to the same error of {error}, the "
            f"probe {frame}."
        )
    if rivals.same_time is None:
        name = _capital(curves[0].points[0].name)
        yield f"{name} has no picture at all in the {frame} that a frame takes with the probe."
    elif rivals.same_time.error > error_of(report, rung):
        yield (
            f"In the same {frame} a frame {rivals.same_time.words} has an error of "
            f"{labels.error(rivals.same_time.error)}{_how_known(rivals.same_time)}, the probe {error}."
        )


def _told(report: CostReport, rung: Measurement) -> tuple[str, str, str]:
    """Error, frame and bake seconds in words."""
    return (
        labels.error(error_of(report, rung)),
        labels.seconds(rung.frame_seconds),
        labels.seconds(rung.bake_seconds),
    )


def _capital(words: str) -> str:
    return words[0].upper() + words[1:]


def _why_path_wins(report: CostReport, rung: Measurement, enough: PathPoint, rivals: _Rivals) -> str:
    """From the numbers: too few frames, a target that needs no probe, the probe's least error, or no gain in time."""
    error, frame, bake = _told(report, rung)
    same_time = rivals.same_time
    if enough.seconds > rung.frame_seconds:
        frames = report.planned or 0
        few = f"{labels.counted(frames, 'frame')} {'is' if frames == 1 else 'are'} too few for a bake of {bake}"
        return (
            f"{few}: {enough.words} with an error of {labels.error(enough.error)} is done with all of them in "
            f"{labels.seconds(frames * enough.seconds)}, the probe in {labels.seconds(_total(report, rung))}"
        )
    if rivals.same_error is None or rivals.same_error.seconds > rung.frame_seconds:
        return (
            f"it meets the target of {labels.error(report.target or 0.0)} in {_taken(enough)} a frame "
            f"({enough.words}), and the probe, whose error is {error}, takes {frame}"
        )
    assert same_time is not None  # path tracing that is as good takes no longer, so it fits
    floor = min(error_of(report, report.measurements[i]) for i in _probes(report))
    reached = f"{same_time.words} reaches {labels.error(same_time.error)} in the same {frame} a frame"
    if floor > same_time.error:
        settings = labels.counted(len(_probes(report)), "measured setting")
        return (
            f"the probe's error stays at {labels.error(floor)} or above in all of {settings}, and {reached}"
            f"{_how_known(same_time)}"
        )
    return (
        f"a frame with the probe is no cheaper ({frame}; {rivals.same_error.words} has the same error in "
        f"{_taken(rivals.same_error)}) and at equal time its error is no smaller: {error}, where {reached}"
        f"{_how_known(same_time)}"
    )


def _taken(point: PathPoint) -> str:
    return f"{labels.seconds(point.seconds)}{_how_known(point)}"


def _how_known(point: PathPoint) -> str:
    if point.measured:
        return ""
    return f" (extrapolated to {labels.counted(max(1, round(point.samples)), 'sample')})"


def _elsewhere(report: CostReport, curves: Sequence[PathCurve], chosen: Measurement, winner: Winner) -> Iterator[str]:
    """Where path tracing wins at the recommended error: the smallest error at which the probe's frame is cheaper."""
    if winner is not Winner.PATH or not curves:
        return
    rungs = [report.measurements[i] for i in _probes(report)]
    pays = [(rung, rival) for rung in rungs if (rival := fastest_to(curves, error_of(report, rung)))]
    cheaper = [
        (rung, rival)
        for rung, rival in pays
        if rung is not chosen
        and (paid := _paid_after(rung, rival)) is not None
        and (report.planned is None or paid <= report.planned)
    ]
    if cheaper:
        rung, rival = min(cheaper, key=lambda pair: (error_of(report, pair[0]), _total(report, pair[0])))
        error, frame, bake = _told(report, rung)
        yield (
            f"At an error of {error} the probe wins: {labels.label(rung.settings)} takes {frame} a frame, "
            f"{rival.words} {_taken(rival)}; its bake of {bake} has paid for itself after "
            f"{labels.counted(_paid_after(rung, rival) or 0, 'frame')}."
        )


def _spheres(report: CostReport, rung: Measurement) -> Iterator[str]:
    spheres = [m for m in report.measurements if m.settings.kind is Kind.SPHERE]
    if spheres:
        best = min(spheres, key=lambda m: (m.rmse, m.frame_seconds))
        yield (
            f"Blender's own sphere probe has an error of {labels.error(error_of(report, best))} at its best "
            f"({labels.of_sphere(best.settings)}, {labels.seconds(best.frame_seconds)} a frame); this probe "
            f"{labels.error(error_of(report, rung))}."
        )


def _moving(report: CostReport, rung: Measurement) -> Iterator[str]:
    if rung.flicker is None:
        return
    rivals = [m for m in report.measurements if m.settings.kind is Kind.PATH and m.flicker is not None]
    near = min(rivals, key=lambda m: abs(m.frame_seconds - rung.frame_seconds), default=None)
    other = (
        f"; {labels.of_frame(near.settings)}, {labels.seconds(near.frame_seconds)} a frame, by "
        f"{labels.error(near.flicker or 0.0)}"
        if near
        else ""
    )
    yield f"From frame to frame its changes are off by {labels.error(rung.flicker)} of the truth's own{other}."


def _doubts(report: CostReport, rung: Measurement) -> Iterator[str]:
    words = trust_words(rung.rmse, report.truth.noise)
    if words:
        yield f"How far to trust this: {words}."


def _presets(report: CostReport) -> Iterator[Preset]:
    """The least bake within some factor of the best error: nested sets, so that presets cost more and more."""
    probes = _probes(report)
    best = min(error_of(report, report.measurements[i]) for i in probes)
    for name, factor in _PRESETS:
        good = [i for i in probes if error_of(report, report.measurements[i]) <= factor * best]
        place = _cheapest(report, good, lambda m: (m.bake_seconds, m.frame_seconds, error_of(report, m)))
        rung = report.measurements[place]
        yield Preset(
            name,
            place,
            f"{name}: {labels.label(rung.settings)}; error {labels.error(error_of(report, rung))}, bakes in "
            f"{labels.seconds(rung.bake_seconds)}, {labels.seconds(rung.frame_seconds)} a frame.",
        )
