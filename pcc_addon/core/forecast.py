"""How large the pictures of a bake will be and how long it will take, as far as earlier bakes tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .cubemap import FACE_NAMES, OVERSCAN
from .pictures import LADDER, NEARNESS
from .probe import ProbeSpec, Source
from .sidecar import Sidecar

_COMPRESSED = 0.85  # of a picture's bytes, as measured with noise; pictures of few colours are smaller


@dataclass(frozen=True)
class Order:
    """A probe that may be baked.

    Attributes:
        spec: its settings.
        record: of its last bake, or None.
        levels: how many pictures of different roughness it needs; None: nobody knows, so all.
    """

    spec: ProbeSpec
    record: Sidecar | None = None
    levels: int | None = None


@dataclass(frozen=True)
class Forecast:
    """What a bake will take.

    Attributes:
        size: bytes of its pictures.
        seconds: None where no earlier bake tells.
    """

    size: int
    seconds: float | None


def forecast(orders: Sequence[Order]) -> Forecast:
    """What a bake of some probes will take, each over as many frames as it was last baked for.

    Seconds are those of earlier bakes by the same engine, in proportion to rays: a probe's own bake, or else the mean
    of the others'. Pictures from elsewhere take none worth telling.
    """
    speeds = [(order.spec.engine, speed) for order in orders if (speed := _seconds_of_a_ray(order)) is not None]
    seconds = 0.0
    for order in orders:
        rays = _rays(order)
        alike = [speed for engine, speed in speeds if engine is order.spec.engine]
        own = _seconds_of_a_ray(order)
        if rays and own is None and not alike:
            return Forecast(sum(map(_size, orders)), None)
        if rays:
            seconds += rays * (own if own is not None else sum(alike) / len(alike))
    return Forecast(sum(map(_size, orders)), seconds)


def _size(order: Order) -> int:
    """Bytes of a probe's pictures."""
    spec, record = order.spec, order.record
    levels = len(LADDER) if order.levels is None else order.levels
    share = _COMPRESSED
    if record is not None and any(level.size for level in record.levels):
        before = sum(_bytes(level.width * level.height, _is_half(record, level.roughness)) for level in record.levels)
        share = sum(level.size for level in record.levels) / before
    texels = 8 * spec.resolution**2
    one = levels * _bytes(texels, spec.half_float) + spec.captures_distance * _bytes(texels, half=False)
    return round(_pictures(record) * one * share)


def _is_half(record: Sidecar, roughness: float) -> bool:
    return record.half_float and roughness != NEARNESS


def _bytes(texels: int, half: bool) -> int:
    """Of three numbers a texel."""
    return texels * (6 if half else 12)


def _pictures(record: Sidecar | None) -> int:
    """How many things a probe sees, as far as its last bake tells."""
    return len({moment.number for moment in record.moments}) if record is not None and record.moments else 1


def _rays(order: Order) -> float:
    """How many samples a probe's renders take; none where its picture is a file."""
    if order.spec.source is Source.IMAGE:
        return 0.0
    spec = order.spec
    return _samples(len(FACE_NAMES), spec.resolution, spec.samples) * _pictures(order.record)


def _seconds_of_a_ray(order: Order) -> float | None:
    """As a probe's last bake took them; None where it tells nothing of the next."""
    record = order.record
    if record is None or record.engine != order.spec.engine.value or record.source is not order.spec.source:
        return None
    rays = _samples(len(record.faces), record.resolution, record.samples) * _pictures(record)
    return record.seconds / rays if rays and record.seconds else None


def _samples(faces: int, resolution: int, samples: int) -> float:
    return faces * (resolution + 2 * OVERSCAN) ** 2 * samples
