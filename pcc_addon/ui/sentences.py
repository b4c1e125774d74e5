"""Sentences in panels: labels do not wrap, so they are broken where a region ends."""

from __future__ import annotations

from collections.abc import Callable

import blf
import bpy

_UNIT = 20  # pixels of a row's height, which icons and margins are multiples of, at a scale of 1
_MARGINS = 2.3  # units of a region that panels, labels and the scroll bar take
_TABS = 1.0  # units that the tabs of a sidebar take
_TIGHT = 0.75  # height of a row of small print


def fold(text: str, room: float, width: Callable[[str], float]) -> list[str]:
    """A text as lines that fit into some room; a word that is wider is broken.

    Args:
        text: words.
        room: how wide a line may be.
        width: how wide a piece of text is.
    """
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if width(longer) <= room:
            lines[-1] = longer
            continue
        pieces = _broken(word, room, width)
        lines += pieces if lines[-1] else ()
        lines = lines if lines[-1] else pieces
    return lines


def _broken(word: str, room: float, width: Callable[[str], float]) -> list[str]:
    pieces = [""]
    for letter in word:
        if pieces[-1] and width(pieces[-1] + letter) > room:
            pieces.append("")
        pieces[-1] += letter
    return pieces


def unit(context: bpy.types.Context) -> float:
    """How wide an icon is, in pixels."""
    return _UNIT * (context.preferences.system.ui_scale or 1.0)


def width(context: bpy.types.Context, text: str) -> float:
    """How wide a label is, in pixels, its margins and icon apart."""
    size = context.preferences.ui_styles[0].widget.points * (context.preferences.system.ui_scale or 1.0)
    blf.size(0, size)
    return blf.dimensions(0, text)[0]


def room(context: bpy.types.Context, units: float = 0.0) -> float:
    """How wide a label may be in the region that is drawn, in pixels before zooming, `units` beside it taken off."""
    region = context.region
    left, right = (region.view2d.region_to_view(x, 0)[0] for x in (0, region.width))
    taken = _MARGINS + units + (_TABS if region.type == "UI" else 0.0)
    return max(right - left - taken * unit(context), 4.0 * unit(context))


def say(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    text: str,
    icon: str = "BLANK1",
    *,
    quiet: bool = True,
    beside: float = 0.0,
) -> None:
    """Write a sentence, on as many lines as it takes.

    Args:
        layout: where to; its rows should be aligned.
        context: what is drawn.
        text: the sentence, or a name that is written large.
        icon: before its first line.
        quiet: whether it is small print, which begins with a capital.
        beside: units of width that something beside it takes.
    """
    text = text[:1].upper() + text[1:] if quiet else text
    for index, line in enumerate(fold(text, room(context, 1.0 + beside), lambda piece: width(context, piece))):
        row = layout.row()
        row.active = not quiet
        if quiet or index:
            row.scale_y = _TIGHT
        row.label(text=line, icon="BLANK1" if index else icon)
