"""What the last measurement of costs found: a table in the probe's tab, its plots in an Image Editor, its page."""

from __future__ import annotations

import contextlib
from pathlib import Path

import bpy

from ..blender.accuracy.applying import results_folder
from ..core.accuracy import files, labels
from ..core.accuracy.advice import Advice, advice
from ..core.accuracy.front import Axis, error_of, front
from ..core.accuracy.page import HTML_NAME
from ..core.accuracy.plots import NAMES
from ..core.accuracy.records import CostReport
from ..core.errors import PccError
from .probe_panel import OfBake
from .sentences import say

_MOST_ROWS = 8
_known: dict[Path, tuple[float, CostReport, Advice]] = {}  # by folder, with the time of the file that was read


class PCC_OT_cost_show(bpy.types.Operator):
    """Show what was measured as plots of error against seconds, in an Image Editor"""

    bl_idname = "pcc.cost_show"
    bl_label = "Show Plots"
    bl_options = {"REGISTER", "UNDO"}

    plot: bpy.props.EnumProperty(
        name="Plot",
        items=[
            ("error_frame", "Error and Frame", "Error against the seconds of a frame"),
            ("error_bake", "Error and Bake", "Error against the seconds of the bake"),
            ("error_rungs", "Settings", "The error of each setting"),
        ],
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        folder = _folder()
        if folder is None or not all((folder / f"{name}.png").is_file() for name in NAMES):
            cls.poll_message_set("There are no plots beside the .blend: measure, with a Python that has matplotlib")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        image = bpy.data.images.load(str(_folder() / f"{self.plot}.png"), check_existing=True)
        image.reload()
        editor = next((area for area in context.screen.areas if area.type == "IMAGE_EDITOR"), None)
        if editor is None and not bpy.app.background:
            bpy.ops.wm.window_new()
            editor = context.window_manager.windows[-1].screen.areas[0]
            editor.type = "IMAGE_EDITOR"
        if editor is not None:
            editor.spaces.active.image = image
        return {"FINISHED"}


class PCC_PT_accuracy(OfBake, bpy.types.Panel):
    bl_label = "Accuracy"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        row = layout.row(align=True)
        row.operator("pcc.cost", text="Measure", icon="TIME")
        row.operator("pcc.cost", text="Quick").quick = True
        known = _last()
        if known is None:
            return
        report, found = known
        if report.probe != context.object.name:
            say(layout.column(align=True), context, f"Last measured: '{report.probe}'")
            return
        column = layout.column(align=True)
        for sentence in found.sentences[:2]:
            say(column, context, sentence, "INFO")
        _draw_table(layout, report, found)
        row = layout.row(align=True)
        row.operator_menu_enum("pcc.cost_show", "plot", icon="IMAGE_DATA")
        row.operator("wm.path_open", text="Page", icon="URL").filepath = str(_folder() / HTML_NAME)


def _draw_table(layout: bpy.types.UILayout, report: CostReport, found: Advice) -> None:
    """The front of error against bake seconds, the recommended setting marked."""
    grid = layout.grid_flow(row_major=True, columns=4, align=True)
    for head in ("Error", "Bake", "Frame", "Setting"):
        grid.label(text=head)
    for k in front(report, Axis.BAKE)[-_MOST_ROWS:]:
        one = report.measurements[k]
        cells = (
            labels.error(error_of(report, one)),
            labels.seconds(one.bake_seconds),
            labels.seconds(one.frame_seconds),
            f"{labels.CORRECTIONS[one.settings.correction]}, {one.settings.resolution} px",
        )
        for place, cell in enumerate(cells):
            grid.label(text=cell, icon="CHECKMARK" if k == found.recommended and not place else "NONE")


def _folder() -> Path | None:
    return results_folder(Path(bpy.data.filepath)) if bpy.data.filepath else None


def _last() -> tuple[CostReport, Advice] | None:
    """What was found of the open file, read again when it has changed; None where that is nothing."""
    folder = _folder()
    try:
        time = (folder / files.JSON_NAME).stat().st_mtime if folder is not None else None
    except OSError:
        return None
    if time is None:
        return None
    if folder not in _known or _known[folder][0] != time:
        _known.pop(folder, None)
        with contextlib.suppress(PccError):  # a damaged file; the next measurement writes another
            report = files.read(folder)
            if report is not None:
                _known[folder] = (time, report, advice(report))
    return _known[folder][1:] if folder in _known else None


CLASSES = (PCC_OT_cost_show, PCC_PT_accuracy)
