"""Runs inside a real Blender, beside a script that drives it: its steps, one after the other, and what it found."""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

_BETWEEN = 0.5  # seconds, in which Blender draws


def drive(
    prepare: Callable[[bpy.types.Window], None],
    steps: Callable[[], Iterator[None]],
    found: dict[str, object],
    path: Path,
) -> None:
    """Once the window is there, prepare it and take the steps; then write what was found as JSON, and end Blender.

    Args:
        prepare: gets the window.
        steps: what is done; Blender draws and runs its timers at each `yield`.
        found: what is written, with "done", or "error" where something was raised.
        path: the file.
    """
    going: list[Iterator[None]] = []

    def step() -> float | None:
        window = bpy.context.window_manager.windows[0]
        with bpy.context.temp_override(window=window):
            try:
                if not going:
                    prepare(window)
                    going.append(steps())
                next(going[0])
                return _BETWEEN
            except StopIteration:
                found["done"] = True
            except Exception:
                found["error"] = traceback.format_exc()
            finally:
                path.write_text(json.dumps(found), encoding="utf-8")
            bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(step, first_interval=1.0)
