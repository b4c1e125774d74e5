"""What makes a bake stale, and what does not: a row of the files in `stale` each, by the hash alone."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import all_probes, probe_spec
from tests.blender.helpers import small_probe
from tests.blender.stale.all import ROWS, Row
from tests.blender.stale.things import build


def fingerprint(uid: str) -> str:
    bpy.context.view_layer.update()
    scene = bpy.context.scene
    [probe] = [probe for probe in all_probes(scene) if probe.pcc_probe.uid == uid]
    return SceneFingerprint(scene, bpy.context.view_layer).content_hash(probe_spec(probe))


@pytest.mark.sweep
@pytest.mark.parametrize("row", ROWS, ids=str)
def test_a_row(scene, tmp_path: Path, row: Row) -> None:
    probe = small_probe(location=(0.0, 0.0, 0.0), half_extents=(3.0, 3.0, 3.0))
    probe.pcc_probe.engine, probe.pcc_probe.denoise = row.engine.value, True
    probe.pcc_probe.uid = "a" * 32
    for name, value in row.settings:
        setattr(probe.pcc_probe, name, value)
    build()
    steps = row.steps(tmp_path)
    next(steps)
    before = fingerprint("a" * 32)
    assert fingerprint("a" * 32) == before, "the hash holds while nothing changes"
    assert next(steps, "done") == "done"
    assert (fingerprint("a" * 32) != before) == row.counts


def test_no_row_is_there_twice() -> None:
    names = [str(row) for row in ROWS]
    assert len(set(names)) == len(names)


def test_the_page_lists_every_row() -> None:
    """Where this fails, benchmarks/staleness.py makes the page anew."""
    page = (Path(__file__).parents[2] / "docs" / "staleness.md").read_text(encoding="utf-8")
    halves = page.split("## It is not after")
    assert not [str(row) for row in ROWS if row.name not in halves[0 if row.counts else 1]]
