"""The panel shows what was measured last, whatever became of the file in between."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from pcc_addon.core.accuracy import files
from pcc_addon.core.accuracy.plots import NAMES
from pcc_addon.core.accuracy.png import write_png
from pcc_addon.ui.kept import last_cost
from tests.blender.helpers import save
from tests.core.cost_reports import example


def results(folder: Path) -> Path:
    return folder / "room.cost"


def test_what_was_measured_last_is_read_again_when_it_changes(scene, tmp_path) -> None:
    assert last_cost.of_file() is None, "the file is not saved"
    save(tmp_path / "room.blend")
    assert last_cost.of_file() is None
    report = example()
    files.keep(report, results(tmp_path))
    first, found = last_cost.of_file()
    assert first == report and found.recommended is not None
    assert last_cost.of_file()[0] is first, "panels are drawn at each move of the mouse"
    files.keep(replace(report, seconds=report.seconds + 1.0), results(tmp_path))
    assert last_cost.of_file()[0].seconds == report.seconds + 1.0
    (results(tmp_path) / files.JSON_NAME).write_text("{")
    assert last_cost.of_file() is None, "a damaged file is told by what writes the next"


def test_plots_are_shown_as_images(scene, tmp_path) -> None:
    save(tmp_path / "room.blend")
    assert not bpy.ops.pcc.cost_show.poll()
    results(tmp_path).mkdir()
    for name in NAMES:
        write_png(results(tmp_path) / f"{name}.png", np.zeros((4, 6, 3)))
    assert bpy.ops.pcc.cost_show(plot="error_bake") == {"FINISHED"}
    assert [Path(image.filepath).name for image in bpy.data.images] == ["error_bake.png"]
