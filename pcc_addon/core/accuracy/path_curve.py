"""What error path tracing reaches in what time, from a few measured points.

Noise falls with the root of the samples, and seconds rise with them: e²(n) = bias² + c²/n and s(n) = start + slope · n.
Raw path tracing by Cycles has no bias, since the truth is made so too; denoisers and EEVEE have one. Both laws are
fitted to the points (least squares of relative misfits). Between two points errors are interpolated along straight
lines of log e over log n, on which the law of pure noise lies, and seconds along straight lines; the fitted laws serve
beyond the last point and below the first.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..probe import Engine
from .front import error_of
from .labels import without_probes
from .lines import Line, fitted
from .records import CostReport, Kind

_TINY = 1e-9  # an error that the correction for noise took to 0 has no logarithm, and no frame takes no time
_SAME = 1e-6  # of a number of samples that was found by halving
_FAR = 2**24  # samples: what Cycles takes


@dataclass(frozen=True)
class PathPoint:
    """Path tracing at some number of samples, measured or between measurements.

    Attributes:
        samples: per pixel, not always whole.
        error: relative RMSE without the truth's noise.
        seconds: of a frame.
        engine: that renders it.
        denoised: whether the picture is.
        measured: whether it lies within what was measured; else the laws say so.
    """

    samples: float
    error: float
    seconds: float
    engine: Engine
    denoised: bool
    measured: bool

    @property
    def name(self) -> str:
        """What the engine does without probes."""
        return without_probes(self.engine)

    @property
    def words(self) -> str:
        """Such as "denoised path tracing"."""
        return f"denoised {self.name}" if self.denoised else self.name


@dataclass(frozen=True)
class PathCurve:
    """Path tracing of one kind: raw or denoised, with or without EEVEE's own ray tracing.

    Attributes:
        points: measured, samples ascending, errors falling and seconds rising: where a measurement with more samples
            had a larger error or less time, by chance, its neighbour's stands for it.
        squared: of the error over 1/samples.
        time: seconds over samples.
        engine, denoised, ray_tracing: as measured.
    """

    points: tuple[PathPoint, ...]
    squared: Line
    time: Line
    engine: Engine
    denoised: bool
    ray_tracing: bool

    def at(self, samples: float) -> PathPoint:
        """At some number of samples."""
        first, last = self.points[0], self.points[-1]
        measured = first.samples * (1.0 - _SAME) <= samples <= last.samples * (1.0 + _SAME)
        if samples < first.samples:
            error = max(first.error, self._law(samples))
            seconds = min(first.seconds, self.time.at(samples))
        elif samples > last.samples:
            error = min(last.error, self._law(samples))
            seconds = max(last.seconds, self.time.at(samples))
        else:
            k = max(1, bisect_left([point.samples for point in self.points], samples))
            if k == len(self.points):
                return last
            error, seconds = _between(self.points[k - 1], self.points[k], samples)
        return PathPoint(samples, error, seconds, self.engine, self.denoised, measured)

    def in_time(self, seconds: float) -> PathPoint | None:
        """The most that a frame of so many seconds can have; None: not even one sample fits."""
        return self._last(lambda point: point.seconds <= seconds)

    def reaching(self, error: float) -> PathPoint | None:
        """The least that reaches an error; None: no number of samples does, as far as the laws say."""
        if self.at(_FAR).error > error:
            return None
        if self.at(1.0).error <= error:
            return self.at(1.0)
        worse = self._last(lambda point: point.error > error)
        assert worse is not None
        return self.at(worse.samples * (1.0 + 1e-9))

    def _law(self, samples: float) -> float:
        return math.sqrt(self.squared.at(1.0 / samples))

    def _last(self, holds: Callable[[PathPoint], bool]) -> PathPoint | None:
        """The point with the most samples of which something holds that holds up to some number; None: of none."""
        if not holds(self.at(1.0)):
            return None
        low, high = 1.0, float(_FAR)
        if holds(self.at(high)):
            return self.at(high)
        while high / low > 1.0 + 1e-10:
            middle = math.sqrt(low * high)
            low, high = (middle, high) if holds(self.at(middle)) else (low, middle)
        return self.at(low)


def path_curves(report: CostReport) -> tuple[PathCurve, ...]:
    """The curves of what was measured without probes, raw before denoised, without ray tracing before with."""
    groups: dict[tuple[str, bool, bool], list[tuple[int, float, float]]] = {}
    for measurement in report.measurements:
        settings = measurement.settings
        if settings.kind is Kind.PATH:
            key = (settings.engine.value, settings.frame_denoise, settings.ray_tracing)
            point = (settings.frame_samples, error_of(report, measurement), measurement.frame_seconds)
            groups.setdefault(key, []).append(point)
    return tuple(_curve(groups[key], Engine(key[0]), *key[1:]) for key in sorted(groups))


def best_in_time(curves: Sequence[PathCurve], seconds: float) -> PathPoint | None:
    """The smallest error that any of them reaches in a frame of so many seconds; None: none is that fast."""
    found = [point for curve in curves if (point := curve.in_time(seconds))]
    return min(found, key=lambda point: (point.error, point.seconds), default=None)


def fastest_to(curves: Sequence[PathCurve], error: float) -> PathPoint | None:
    """The fastest frame of any of them that has at most this error; None: none reaches it."""
    found = [point for curve in curves if (point := curve.reaching(error))]
    return min(found, key=lambda point: (point.seconds, point.error), default=None)


def _curve(measured: list[tuple[int, float, float]], engine: Engine, denoised: bool, ray_tracing: bool) -> PathCurve:
    points: list[PathPoint] = []
    for samples, error, seconds in sorted(measured):
        samples, error, seconds = max(samples, 1), max(error, _TINY), max(seconds, _TINY)
        if points:
            error, seconds = min(error, points[-1].error), max(seconds, points[-1].seconds)
            if samples == points[-1].samples:
                points.pop()
        points.append(PathPoint(float(samples), error, seconds, engine, denoised, True))
    squares = [(1.0 / point.samples, point.error**2) for point in points]
    biased = denoised or engine is not Engine.CYCLES
    if biased and len(points) == 1:
        squared = Line(points[0].error ** 2, 0.0)  # nothing is known of how it improves
    else:
        squared = fitted(squares, through_zero=not biased)
    time = fitted([(point.samples, point.seconds) for point in points])
    return PathCurve(tuple(points), squared, time, engine, denoised, ray_tracing)


def _between(one: PathPoint, other: PathPoint, samples: float) -> tuple[float, float]:
    """Error and seconds between two measured points."""
    share = math.log(samples / one.samples) / math.log(other.samples / one.samples)
    error = math.exp((1.0 - share) * math.log(one.error) + share * math.log(other.error))
    part = (samples - one.samples) / (other.samples - one.samples)
    return error, one.seconds + part * (other.seconds - one.seconds)
