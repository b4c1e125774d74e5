"""Lets what is drawn show what is known now."""

from __future__ import annotations

import bpy


def redraw() -> None:
    """Draw all panels and viewports anew."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "VIEW_3D"}:
                area.tag_redraw()


def redraw_panels() -> None:
    """Draw panels and status bars anew, and no viewports."""
    panels = {("PROPERTIES", "WINDOW"), ("VIEW_3D", "UI")}
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if (area.type, region.type) in panels and region.width > 1:
                    region.tag_redraw()
        if not window.modal_operators:  # their text is there, which this would clear
            with bpy.context.temp_override(window=window):
                window.workspace.status_text_set_internal(None)
