"""How long a rung will take, from those that were measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .lines import Line, fitted
from .records import Kind, Measurement, Settings


@dataclass(frozen=True)
class Times:
    """Lines through measured seconds, one for each class of rungs that take their time alike.

    Attributes:
        bakes: seconds over texels × samples, by class of bake.
        frames: seconds over samples, by class of frame.
    """

    bakes: tuple[tuple[tuple, Line], ...]
    frames: tuple[tuple[tuple, Line], ...]

    @classmethod
    def fitted_to(cls, measurements: Sequence[Measurement]) -> Times:
        """The lines through what was measured.

        A rung that has the same bake as an earlier one says nothing new about bakes, so each bake counts once.
        """
        bakes: dict[tuple, list[tuple[float, float]]] = {}
        frames: dict[tuple, list[tuple[float, float]]] = {}
        seen = set()
        for measurement in measurements:
            settings = measurement.settings
            if measurement.bake_seconds > 0.0 and settings.bake_key not in seen:
                seen.add(settings.bake_key)
                for key in _bake_classes(settings):
                    bakes.setdefault(key, []).append((bake_work(settings), measurement.bake_seconds))
            if measurement.frame_seconds > 0.0:
                for key in _frame_classes(settings):
                    frames.setdefault(key, []).append((float(settings.frame_samples), measurement.frame_seconds))
        return cls(_lines(bakes), _lines(frames))

    def bake(self, settings: Settings) -> float | None:
        """Predicted seconds of a bake; 0 for what needs none, None where nothing like it was measured."""
        if settings.kind is Kind.PATH:
            return 0.0
        return _predicted(dict(self.bakes), _bake_classes(settings), bake_work(settings))

    def frame(self, settings: Settings) -> float | None:
        """Predicted seconds of one frame; None where nothing like it was measured."""
        return _predicted(dict(self.frames), _frame_classes(settings), float(settings.frame_samples))


def bake_work(settings: Settings) -> float:
    """What a bake's seconds grow with: resolution² × samples, of one probe or two."""
    return float(settings.resolution**2 * max(settings.bake_samples, 1) * (2 if settings.paired else 1))


def _bake_classes(settings: Settings) -> list[tuple]:
    """Those whose lines may tell, the likest first: relief captures distance, a denoiser takes time of its own."""
    alike = (settings.kind, settings.engine)
    return [(*alike, settings.correction == "RELIEF", settings.bake_denoise, settings.bake_adaptive), alike]


def _frame_classes(settings: Settings) -> list[tuple]:
    """Those whose lines may tell, the likest first; the size of the pictures hardly matters to a frame."""
    alike = (settings.kind, settings.engine)
    looks = (settings.correction, settings.ray_tracing, settings.frame_denoise)
    return [(*alike, *looks, settings.steps, settings.refinements), (*alike, *looks), alike]


def _lines(points: dict[tuple, list[tuple[float, float]]]) -> tuple[tuple[tuple, Line], ...]:
    return tuple((key, fitted(of_class)) for key, of_class in points.items())


def _predicted(lines: dict[tuple, Line], classes: list[tuple], x: float) -> float | None:
    found = next((lines[key] for key in classes if key in lines), None)
    return None if found is None else found.at(x)
