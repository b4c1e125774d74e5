"""What the last measurement of costs found, as a table in the probe's tab."""

from __future__ import annotations

import bpy

from ...core.accuracy import labels
from ...core.accuracy.advice import Advice
from ...core.accuracy.front import Axis, error_of, front
from ...core.accuracy.page import HTML_NAME
from ...core.accuracy.records import CostReport, Measurement
from ..kept import last_cost
from ..sentences import room, say, unit, width
from .of_probe import OfBake

_MOST_ROWS = 8


class PCC_PT_accuracy(OfBake, bpy.types.Panel):
    bl_label = "Accuracy"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        row = layout.row(align=True)
        row.operator("pcc.cost", text="Measure", icon="TIME")
        row.operator("pcc.cost", text="Quick").quick = True
        known = last_cost.of_file()
        if known is None:
            return
        report, found = known
        if report.probe != context.object.name:
            say(layout.column(align=True), context, f"Last measured: '{report.probe}'")
            return
        column = layout.column(align=True)
        for sentence in found.sentences[:2]:
            say(column, context, sentence, "INFO")
        _draw_table(layout, context, report, found)
        row = layout.row(align=True)
        row.operator_menu_enum("pcc.cost_show", "plot", icon="IMAGE_DATA")
        row.operator("wm.path_open", text="Page", icon="URL").filepath = str(last_cost.folder() / HTML_NAME)


def _draw_table(layout: bpy.types.UILayout, context: bpy.types.Context, report: CostReport, found: Advice) -> None:
    """The front of error against bake seconds, the recommended setting marked.

    Settings have a column where there is room for them, else a line each under the numbers.
    """
    best = front(report, Axis.BAKE)[-_MOST_ROWS:]
    table = [_HEADS, *(_cells(report, report.measurements[k]) for k in best)]
    widths = [max(width(context, cells[k]) for cells in table) + unit(context) for k in range(4)]
    wide = sum(widths) <= room(context, 1.0)
    lines = layout.column(align=True)
    for k, cells in zip((None, *best), table, strict=True):
        row = lines.row(align=True)
        row.label(text="", icon="CHECKMARK" if k is not None and k == found.recommended else "BLANK1")
        for cell, taken in zip(cells[:3], widths, strict=False):
            column = row.row()
            column.ui_units_x = taken / unit(context)
            column.label(text=cell)
        if wide:
            row.label(text=cells[3])
        elif k is not None:
            say(lines, context, cells[3])


_HEADS = ("Error", "Bake", "Frame", "Setting")


def _cells(report: CostReport, one: Measurement) -> tuple[str, str, str, str]:
    return (
        labels.error(error_of(report, one)),
        labels.seconds(one.bake_seconds),
        labels.seconds(one.frame_seconds),
        f"{labels.CORRECTIONS[one.settings.correction]}, {one.settings.resolution} px",
    )


CLASSES = (PCC_PT_accuracy,)
