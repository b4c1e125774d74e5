"""Runs inside a real Blender: from an open room to what its floor mirrors, as the first page tells it.

`blender FILE --python first_probe.py -- FOLDER` writes pictures into the folder, and ends Blender.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
from mathutils import Euler, Vector

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the scripts beside this one are too
import pointing  # noqa: E402
from driving import drive  # noqa: E402

RUNNING = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.ui.kept.running_bake"))
FOUND: dict[str, object] = {"crops": {}}
_PATIENCE = 1200  # steps that a bake may take
_MENU = (30, 50, 560, 270)  # pixels left of, above, right of and below the pointer


def prepare(window: bpy.types.Window) -> None:
    """The room from above, without its ceiling; the cursor is on its floor."""
    bpy.context.preferences.use_preferences_save = False
    for item in bpy.context.scene.objects:
        item.select_set(False)
    floor, ceiling = (bpy.data.objects[f"Wall {side}"] for side in ("-Z", "+Z"))
    ceiling.hide_set(True)
    centre = floor.matrix_world @ Vector()
    bpy.context.scene.cursor.location = centre + Vector((0.3, 0.2, 0.0))
    region = space().region_3d
    region.view_perspective, region.view_location, region.view_distance = "PERSP", centre, 21.0
    region.view_rotation = Euler((math.radians(42.0), 0.0, math.radians(8.0))).to_quaternion()
    space().shading.type, space().show_region_ui = "SOLID", True
    bpy.ops.ed.undo_push(message="Prepared")


def space() -> bpy.types.SpaceView3D:
    return pointing.view()[0].spaces.active


def sidebar() -> bpy.types.Region:
    return next(region for region in pointing.view()[0].regions if region.type == "UI")


def wait(rounds: int = 3) -> Iterator[None]:
    for _ in range(rounds):
        pointing.view()[0].tag_redraw()
        yield


def keep(name: str, crop: tuple[int, int, int, int]) -> None:
    pointing.keep_screen(FOLDER / f"{name}.png")
    FOUND["crops"][name] = crop


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield from wait()
    sidebar().active_panel_category = "Probes"
    yield from wait()
    yield from add()
    yield from bake()
    bpy.ops.pcc.inject("INVOKE_DEFAULT")
    yield from wait()
    keep("first_probe_injected", pointing.edges(pointing.view()[0], "UI"))


def add() -> Iterator[None]:
    """By the menu, as a person does."""
    left, top, right, bottom = pointing.edges(pointing.view()[0], "WINDOW")
    x, y = left + (right - left) // 4, top + (bottom - top) // 4
    pointing.move(x, y)
    yield
    pointing.xdotool("key", "shift+a")
    yield from wait()
    pointing.xdotool("type", "parallax")
    yield from wait(4)
    keep("first_probe_menu", (x - _MENU[0], y - _MENU[1], x + _MENU[2], y + _MENU[3]))
    pointing.xdotool("key", "Return")
    yield from wait(4)
    keep("first_probe_added", pointing.edges(pointing.view()[0]))


def bake() -> Iterator[None]:
    bpy.ops.wm.save_mainfile()
    bpy.ops.pcc.bake("INVOKE_DEFAULT", scope="STALE")
    kept = False
    for _ in range(_PATIENCE):
        yield
        running = RUNNING.running()
        if running is None:
            break
        if not kept and running.progress > 0.3:
            keep("first_probe_bake", pointing.edges(pointing.view()[0], "UI"))
            kept = True
    yield from wait()


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "first_probe.json")
