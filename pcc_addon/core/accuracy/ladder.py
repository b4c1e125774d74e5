"""The ladder: all rungs that may be worth measuring, from which the next one is chosen again and again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

from ..probe import Engine
from .records import Kind, Settings

RESOLUTIONS = (128, 256, 512, 1024, 2048)
SAMPLES = (4, 16, 64, 256, 1024)
SPHERE_RESOLUTIONS = (128, 256, 512, 1024, 2048)  # those that EEVEE has
_ADAPTIVE = 0.02
_MARCHES = ((8, 3), (12, 4), (24, 6))  # steps and refinements of relief


def ladder(
    engine: Engine, corrections: Sequence[str], *, halves: bool, fits: bool = False, pairs: bool = False
) -> tuple[Settings, ...]:
    """Every rung that this version can set.

    Args:
        engine: whose frames are measured.
        corrections: those that probes may have, the simplest first.
        halves: whether pictures may be kept in half precision.
        fits: whether the box that fits the room is another one than the probe's own.
        pairs: whether another probe shares the room.
    """
    own = tuple(_of_probe(engine, corrections, halves))
    fitted = (replace(rung, fitted=True) for rung in own if rung.correction != "NONE") if fits else ()
    paired = (replace(rung, paired=True) for rung in own if _may_be_paired(rung, corrections[-1])) if pairs else ()
    return (*_of_path(engine), *own, *fitted, *paired, *_of_sphere(engine))


def _may_be_paired(rung: Settings, best: str) -> bool:
    """Whether a second probe is tried: with the best correction, its pictures and frames as they usually are."""
    plain = rung.bake_denoise and not (rung.half_float or rung.bake_adaptive or rung.ray_tracing)
    return rung.correction == best and plain


def _looks(engine: Engine) -> list[tuple[int, bool, bool]]:
    """How a frame may be rendered: samples, denoised, with EEVEE's ray tracing."""
    choices = [(True, False), (False, False)] if engine is Engine.CYCLES else [(False, False), (False, True)]
    return [(samples, *choice) for samples, choice in product(SAMPLES, choices)]


def _of_path(engine: Engine) -> Iterator[Settings]:
    for samples, denoise, traced in _looks(engine):
        yield Settings(Kind.PATH, engine, "NONE", frame_samples=samples, frame_denoise=denoise, ray_tracing=traced)


def _shown(engine: Engine, correction: str, look: tuple[int, bool, bool]) -> Settings:
    samples, denoise, traced = look
    return Settings(Kind.PROBE, engine, correction, frame_samples=samples, frame_denoise=denoise, ray_tracing=traced)


def _of_probe(engine: Engine, corrections: Sequence[str], halves: bool) -> Iterator[Settings]:
    """What changes no more than the noise and the size of pictures is asked of the best correction, plainly shown."""
    for name in corrections:
        marches = _MARCHES if name == "RELIEF" else ((0, 0),)
        for look in _looks(engine):
            plain = look[1:] == (False, False)
            precise = [(True, False, 0.0)]  # denoised, half float, adaptive sampling
            if name == corrections[-1] and plain:
                precise += [(False, False, 0.0), (True, False, _ADAPTIVE), *([(True, True, 0.0)] if halves else [])]
            if name == "NONE" and not plain:
                continue
            choices = product(RESOLUTIONS, SAMPLES, precise, marches)
            for size, samples, (denoise, half, adaptive), (steps, refinements) in choices:
                yield replace(
                    _shown(engine, name, look), resolution=size, bake_samples=samples, bake_denoise=denoise,
                    half_float=half, bake_adaptive=adaptive, steps=steps, refinements=refinements,
                )  # fmt: skip


def _of_sphere(engine: Engine) -> Iterator[Settings]:
    if engine is Engine.EEVEE:
        choices = product(SPHERE_RESOLUTIONS, _looks(engine), ("BOX", "NONE"))
        for size, (samples, denoise, traced), parallax in choices:
            yield Settings(
                Kind.SPHERE,
                engine,
                parallax,
                resolution=size,
                frame_samples=samples,
                frame_denoise=denoise,
                ray_tracing=traced,
            )
