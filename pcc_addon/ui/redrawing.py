"""Lets what is drawn show what is known now."""

from __future__ import annotations

import bpy


def redraw() -> None:
    """Draw all panels and viewports anew."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "VIEW_3D"}:
                area.tag_redraw()
