"""A rung in an artist's words."""

from __future__ import annotations

from ..probe import Engine
from .records import Kind, Settings

CORRECTIONS = {"NONE": "classic", "BOX": "box", "RELIEF": "relief"}


def label(settings: Settings) -> str:
    """All that is set, such as "box, 512 px faces, 64 samples denoised; frame 32 samples"."""
    return f"{of_bake(settings)}; {of_frame(settings)}" if settings.kind is not Kind.PATH else of_frame(settings)


def of_bake(settings: Settings) -> str:
    """What a bake needs to know, and how the probe is looked up."""
    if settings.kind is Kind.SPHERE:
        return f"Blender's sphere probe {of_sphere(settings)}"
    name = CORRECTIONS.get(settings.correction, settings.correction.lower())
    if settings.correction == "RELIEF":
        name += f" ({settings.steps} steps, {settings.refinements} refinements)"
    fitted = ", box fitted" if settings.fitted else ""
    paired = " through two probes" if settings.paired else ""
    adaptive = f", adaptive to {settings.bake_adaptive:g}" if settings.bake_adaptive else ""
    precision = ", half float" if settings.half_float else ""
    samples = _samples(settings.bake_samples, settings.bake_denoise)
    return f"{name}{paired}{fitted}, {settings.resolution} px faces, {samples}{adaptive}{precision}"


def of_sphere(settings: Settings) -> str:
    """How Blender's own probe is set."""
    parallax = "with a box" if settings.correction == "BOX" else "as it is added"
    return f"{parallax}, {settings.resolution} px"


def of_frame(settings: Settings) -> str:
    """How the camera's picture is made."""
    what = f"{without_probes(settings.engine)}," if settings.kind is Kind.PATH else "frame"
    return f"{what} {samples_of_frame(settings)}"


def samples_of_frame(settings: Settings) -> str:
    """Such as "64 samples denoised, ray tracing"."""
    traced = ", ray tracing" if settings.ray_tracing else ""
    return _samples(settings.frame_samples, settings.frame_denoise) + traced


def without_probes(engine: Engine) -> str:
    """What an engine does without probes."""
    return "path tracing" if engine is Engine.CYCLES else "EEVEE without probes"


def seconds(value: float) -> str:
    """Such as "0.42 s", "12 s", "3 min 20 s" or "2 h 5 min"; three digits at most."""
    if value < 9.95:
        return f"{value:.2g} s" if value < 0.995 else f"{value:.1f} s"
    if value < 119.5:
        return f"{value:.0f} s"
    whole = round(value)
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s" if whole % 60 else f"{whole // 60} min"
    minutes = round(value / 60.0)
    return f"{minutes // 60} h {minutes % 60} min" if minutes % 60 else f"{minutes // 60} h"


def error(value: float) -> str:
    """A relative error in percent, such as "4.1 %"; two digits at least."""
    percent = 100.0 * value
    if percent < 9.95:
        return f"{percent:.2g} %" if percent < 0.995 else f"{percent:.1f} %"
    return f"{percent:.0f} %"


def counted(number: int, thing: str) -> str:
    """Such as "1 frame" or "12 frames"."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _samples(samples: int, denoised: bool) -> str:
    return counted(samples, "sample") + (" denoised" if denoised else "")
