"""The front of error against time: the rungs that no other beats in both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum

from .metrics import least_error, without_noise
from .records import CostReport, Kind, Measurement


class Axis(str, Enum):
    """Which seconds an error is weighed against."""

    BAKE = "BAKE"
    FRAME = "FRAME"

    def of(self, measurement: Measurement) -> float:
        """Those seconds of a measurement."""
        return measurement.bake_seconds if self is Axis.BAKE else measurement.frame_seconds


def pareto(points: Sequence[tuple[float, ...]]) -> tuple[int, ...]:
    """The points that no other equals or beats in every coordinate and beats in one.

    Of equal points the first counts alone.

    Returns:
        their indices, in ascending order of the coordinates.
    """
    order = sorted(range(len(points)), key=lambda i: (points[i], i))
    kept: list[int] = []
    for i in order:  # whatever dominates a point, or equals it, comes before it
        if not any(all(a <= b for a, b in zip(points[j], points[i], strict=True)) for j in kept):
            kept.append(i)
    return tuple(kept)


def front(report: CostReport, axis: Axis) -> tuple[int, ...]:
    """The probe's rungs on the front of `axis` against error, cheapest first, as indices of the measurements."""
    return _front(report, lambda m: (axis.of(m), error_of(report, m)))


def undominated(report: CostReport) -> tuple[int, ...]:
    """The probe's rungs that no other beats in bake seconds, frame seconds and error together, as indices."""
    return _front(report, lambda m: (m.bake_seconds, m.frame_seconds, error_of(report, m)))


def error_of(report: CostReport, measurement: Measurement) -> float:
    """The relative RMSE of a measurement without what the truth's own noise adds.

    Not less than can be told against this truth: what is lost in its noise would come out as no error at all, which
    nothing could equal.
    """
    noise = report.truth.noise
    return max(without_noise(measurement.rmse, noise), min(measurement.rmse, least_error(noise)))


def _front(report: CostReport, coordinates: Callable[[Measurement], tuple[float, ...]]) -> tuple[int, ...]:
    probes = [i for i, m in enumerate(report.measurements) if m.settings.kind is Kind.PROBE]
    return tuple(probes[k] for k in pareto([coordinates(report.measurements[i]) for i in probes]))
