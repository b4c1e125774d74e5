"""The bake that runs in the background, what became of the last one, or what the next will take."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...blender.compat import CAN_DENOISE
from ...blender.read.probes import all_probes, bake_record, probe_spec
from ...blender.store.levels import bake_folder
from ...blender.store.pictures import blend_path
from ...core.accuracy import labels
from ...core.errors import PccError
from ...core.forecast import Order, forecast
from ..kept import last_plan, running_bake
from ..sentences import say

_TALL = 1.4  # buttons' heights


def draw_progress(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What there is to say of bakes: of the active probe's in its tab, of all probes' elsewhere."""
    column = layout.column(align=True)
    if running_bake.running() is not None:
        _draw_bar(column)
        say(column, context, running_bake.words())
        return
    _draw_outcome(column, context)
    own = context.area.type == "PROPERTIES"
    probes = [context.object] if own else all_probes(context.scene)
    for line in _prospects(context.scene, probes):
        say(column, context, line)


def draw_in_status_bar(header: bpy.types.Header, context: bpy.types.Context) -> None:
    """How far the bake is that runs, and a way to end it, whatever panels are open."""
    if running_bake.running() is not None:
        row = header.layout.row(align=True)
        row.label(text="Bake", icon="RENDER_STILL")
        _draw_bar(row)


def draw_show_button(layout: bpy.types.UILayout, scope: str, text: str) -> None:
    """What one wants most: bake the probes in scope, and see them."""
    column = layout.column()
    column.scale_y = _TALL
    button = column.operator("pcc.bake", icon="SHADING_RENDERED", text=text)
    button.scope, button.show = scope, True


def _draw_bar(layout: bpy.types.UILayout) -> None:
    progress = running_bake.running().progress
    row = layout.row(align=True)
    row.progress(factor=progress, text=f"{progress:.0%}")
    row.operator("pcc.bake_cancel", icon="CANCEL", text="")


def _draw_outcome(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What became of the last bake, until the next."""
    last = running_bake.outcome()
    if last is None:
        return
    lines = [("CHECKMARK", last.done)] * bool(last.done)
    lines += [("ERROR", line) for line in last.errors] + [("INFO", line) for line in last.notes]
    row = layout.row(align=True)
    column = row.column(align=True)
    for icon, line in lines:
        say(column, context, line, icon, beside=1.0)
    row.operator("pcc.bake_forget", icon="X", text="", emboss=False)


def _prospects(scene: bpy.types.Scene, probes: Sequence[bpy.types.Object]) -> list[str]:
    """Where pictures will go, how large they will be, and how long that will take, as far as anybody knows."""
    last = last_plan.of(scene)
    orders = []
    for probe in probes:
        planned = last.plan.probe(probe.name) if last is not None else None
        try:
            orders.append(Order(probe_spec(probe), bake_record(probe), len(planned.pictures) if planned else None))
        except PccError:  # status tells
            continue
    if not orders:
        return []
    found, folder = forecast(orders), bake_folder(scene)
    if folder is None:
        place = "pictures are packed into the file, as it is not saved"
    else:
        place = f"pictures go into {blend_path(folder)}"
    took = (
        f", in about {labels.seconds(found.seconds)}" if found.seconds else "; the first bake tells how long it takes"
    )
    return [f"{place}: about {_in_bytes(found.size)}{took}"]


def _in_bytes(size: int) -> str:
    """Such as "13 kB", "1.2 MB" or "340 MB"; two digits at least."""
    for unit, step in (("kB", 1e3), ("MB", 1e6)):
        if size < 1000 * step:
            return f"{size / step:.2g} {unit}" if size < 100 * step else f"{size / step:.0f} {unit}"
    return f"{size / 1e9:.1f} GB"


def draw_denoise(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The active probe's *Denoise*; where this Blender cannot, it says so."""
    row = layout.row()
    row.enabled = CAN_DENOISE
    row.prop(context.object.pcc_probe, "denoise")
    if not CAN_DENOISE:
        say(layout.column(align=True), context, "This Blender was built without a denoiser")


def register() -> None:
    bpy.types.STATUSBAR_HT_header.append(draw_in_status_bar)


def unregister() -> None:
    bpy.types.STATUSBAR_HT_header.remove(draw_in_status_bar)
