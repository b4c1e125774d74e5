"""How long a measurement will take: nothing is begun that would not end in time."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

from ..probe import Engine
from .records import Kind, Measurement, Settings
from .times import Times, bake_work

LONG = 3.0  # seconds from which on a frame is rendered once
_MARGIN = 1.25  # by which a guess may be too low
_COMPILING, _CHANGING = 2.0, 0.5  # seconds: of EEVEE's shaders, at least; of letting materials show something else
_RENDERS = 3  # of a short frame: its seconds are the median


@dataclass(frozen=True)
class Foresight:
    """What is known of the speed of this scene on this machine.

    Attributes:
        known: what was measured.
        frames: how many of them a rung is measured on.
        pixels: of the camera's picture.
        per_sample: seconds that one sample of one pixel takes to path trace.
        around_frame, around_bake: seconds of a render and of a bake beside their samples.
    """

    known: Sequence[Measurement]
    frames: int
    pixels: int
    per_sample: float
    around_frame: float
    around_bake: float

    @cached_property
    def _times(self) -> Times:
        return Times.fitted_to(self.known)

    def seconds(self, settings: Settings, baked: Collection[tuple]) -> float:
        """Of all that measuring a rung takes.

        Args:
            settings: the rung.
            baked: the keys of bakes that are there and need not be made again.
        """
        same = next((m for m in self.known if m.settings == settings), None)
        traced = self.pixels * settings.frame_samples * self.per_sample
        traced = traced if settings.engine is Engine.CYCLES else 0.0
        guessed = _guessed(self._times.frame(settings), traced, self._around_frame(settings.engine))
        frame = guessed if same is None else same.frame_seconds
        bake = 0.0 if settings.kind is not Kind.PROBE or settings.bake_key in baked else self._bake(settings)
        compiling = max(_COMPILING, frame) if settings.engine is Engine.EEVEE else 0.0
        return _MARGIN * (bake + frame * renders(frame, self.frames) + compiling + _CHANGING)

    def _around_frame(self, engine: Engine) -> float:
        """Seconds of a frame unlike all that were measured: in EEVEE samples are the smaller part of it."""
        if engine is Engine.CYCLES:
            return self.around_frame
        return max([self.around_frame, *(m.frame_seconds for m in self.known if m.settings.engine is engine)])

    def _bake(self, settings: Settings) -> float:
        same = next((m for m in self.known if m.settings.bake_key == settings.bake_key), None)
        if same is not None:
            return same.bake_seconds
        traced = 6.0 * bake_work(settings) * self.per_sample
        seconds = [m.bake_seconds for m in self.known if m.settings.kind is Kind.PROBE]
        known = self._times.bake(settings)
        if known is not None:  # a line through one bake takes all of its seconds for those of samples
            known = min(known, min(seconds) + traced)
        return _guessed(known, traced, self.around_bake)


def renders(frame: float, frames: int) -> int:
    """How many renders measure a rung whose frame takes so many seconds: one frame that is short is rendered again."""
    return _RENDERS if frames == 1 and frame < LONG else frames


def _guessed(known: float | None, traced: float, around: float) -> float:
    """Seconds by a line through what was measured, which may be flat where little was, and by path tracing's speed."""
    return around + traced if known is None else max(known, traced / 2.0)
