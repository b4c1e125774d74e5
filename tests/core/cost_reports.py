"""Reports of `pcc cost` from plausible laws instead of renders."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pcc_addon.core.accuracy.records import CostReport, Kind, Measurement, Settings, Truth
from pcc_addon.core.probe import Engine

NOISE = 0.004
PROBE = Settings(Kind.PROBE, Engine.CYCLES, "BOX", 256, 64, True, frame_samples=64)
PATH = Settings(Kind.PATH, Engine.CYCLES, "NONE", frame_samples=64)


def probe(error: float, bake: float, frame: float, settings: Settings = PROBE, **more: object) -> Measurement:
    return Measurement(settings, error, error / 2, None, bake, frame, **more)  # type: ignore[arg-type]


def path(
    samples: int, error: float, frame: float, denoised: bool = False, engine: Engine = Engine.CYCLES
) -> Measurement:
    settings = replace(PATH, frame_samples=samples, frame_denoise=denoised, engine=engine)
    return Measurement(settings, error, error / 2, None, 0.0, frame)


def report(*measurements: Measurement, noise: float = 0.0, **more: object) -> CostReport:
    truth = Truth(4096, noise, 120.0, 0.4, "truth.png")
    plain = CostReport("room.blend", "Scene", "Camera", "Room", Engine.CYCLES, 480, 270, (1,), truth, measurements)
    return replace(plain, where="two cores, Blender 5.2.3, 2026-11-26", seconds=540.0, **more)  # type: ignore[arg-type]


def ladder() -> tuple[Settings, ...]:
    """All rungs of a probe and of path tracing that a run might look at."""
    corrections = (("NONE", 0, 0), ("BOX", 0, 0), ("RELIEF", 8, 4), ("RELIEF", 16, 6))
    probes = [
        Settings(Kind.PROBE, Engine.CYCLES, correction, size, samples, True, False, steps, refinements, 64, False)
        for correction, steps, refinements in corrections
        for size in (64, 128, 256, 512, 1024)
        for samples in (4, 16, 64, 256)
    ]
    paths = [replace(PATH, frame_samples=4**k, frame_denoise=on) for on in (False, True) for k in range(7)]
    return (*probes, *paths)


def measured(settings: Settings) -> Measurement:
    """What a furnished room with a mirror floor might give, without chance."""
    if settings.kind is Kind.PATH:
        n = settings.frame_samples
        noise, bias = (0.14, 0.021) if settings.frame_denoise else (0.55, 0.0)
        error = math.hypot(noise / math.sqrt(n), bias, NOISE)
        seconds = 0.35 + 0.055 * n + (0.5 if settings.frame_denoise else 0.0)
        return Measurement(settings, error, 0.6 * error, 1.4 * error, 0.0, seconds)
    floor = {"NONE": 0.31, "BOX": 0.072, "RELIEF": 0.031 if settings.steps == 16 else 0.036}[settings.correction]
    pixels, samples = 6.0 / settings.resolution, 0.09 / math.sqrt(settings.bake_samples)
    error = math.hypot(floor, pixels, samples, NOISE)
    relief = settings.correction == "RELIEF"
    bake = 0.8 + 2.1e-6 * settings.resolution**2 * settings.bake_samples * (1.15 if relief else 1.0)
    frame = 1.9 + 0.02 * settings.steps
    megabytes = 1.2e-5 * settings.resolution**2 * (1.3 if relief else 1.0)
    return Measurement(settings, error, 0.6 * error, 0.8 * error, bake, frame, megabytes, 4 if relief else 3)


def example(rungs: Sequence[Settings] | None = None) -> CostReport:
    """A whole run."""
    return report(*map(measured, ladder() if rungs is None else rungs), noise=NOISE, frames=(1, 2, 3))
