"""Each operator is one undo step, which takes all back that it did; those that only tell something change nothing."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import handlers, marks
from pcc_addon.core.accuracy.plots import NAMES
from pcc_addon.core.accuracy.png import write_png
from pcc_addon.ui.operators import cost
from tests.core.cost_reports import example
from tests.rna_dump import difference, dump

PICTURE, PRESET = "room.png", "mine.py"


def probe() -> bpy.types.Object:
    return bpy.data.objects["Probe"]


def nothing() -> None:
    """Needs no preparation."""


def select(*names: str) -> None:
    """The last is active."""
    for item in bpy.context.scene.objects:
        item.select_set(item.name in names)
    bpy.context.view_layer.objects.active = bpy.data.objects[names[-1]]


def set_size() -> None:
    probe().pcc_probe.resolution = 24


def take_out() -> None:
    bpy.ops.pcc.remove()


def move_box() -> None:
    probe().location.x += 0.1
    select("Probe")


def select_probe() -> None:
    select("Probe")


def select_table() -> None:
    select("Table")


def select_both() -> None:
    select("Table", "Probe")


def hide_table() -> None:
    select_both()
    bpy.ops.pcc.hidden_add()


def draw_plots() -> None:
    folder = Path(bpy.data.filepath).with_suffix(".cost")
    folder.mkdir()
    for name in NAMES:
        write_png(folder / f"{name}.png", np.zeros((4, 8, 3)))


def select_two_probes() -> None:
    bpy.ops.pcc.probe_add(name="Second", location=(20.0, 0.0, 0.0))
    select("Probe", "Second")


def save_preset() -> None:
    select_probe()
    (Path(bpy.data.filepath).parent / PRESET).write_text("import bpy\nbpy.context.object.pcc_probe.samples = 7\n")


CHANGING: dict[str, tuple[Callable[[], None], dict[str, object]]] = {
    "bake": (set_size, {"scope": "ALL"}),
    "copy_settings": (select_two_probes, {}),
    "cost": (nothing, {"apply": True}),
    "cost_show": (draw_plots, {"plot": "error_bake"}),
    "drag_capture_point": (select_probe, {"by": (0.1, 0.0, 0.2)}),
    "drag_wall": (select_probe, {"axis": 1, "high": True, "metres": 0.3}),
    "fit": (move_box, {}),
    "hidden_add": (select_both, {}),
    "hidden_remove": (hide_table, {"index": 0}),
    "inject": (take_out, {}),
    "interior_add": (nothing, {"probes": "Probe"}),
    "interior_add_pictures": (nothing, {"directory": "//", "files": [{"name": PICTURE}]}),
    "lock": (select_probe, {"locked": True}),
    "mirrored_view_add": (select_table, {}),
    "node_add": (select_table, {"probe": "Probe"}),
    "picture_choose": (select_probe, {"filepath": f"//{PICTURE}"}),
    "preset": (select_probe, {"preset": "FINAL"}),
    "preset_load": (save_preset, {"filepath": f"//{PRESET}"}),
    "probe_add": (nothing, {"name": "Second"}),
    "remove": (nothing, {}),
    "select": (select_table, {"which": "ALL"}),
}
TELLING: dict[str, tuple[Callable[[], None], dict[str, object]]] = {
    "bake_forget": (nothing, {}),
    "misfit": (select_probe, {}),
    "plan": (nothing, {}),
    "state": (nothing, {"probe": "Probe"}),
    "status": (nothing, {}),
}
OTHERWISE = {"bake_cancel", "bake_frames", "export", "judge", "manual", "preset_add"}
"""Stops a bake that runs; starts the bake, whose step it is; writes files alone (test_export.py); changes what
viewports show alone, which undo keeps (test_judging.py); opens a browser; writes a file beside Blender's presets."""


def operators() -> set[str]:
    ours = (cls for cls in bpy.types.Operator.__subclasses__() if cls.is_registered and cls.__name__.startswith("PCC_"))
    return {cls.bl_idname.removeprefix("pcc.") for cls in ours}


def test_every_operator_is_tried() -> None:
    assert operators() == {*CHANGING, *TELLING} | OTHERWISE


def settled() -> dict[str, str]:
    """All data; read twice, as some properties come into being when they are first read."""
    bpy.context.view_layer.update()
    handlers.bring_all_up_to_date(bpy.context.scene)  # as undo does
    formulas = [tree for tree in bpy.data.node_groups if (marks.role(tree) or "").startswith("formula: ")]
    dump(without=formulas)
    return {
        path: line
        for path, line in dump(without=formulas).items()
        if not (path.endswith(_OF_BLENDER) or "<bpy id prop" in line)
    }


_OF_BLENDER = "particle_edit.object"  # follows the active object, sooner or later


@dataclass(frozen=True)
class Steps:
    """Counts undo steps."""

    capfd: pytest.CaptureFixture

    def count(self) -> int:
        self.capfd.readouterr()
        bpy.context.window_manager.print_undo_steps()
        [count] = re.findall(r"Undo (\d+) Steps", self.capfd.readouterr().out)
        return int(count)


@pytest.fixture
def measured(monkeypatch, tmp_path: Path) -> None:
    """A measurement of costs that has been made."""

    class Measured:
        notes, folder, report = (), tmp_path, replace(example(), probe="Probe")

        def __init__(self, *_: object, **__: object) -> None:
            pass

        def run(self) -> None:
            pass

    monkeypatch.setattr(cost, "CostProcess", Measured)


def run(name: str, options: dict[str, object]) -> None:
    assert getattr(bpy.ops.pcc, name)("EXEC_DEFAULT", True, **options) == {"FINISHED"}


def prepare(home: Path, act: Callable[[], None]) -> dict[str, str]:
    write_png(home.with_name(PICTURE), np.full((4, 8, 3), 0.5))
    act()
    before = settled()
    bpy.ops.ed.undo_push(message="before")
    return before


@pytest.mark.parametrize("name", CHANGING)
def test_an_operator_is_one_step_that_takes_all_of_it_back(home: Path, capfd, measured, name: str) -> None:
    act, options = CHANGING[name]
    before, steps = prepare(home, act), Steps(capfd)
    count = steps.count()
    run(name, options)
    assert steps.count() == count + 1
    after = settled()
    assert difference(before, after)
    bpy.ops.ed.undo()
    assert difference(before, settled()) == []
    bpy.ops.ed.redo()
    assert difference(after, settled()) == []


@pytest.mark.parametrize("name", TELLING)
def test_an_operator_that_tells_something_changes_nothing_and_is_no_step(home: Path, capfd, name: str) -> None:
    act, options = TELLING[name]
    before, steps = prepare(home, act), Steps(capfd)
    count = steps.count()
    run(name, options)
    assert steps.count() == count and difference(before, settled()) == []
