"""Which effects are on, why, and what an artist chooses instead: panels of probes and of materials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy

from ...core.decisions import Decision, Effect
from ...core.plan_report import price
from ..kept import last_plan
from ..sentences import room, say, width

ON, OFF = "CHECKMARK", "REMOVE"
_CHOICES, _MENU = 6.5, 2.7  # units of width that Auto, On and Off take beside each other, and as a menu

Said = tuple[str, Decision]
"""Of which surface something was decided, or "" where there is but one, and what."""


def draw_plan_button(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The button that plans, and what is to be said of the last plan."""
    last = last_plan.of(context.scene)
    column = layout.column(align=True)
    column.operator("pcc.plan", icon="FILE_REFRESH", text="Plan")
    if last is not None and last.late:
        say(column, context, "Planned before the last change")


def draw_effects(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    settings: bpy.types.PropertyGroup,
    effects: Sequence[Effect],
    decisions: Mapping[Effect, Sequence[Said]],
) -> None:
    """A row for each effect: whether it is on, the choice, and under it why and what that costs or saves.

    Effects of which nothing was decided are left out, unless that holds for all.
    """
    rows = [effect for effect in effects if effect in decisions or getattr(settings, effect.key) != "AUTO"]
    rows = rows if decisions else list(effects)
    widest = max(width(context, effect.label) for effect in rows)
    spread = widest <= room(context, 1.0 + _CHOICES)
    taken = _CHOICES if spread else _MENU
    for effect in rows:
        said = decisions.get(effect, ())
        column = layout.column(align=True)
        row = column.split(factor=room(context, taken) / room(context))
        say(row.column(align=True), context, effect.label, _icon(said), quiet=False, beside=taken)
        choice = row.row(align=True)
        if spread:
            choice.prop(settings, effect.key, expand=True)
        else:
            choice.prop(settings, effect.key, text="")
        for surface, decision in said:
            cost = price(decision)
            why = f"{decision.why}; {cost}" if cost else decision.why
            if surface:
                say(column, context, f"{surface}: {why}", ON if decision.on else OFF)
            else:
                say(column, context, why)


def _icon(said: Sequence[Said]) -> str:
    if not said:
        return "BLANK1"
    return ON if any(decision.on for _, decision in said) else OFF
