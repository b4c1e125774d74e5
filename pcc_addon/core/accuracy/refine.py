"""Which rung to measure next: coarse ones first, then those beside the front, as long as seconds are left.

The same measurements and the same seconds left give the same answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, replace
from typing import Any

from .front import Axis, front
from .records import CostReport, Kind, Settings
from .times import Times, bake_work

_ENOUGH = 2**31
_TINY = 1e-12


def next_rung(report: CostReport, ladder: Sequence[Settings], left: float) -> Settings | None:
    """The rung to measure next.

    First the cheapest rung of each way to make a picture (correction, denoising, precision, path tracing …) and a
    dearer one of each with a probe, of a twentieth of the seconds left; then path tracing with more and more samples
    until it is as good as the best probe or would take more than a tenth of the seconds left; then rungs one step away
    from those on a front, beginning at the smallest error and with the knob whose last step took most off it, but not
    where that has brought next to nothing; then the others, cheapest first. What will not be done within the seconds
    left is left out; while nothing like a rung was measured, its seconds are unknown and it counts as done in time.

    Args:
        report: what has been measured, in any order.
        ladder: all rungs, as many as one likes.
        left: seconds that may be spent.

    Returns:
        None where no rung is left that fits.
    """
    done = {measurement.settings for measurement in report.measurements}
    price = _Prices(report)
    if left <= 0.0:
        return None
    open_rungs = [rung for rung in ladder if rung not in done and (price.of(rung) or 0.0) <= left]

    def within(seconds: float) -> list[Settings]:
        return [rung for rung in open_rungs if (price.of(rung) or 0.0) <= seconds]

    order = {rung: (price.key(rung), ladder.index(rung)) for rung in open_rungs}
    ways = {_way(rung) for rung in done}
    for candidates in (
        [rung for rung in open_rungs if _way(rung) not in ways],
        _middles(ladder, done, within(0.05 * left)),
        _rivals(report, within(0.1 * left)),
    ):
        if candidates:
            return min(candidates, key=order.__getitem__)
    for beside in _beside(report, ladder, open_rungs):
        if beside:
            return min(beside, key=lambda rung: (-beside[rung], order[rung]))
    return min(open_rungs, key=order.__getitem__, default=None)


class _Prices:
    """Seconds that measuring takes, bakes that were done already left out."""

    def __init__(self, report: CostReport) -> None:
        self.times = Times.fitted_to(report.measurements)
        self.frames = max(len(report.frames), 1)
        self.baked = {measurement.settings.bake_key for measurement in report.measurements}

    def of(self, rung: Settings) -> float | None:
        bake = 0.0 if rung.bake_key in self.baked else self.times.bake(rung)
        frame = self.times.frame(rung)
        return None if bake is None or frame is None else bake + self.frames * frame

    def key(self, rung: Settings) -> tuple[float, float, int]:
        """Ascending: what is known to be cheap, then what is little work."""
        price = self.of(rung)
        return (0.0 if price is None else price, bake_work(rung), rung.frame_samples)


def _way(rung: Settings) -> tuple:
    """What kind of picture a rung makes, apart from its numbers."""
    return astuple(replace(rung, resolution=0, bake_samples=0, steps=0, refinements=0, frame_samples=0))


def _middles(ladder: Sequence[Settings], done: set[Settings], cheap: list[Settings]) -> list[Settings]:
    """Of each way with a probe that was measured once: the most work that is cheap, up to the middle of the ladder."""
    found = []
    for way in sorted({_way(rung) for rung in cheap if rung.kind is not Kind.PATH}):
        if sum(_way(rung) == way for rung in done) == 1:
            work = sorted(bake_work(rung) for rung in ladder if _way(rung) == way)
            up_to = [rung for rung in cheap if _way(rung) == way and bake_work(rung) <= work[len(work) // 2]]
            if up_to:
                found.append(max(up_to, key=lambda rung: (bake_work(rung), rung.resolution, -ladder.index(rung))))
    return found


def _rivals(report: CostReport, cheap: list[Settings]) -> list[Settings]:
    """Of each way without a probe that is not as good yet as the best probe: the next rung with more samples."""
    best = front(report, Axis.FRAME)[-1:]
    if not best:
        return []
    goal = report.measurements[best[0]].rmse
    most: dict[tuple, int] = {}
    for measurement in report.measurements:
        way, samples = _way(measurement.settings), measurement.settings.frame_samples
        if measurement.settings.kind is Kind.PATH:
            most[way] = max(samples if measurement.rmse > goal else _ENOUGH, most.get(way, 0))
    found: dict[tuple, Settings] = {}
    for rung in sorted(cheap, key=lambda rung: rung.frame_samples):
        if rung.kind is Kind.PATH and rung.frame_samples > most.get(_way(rung), _ENOUGH):
            found.setdefault(_way(rung), rung)
    return list(found.values())


def _beside(report: CostReport, ladder: Sequence[Settings], open_rungs: list[Settings]) -> list[dict[Settings, float]]:
    """For each rung on a front, the best first, the open rungs that are one step of one knob away, with what they
    promise: by what factor the step before in that direction made the error smaller, 1 where there was none.

    Not those in whose direction the step before, which was measured, took less than 3 % off the error.
    """
    on_fronts = {i for axis in Axis for i in front(report, axis)}
    best_first = sorted(on_fronts, key=lambda i: (report.measurements[i].rmse, i))
    errors = {measurement.settings: measurement.rmse for measurement in report.measurements}
    found = []
    for place in best_first:
        rung = report.measurements[place].settings
        alike = [other for other in {*ladder, *errors} if _family(other) == _family(rung)]
        values = [sorted({_knobs(other)[k] for other in alike}) for k in range(len(_knobs(rung)))]
        steps = {other: step for other in alike if (step := _step(rung, other, values))}
        gains = {
            (knob, -way): errors[other] / max(errors[rung], _TINY)
            for other, (knob, way) in steps.items()
            if other in errors
        }
        promised = {other: gains.get(steps[other], 1.0) for other in open_rungs if other in steps}
        flat = {step for step, gain in gains.items() if gain < 1.0 / 0.97}
        found.append({other: gain for other, gain in promised.items() if steps[other] not in flat})
    return found


def _family(rung: Settings) -> tuple:
    return (rung.kind, rung.engine, rung.correction, rung.ray_tracing)


def _knobs(rung: Settings) -> tuple:
    """What may be stepped; steps and refinements of a march belong together."""
    march = (rung.steps, rung.refinements)
    choices = (rung.bake_denoise, rung.half_float, rung.bake_adaptive, rung.fitted, rung.paired, rung.frame_denoise)
    return (rung.resolution, rung.bake_samples, march, rung.frame_samples, *choices)


def _step(one: Settings, other: Settings, values: list[list[Any]]) -> tuple[int, int] | None:
    """Which knob, and up (1) or down (−1), leads to another rung; None: more than one step does."""
    before, after = _knobs(one), _knobs(other)
    different = [k for k in range(len(before)) if before[k] != after[k]]
    if len(different) != 1:
        return None
    (knob,) = different
    way = values[knob].index(after[knob]) - values[knob].index(before[knob])
    return (knob, way) if abs(way) == 1 else None
