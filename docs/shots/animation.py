"""Runs inside a real Blender: the question that *Bake Frames* asks.

`blender FILE --python animation.py -- FOLDER` writes pictures into the folder, and ends Blender.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the scripts beside this one are too
import pointing  # noqa: E402
from driving import drive  # noqa: E402

FOUND: dict[str, object] = {"crops": {}}
_AROUND = (310, 75, 65, 155)  # pixels left of, above, right of and below the pointer


def prepare(window: bpy.types.Window) -> None:
    bpy.context.preferences.use_preferences_save = False


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    left, top, right, bottom = pointing.edges(pointing.view()[0], "WINDOW")
    x, y = (left + right) // 2, (top + bottom) // 2
    pointing.move(x, y)
    yield
    bpy.ops.pcc.bake_frames("INVOKE_DEFAULT")
    for _ in range(4):
        yield
    pointing.keep_screen(FOLDER / "animation_dialog.png")
    FOUND["crops"]["animation_dialog"] = (x - _AROUND[0], y - _AROUND[1], x + _AROUND[2], y + _AROUND[3])
    pointing.xdotool("key", "Escape")
    yield


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "animation.json")
