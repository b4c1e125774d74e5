"""What a bake will take, told from its settings and from earlier bakes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core.forecast import Order, forecast
from pcc_addon.core.pictures import NEARNESS, PictureKey, PictureKind
from pcc_addon.core.probe import Box, Engine, ProbeSpec, Source
from pcc_addon.core.sequence import Moment
from pcc_addon.core.sidecar import Level, Sidecar

SPEC = ProbeSpec(name="Room", box=Box.from_matrix("Room", np.eye(4)), resolution=128, samples=16)


def baked(spec: ProbeSpec, seconds: float, share: float = 0.5, levels: int = 2) -> Sidecar:
    """The record of a bake whose files have a share of the bytes of their numbers."""
    record = Sidecar.of_bake(spec, "0", seconds=seconds, content_hash="", blender="", addon="")
    n = spec.resolution
    size = round(8 * n * n * 12 * share)
    keys = [PictureKey(PictureKind.RADIANCE, k) for k in range(levels)]
    return replace(record, levels=tuple(Level(key, 0.1 * k, "", 4 * n, 2 * n, size) for k, key in enumerate(keys)))


def test_before_the_first_bake_nobody_knows_the_seconds_and_all_levels_count() -> None:
    found = forecast([Order(SPEC)])
    assert found.seconds is None
    assert found.size == pytest.approx(8 * 8 * 128**2 * 12, rel=0.3)
    assert forecast([Order(SPEC, levels=2)]).size == pytest.approx(found.size / 4, abs=1)


def test_the_same_bake_again_takes_what_it_took() -> None:
    found = forecast([Order(SPEC, baked(SPEC, 7.0), levels=2)])
    assert found.seconds == pytest.approx(7.0)
    assert found.size == pytest.approx(8 * 128**2 * 12 * 0.5 * 2, rel=1e-4)


def test_seconds_grow_with_samples_and_pixels() -> None:
    record = baked(SPEC, 10.0)
    assert forecast([Order(replace(SPEC, samples=64), record)]).seconds == pytest.approx(40.0)
    larger = forecast([Order(replace(SPEC, resolution=256), record)])
    assert larger.seconds == pytest.approx(10.0 * (272 / 144) ** 2)
    assert larger.size == pytest.approx(4 * forecast([Order(SPEC, record)]).size, rel=1e-3)


def test_a_bake_of_some_faces_tells_of_all() -> None:
    record = replace(baked(SPEC, 10.0), faces=("+X", "-X", "+Y"))
    assert forecast([Order(SPEC, record)]).seconds == pytest.approx(20.0)


def test_others_tell_where_a_probe_has_no_bake_by_the_engine() -> None:
    known, new = Order(SPEC, baked(SPEC, 10.0)), Order(replace(SPEC, name="New", samples=32))
    assert forecast([known, new]).seconds == pytest.approx(30.0)
    by_eevee = Order(replace(SPEC, name="New", engine=Engine.EEVEE))
    assert forecast([known, by_eevee]).seconds is None
    assert forecast([Order(replace(SPEC, engine=Engine.EEVEE), known.record)]).seconds is None


def test_pictures_from_files_take_no_time() -> None:
    assert forecast([Order(replace(SPEC, source=Source.IMAGE))]).seconds == 0.0


def test_half_floats_and_distances_count_as_they_are_kept() -> None:
    whole = forecast([Order(SPEC, levels=2)]).size
    assert forecast([Order(replace(SPEC, half_float=True), levels=2)]).size == pytest.approx(whole / 2, abs=1)
    deep = replace(SPEC, relief=True)
    assert forecast([Order(deep, levels=2)]).size == pytest.approx(1.5 * whole, abs=1)
    record = replace(baked(replace(deep, half_float=True), 1.0), half_float=True)
    near = Level(PictureKey(PictureKind.NEARNESS, 0), NEARNESS, "", 512, 256, 8 * 128**2 * 12)
    halves = tuple(replace(level, size=8 * 128**2 * 6) for level in record.levels)
    found = forecast([Order(replace(deep, half_float=True), replace(record, levels=(*halves, near)), levels=2)])
    assert found.size == 8 * 128**2 * (6 * 2 + 12)


def test_a_sequence_counts_each_of_its_pictures() -> None:
    record = baked(SPEC, 30.0)
    moments = tuple(Moment(k, str(k), k % 3, (0.0, 0.0, 0.0)) for k in range(1, 10))
    film = replace(record, moments=moments)
    found = forecast([Order(SPEC, film, levels=2)])
    assert found.seconds == pytest.approx(30.0)
    assert found.size == pytest.approx(3 * forecast([Order(SPEC, record, levels=2)]).size, rel=1e-4)
