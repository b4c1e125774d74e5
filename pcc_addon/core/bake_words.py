"""What there is to say of a bake, in words."""

from __future__ import annotations

from datetime import datetime, tzinfo

from .accuracy.labels import counted, seconds
from .cubemap import FACE_NAMES
from .frames import spans
from .probe import Engine, Source
from .sidecar import Sidecar
from .words import listed

_ENGINES = {Engine.CYCLES.value: "Cycles", Engine.EEVEE.value: "EEVEE"}


def made_with(record: Sidecar) -> str:
    """What it was baked with, such as "Cycles, 512 px faces, 64 samples, denoised, half float"."""
    faces = f"{record.resolution} px faces"
    precision = ["half float"] * record.half_float
    if record.source is Source.IMAGE:
        return ", ".join(["an image", faces, *precision])
    engine = _ENGINES.get(record.engine, record.engine)
    what = [f"the world by {engine}"] if record.source is Source.WORLD else [engine]
    denoised = ["denoised"] * (record.denoise and record.engine == Engine.CYCLES.value)
    return ", ".join([*what, faces, counted(record.samples, "sample"), *denoised, *precision])


def made_when(record: Sidecar, zone: tzinfo | None = None) -> str:
    """When it was baked and how long that took, such as "2026-11-26 19:20, in 12 s".

    Args:
        record: of the bake.
        zone: in which times are told; None: the one of this machine.
    """
    took = f"in {seconds(record.seconds)}"
    if not record.date:
        return took
    return f"{datetime.fromisoformat(record.date).astimezone(zone):%Y-%m-%d %H:%M}, {took}"


def kept_as(record: Sidecar) -> str:
    """How many pictures it has, and how large they are, such as "2 pictures, 4.2 MB"."""
    told = counted(len(record.levels), "picture")
    frames = f" for frames {spans(record.frames)}" if record.moments else ""
    size = sum(level.size for level in record.levels)
    return f"{told}{frames}, {megabytes(size)}" if size else f"{told}{frames}"


def not_captured(record: Sidecar) -> str:
    """Which faces were left out, as nothing could mirror that way; empty: none."""
    lacking = record.lacks(FACE_NAMES)
    return f"not captured, as nothing mirrored that way: {listed(lacking)}" if lacking else ""


def megabytes(size: int) -> str:
    """A number of bytes in words, such as "0.31 MB", "4.2 MB", "120 MB" or "1.3 GB"."""
    value, unit = (size / 1e9, "GB") if size >= 999.5e6 else (size / 1e6, "MB")
    if value >= 9.95:
        return f"{value:.0f} {unit}"
    return f"{value:.1f} {unit}" if value >= 0.995 else f"{value:.2g} {unit}"
