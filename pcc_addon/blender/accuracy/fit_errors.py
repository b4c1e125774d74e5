"""What a fit does to the picture: the error of what a probe serves with the box that is drawn, and with the fitted one.

The open file is changed as the measurement needs it; open it again afterwards.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import ExitStack
from dataclasses import dataclass, replace

import bpy

from ...core.accuracy.metrics import noise_of_halves, relative_rmse, without_noise
from ...core.errors import ProbeError
from ...core.fit.records import Fit
from ...core.probe import Engine
from ...core.workplace import workplace
from . import truth
from .bench import Bench, own_settings
from .question import Question, subject_of
from .served import served_pixels

_WIDTH, _TRUTH_SECONDS = 240, 20.0
_RESOLUTION, _BAKE_SAMPLES, _FRAME_SAMPLES = 256, 16, 16
_SEED, _SEED_OF_TRUTH = 11, 1000


@dataclass(frozen=True)
class PictureErrors:
    """Relative RMSE against path tracing over the pixels that the probe serves as it is drawn, without noise."""

    before: float
    after: float

    def __str__(self) -> str:
        return f"error of the picture {self.before:.3f} → {self.after:.3f}"


def picture_errors(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probe: bpy.types.Object, fit: Fit
) -> Generator[str, None, PictureErrors]:
    """Measure both in small pictures of the scene's camera; yields what is done next.

    Raises:
        PccError: there is no camera, the probe serves nothing that it sees, or something cannot be rendered.
        Cancelled: the user stopped a render.
    """
    subject = subject_of(Question(probe=probe.name, width=_WIDTH), scene, view_layer)
    scene.camera = subject.camera
    [number] = subject.frames
    with ExitStack() as stack:
        bench = Bench(scene, view_layer, probe, subject.size, subject.frames, workplace(stack))
        bench.fit = fit
        own = own_settings(probe, subject.engine, _FRAME_SAMPLES)
        denoise = subject.engine is Engine.CYCLES
        size = min(own.resolution, _RESOLUTION)
        rung = replace(own, resolution=size, bake_samples=_BAKE_SAMPLES, bake_denoise=True, frame_denoise=denoise)
        yield from bench.bake(rung, _SEED)
        mask = served_pixels(scene, view_layer, probe, subject.size.width, subject.size.height)
        if not mask.any():
            raise ProbeError(f"probe '{probe.name}' serves no pixel that camera '{subject.camera.name}' sees")
        drawn = bench.frame(rung, number, _SEED).pixels
        yield "the picture as drawn"
        fitted = replace(rung, fitted=True)
        yield from bench.bake(fitted, _SEED)
        now = bench.frame(fitted, number, _SEED).pixels
        halves = None
        for halves in truth.deepened(bench, number, mask, _TRUTH_SECONDS, None, _SEED_OF_TRUTH):
            yield f"the truth, {2 * halves.samples} samples"
        assert halves is not None
    noise = noise_of_halves(halves.first, halves.second, mask)
    before, after = (without_noise(relative_rmse(picture, halves.mean, mask), noise) for picture in (drawn, now))
    return PictureErrors(before, after)
