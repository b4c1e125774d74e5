"""What the viewport draws of a probe, as lines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core.influence import Influence
from pcc_addon.core.probe import ProbeSpec
from pcc_addon.ui.viewport import probe_shapes
from tests.core.rooms import box

SPEC = ProbeSpec("Probe", box((1.0, 2.0, 3.0), (4.0, 3.0, 1.4), 24.0), capture_offset=(0.5, 0.0, 0.2), padding=0.05)


def extents(spec: ProbeSpec, lines: np.ndarray) -> np.ndarray:
    """(2, 3) metres along the box's axes: how far lines reach beyond its low and its high faces."""
    places = spec.box.coordinates(lines.astype(np.float64))
    return np.array([-places.min(0), places.max(0)]) - spec.box.half_widths


def test_the_box_has_twelve_edges_of_its_size() -> None:
    lines = probe_shapes.box(SPEC)
    assert lines.shape == (24, 3) and lines.dtype == np.float32
    assert extents(SPEC, lines) == pytest.approx(0.0, abs=1e-5)
    lengths = np.linalg.norm(lines[::2] - lines[1::2], axis=1)
    assert sorted(lengths.round(4)) == pytest.approx(sorted([8.0, 6.0, 2.8] * 4), abs=1e-3)


def test_the_influence_is_drawn_where_it_is_not_the_box() -> None:
    assert len(probe_shapes.influence(SPEC)) == 0
    reach = Influence(low=(0.5, 0.0, 0.0), high=(0.0, -0.3, 0.0))
    spec = replace(SPEC, influence=reach)
    expected = np.array([reach.low, reach.high]) + spec.influence_padding
    assert extents(spec, probe_shapes.influence(spec)) == pytest.approx(expected, abs=1e-5)


def test_the_outer_border_is_where_each_face_has_faded() -> None:
    falloffs = Influence(falloff_low=(0.1, 0.2, 0.3), falloff_high=(0.4, 0.5, 0.6))
    spec = replace(SPEC, influence=falloffs)
    lines = probe_shapes.falloff(spec)
    assert extents(spec, lines) == pytest.approx(spec.fading_reach, abs=1e-5)
    assert lines.shape[0] % 2 == 0 and len(lines) == 2 * (12 * 24 + 8)


def test_nothing_fades_without_a_falloff_or_a_box() -> None:
    assert len(probe_shapes.falloff(replace(SPEC, falloff=0.0))) == 0
    classic = replace(SPEC, corrected=False)
    assert len(probe_shapes.falloff(classic)) == 0 and len(probe_shapes.influence(classic)) == 0


def test_the_capture_point_is_the_middle_of_its_mark() -> None:
    lines = probe_shapes.capture_point(SPEC)
    assert lines.mean(0) == pytest.approx(SPEC.capture_point, abs=1e-5)
    assert np.linalg.norm(lines - SPEC.capture_point, axis=1).max() < 0.1 * SPEC.box.half_widths.min()


def test_a_line_leads_to_what_the_probe_follows() -> None:
    spec = replace(SPEC, followed=(7.0, 8.0, 9.0))
    assert probe_shapes.capture_point(spec)[-1] == pytest.approx((7.0, 8.0, 9.0))
