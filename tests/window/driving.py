"""Runs inside a real Blender, beside a script that drives it: its steps, what it found, what was drawn."""

from __future__ import annotations

import glob
import json
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import gpu
import numpy as np

_BETWEEN = 0.5  # seconds, in which Blender draws


def drive(
    prepare: Callable[[bpy.types.Window], None],
    steps: Callable[[], Iterator[float | None]],
    found: dict[str, object],
    path: Path,
) -> None:
    """Once the window is there, prepare it and take the steps; then write what was found as JSON, and end Blender.

    Args:
        prepare: gets the window.
        steps: what is done; Blender draws and runs its timers at each `yield`, for as many seconds as that says.
        found: what is written, with "done", or "error" where something was raised.
        path: the file.
    """
    going: list[Iterator[float | None]] = []

    def step() -> float | None:
        window = bpy.context.window_manager.windows[0]
        with bpy.context.temp_override(window=window):
            try:
                if not going:
                    prepare(window)
                    going.append(steps())
                return next(going[0]) or _BETWEEN
            except StopIteration:
                found["done"] = True
            except Exception:
                found["error"] = traceback.format_exc()
            finally:
                path.write_text(json.dumps(found), encoding="utf-8")
            bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(step, first_interval=1.0, persistent=True)  # steps may open files


def light_theme() -> bool:
    """Draw in Blender's light theme; whether this Blender has it."""
    [found] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if found:
        bpy.ops.script.execute_preset(filepath=found, menu_idname="USERPREF_MT_interface_theme_presets")
    return bool(found)


def drawn_region() -> np.ndarray:
    """(h, w, 4) uint8, row 0 at the bottom: what was drawn of the region whose handler asks."""
    x, y, width, height = gpu.state.viewport_get()
    pixels = gpu.state.active_framebuffer_get().read_color(x, y, width, height, 4, 0, "UBYTE")
    pixels.dimensions = width * height * 4
    return np.array(pixels, np.uint8).reshape(height, width, 4)


def colours_of(drawn: np.ndarray) -> int:
    """How many colours a picture has."""
    return len(np.unique(drawn[..., :3].reshape(-1, 3), axis=0))


def keep_png(drawn: np.ndarray, path: Path) -> None:
    """Save what `drawn_region` gave."""
    height, width = drawn.shape[:2]
    image = bpy.data.images.new(path.stem, width, height)
    image.pixels.foreach_set((drawn.astype(np.float32) / 255.0).ravel())
    image.file_format, image.filepath_raw = "PNG", str(path)
    image.save()
    bpy.data.images.remove(image)
