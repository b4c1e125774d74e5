"""Runs inside a real Blender: the list of probes, clicked, and left alone until it knows how bakes stand.

`blender FILE --python drive_list.py -- FOLDER` writes pictures and `list.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import glob
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the script beside this one is too
from driving import colours_of, drawn_region, drive, keep_png  # noqa: E402

_IDLE = 6  # steps in which a check is made where one is to be
_wanted = ""  # what the next drawn picture is of
FOUND: dict[str, object] = {"pictures": {}}


def module(name: str) -> object:
    return next(module for known, module in sys.modules.items() if known.endswith(f"pcc_addon.ui.{name}"))


STATES, LAST_PLAN = module("kept.states"), module("kept.last_plan")
CHECKS: list[str] = []


def prepare(window: bpy.types.Window) -> None:
    """The sidebar is open beside a view of the probes, of which there are three."""
    preferences = bpy.context.preferences
    preferences.use_preferences_save, preferences.view.show_splash = False, False
    for name, place in (("Attic", (40.0, 0.0, 0.0)), ("Cellar", (50.0, 0.0, 0.0))):
        bpy.ops.pcc.probe_add(name=name, location=place, half_extents=(2.0, 2.0, 1.5))
    bpy.ops.ed.undo_push(message="Probes")
    view_area(window).spaces.active.show_region_ui = True
    bpy.types.SpaceView3D.draw_handler_add(keep_picture, (), "UI", "POST_PIXEL")
    check = LAST_PLAN.check

    def counted(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> object:
        CHECKS.append(scene.name)
        return check(scene, view_layer)

    LAST_PLAN.check = counted


def view_area(window: bpy.types.Window | None = None) -> bpy.types.Area:
    window = window or bpy.context.window_manager.windows[0]
    return next(area for area in window.screen.areas if area.type == "VIEW_3D")


def sidebar() -> bpy.types.Region:
    return next(region for region in view_area().regions if region.type == "UI")


def keep_picture() -> None:
    """Save what was drawn of the sidebar."""
    if not _wanted:
        return
    drawn = drawn_region()
    drawn[..., 3] = 255
    FOUND["pictures"][_wanted] = colours_of(drawn)
    keep_png(drawn, FOLDER / f"{_wanted}.png")


def pictures(name: str) -> Iterator[None]:
    """Wait until the sidebar is drawn, then keep it."""
    global _wanted
    yield
    _wanted = name
    view_area().tag_redraw()
    yield
    _wanted = ""


def states() -> dict[str, str]:
    """How each probe stands, as the list shows it."""
    scene = bpy.context.scene
    probes = [item for item in scene.objects if item.pcc_probe.is_probe]
    return {probe.name: STATES.of(scene, probe).state.name for probe in probes}


def idle() -> Iterator[None]:
    for _ in range(_IDLE):
        yield


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    sidebar().active_panel_category = "Probes"
    yield from idle()
    FOUND["by itself"] = states()
    yield from pictures("list")
    yield from click_rows()
    bpy.context.scene.pcc.preset = "PREVIEW"
    bpy.ops.pcc.probe_add("INVOKE_DEFAULT", name="New")
    FOUND["new"] = bpy.data.objects["New"].pcc_probe.resolution
    bpy.data.objects.remove(bpy.data.objects["New"])
    room = bpy.data.objects["Room"]
    bpy.context.view_layer.objects.active = room
    bpy.data.objects["Wall +X"].location.x += 0.05
    bpy.context.view_layer.update()
    FOUND["at once after a change"] = STATES.of(bpy.context.scene, room).late
    yield from idle()
    FOUND["after a change"] = states()
    checks = len(CHECKS)
    yield from idle()
    FOUND["checks with nothing to do"] = len(CHECKS) - checks
    bpy.ops.pcc.inject()
    yield from pictures("injected")
    [light] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if light:
        bpy.ops.script.execute_preset(filepath=light, menu_idname="USERPREF_MT_interface_theme_presets")
        yield from pictures("injected, light")
    for item in [item for item in bpy.context.scene.objects if item.pcc_probe.is_probe]:
        bpy.data.objects.remove(item)
    yield from pictures("no probes")
    FOUND["restored"] = list(bpy.ops.pcc.remove())


def click_rows() -> Iterator[None]:
    """Click down the list until another probe is active; where nothing can click, that is said."""
    if shutil.which("xdotool") is None:
        FOUND["clicked"] = None
        return
    region, window = sidebar(), bpy.context.window_manager.windows[0]
    before = bpy.context.view_layer.objects.active
    for down in range(40, 160, 12):
        x, y = region.x + 80, window.height - (region.y + region.height - down)
        subprocess.run(["xdotool", "mousemove", "--window", active_window(), str(x), str(y)], check=True)
        yield
        subprocess.run(["xdotool", "click", "1"], check=True)
        yield
        active = bpy.context.view_layer.objects.active
        if active != before:
            FOUND["clicked"] = [active.name, [item.name for item in bpy.context.selected_objects]]
            return
    FOUND["clicked"] = []


def active_window() -> str:
    found = subprocess.run(["xdotool", "getactivewindow"], capture_output=True, text=True, check=True)
    return found.stdout.strip()


FOUND["started"] = True
drive(prepare, steps, FOUND, FOLDER / "list.json")
