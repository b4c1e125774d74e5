"""Runs inside a real Blender with a screen: the pointer and the keys, as xdotool moves them."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

_TAB, _ROW = 14, 9  # pixels: a part of a tab's height, of a button's
MISSING = "" if shutil.which("xdotool") else "xdotool is not installed beside the real Blender"


def xdotool(*words: object) -> str:
    return subprocess.run(["xdotool", *map(str, words)], capture_output=True, text=True, check=True).stdout


def _window() -> str:
    return xdotool("search", "--onlyvisible", "--class", "blender").split()[-1]


def move(x: int, y: int) -> None:
    """Put the pointer into the window, from its upper left corner, pixels."""
    xdotool("mousemove", "--window", _window(), x, y)


def shortcut(keys: str) -> None:
    """Press keys, such as "ctrl+z", where the pointer is."""
    xdotool("key", keys)


def click(place: tuple[int, int], button: int = 1, held: str = "") -> Iterator[float]:
    """Click a pixel of the window, with a key held where one is named."""
    move(*place)
    yield 0.3
    if held:
        xdotool("keydown", held)
    xdotool("click", button)
    yield 0.1
    if held:
        xdotool("keyup", held)
    yield 0.5


def region_of(kind: str) -> bpy.types.Region:
    """A region of the 3D view."""
    return next(region for region in view()[0].regions if region.type == kind)


def open_tab(name: str) -> Iterator[float]:
    """Click down the tabs of the sidebar until the one with a name is open."""
    sidebar = region_of("UI")
    height = bpy.context.window_manager.windows[0].height
    x = sidebar.x + sidebar.width - _TAB
    for y in range(height - sidebar.y - sidebar.height + _TAB, height - sidebar.y, _TAB):
        yield from click((x, y))
        if region_of("UI").active_panel_category == name:
            return
    raise AssertionError(f"no tab '{name}'")


def button(command: str, of_width: float = 0.33) -> Iterator[float]:
    """Move down the sidebar until the pointer is on a button; returns the pixel.

    Args:
        command: what Blender says that the button does, as Python: a part of it.
        of_width: where in the sidebar the pointer moves, a share of its width.
    """
    manager, sidebar = bpy.context.window_manager, region_of("UI")
    height = manager.windows[0].height
    x = sidebar.x + int(of_width * sidebar.width)
    for y in range(height - sidebar.y - sidebar.height, height - sidebar.y, _ROW):
        move(x, y)
        yield 0.1
        manager.clipboard = ""
        with bpy.context.temp_override(window=manager.windows[0], area=view()[0], region=sidebar):
            if bpy.ops.ui.copy_python_command_button.poll():
                bpy.ops.ui.copy_python_command_button()
        if command in manager.clipboard:
            return x, y
    raise AssertionError(f"no button does {command}")


def keep_screen(path: Path) -> None:
    """Save what the window shows, popups and handles included, where ImageMagick is there to do it."""
    if shutil.which("import"):
        subprocess.run(["import", "-window", _window(), str(path)], check=True)


def view() -> tuple[bpy.types.Area, bpy.types.Region]:
    """The 3D view."""
    area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "VIEW_3D")
    return area, next(region for region in area.regions if region.type == "WINDOW")


def edges(area: bpy.types.Area, region: str = "") -> tuple[int, int, int, int]:
    """Left, top, right and bottom of an area, or of one of its regions, in the window, from its upper left corner."""
    part = next((found for found in area.regions if found.type == region), area)
    top = bpy.context.window_manager.windows[0].height - part.y - part.height
    return part.x, top, part.x + part.width, top + part.height


def pixel(place: Vector) -> tuple[int, int]:
    """Where a place of the world, metres, is in the window."""
    area, region = view()
    at = location_3d_to_region_2d(region, area.spaces.active.region_3d, place)
    return int(region.x + at.x), int(bpy.context.window_manager.windows[0].height - 1 - region.y - at.y)


def drag(start: tuple[int, int], end: tuple[int, int], key: str = "", *, cancel: bool = False) -> Iterator[None]:
    """Drag from one pixel to another; Blender draws between the steps."""
    move(*start)
    yield
    yield
    xdotool("mousedown", 1)
    yield
    if key:
        xdotool("keydown", key)
    for k in range(1, 5):
        move(*(round(a + (b - a) * k / 4) for a, b in zip(start, end, strict=True)))
        yield
    if cancel:
        xdotool("key", "Escape")
        yield
    xdotool("mouseup", 1)
    if key:
        xdotool("keyup", key)
    yield
    yield
