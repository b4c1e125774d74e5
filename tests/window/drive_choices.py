"""Runs inside a real Blender: chooses what a material and an object show, as panels do, and keeps pictures of these.

`blender FILE --python drive_choices.py -- FOLDER` writes pictures and `choices.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import glob
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the script beside this one is too
from driving import colours_of, drawn_region, drive, keep_png  # noqa: E402

TWIN = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.blender.shade.twin"))
FOUND: dict[str, object] = {"states": [], "pictures": {}}
_wanted = ""  # what the next drawn picture is of


def properties() -> bpy.types.Area:
    screen = bpy.context.window_manager.windows[0].screen
    return max((area for area in screen.areas if area.type == "PROPERTIES"), key=lambda area: area.height)


def prepare(window: bpy.types.Window) -> None:
    """A high column for panels, ours open."""
    preferences = bpy.context.preferences
    preferences.use_preferences_save, preferences.view.show_splash = False, False
    panel = next(cls for cls in bpy.types.Panel.__subclasses__() if cls.__name__ == "PCC_PT_object")
    bpy.utils.unregister_class(panel)
    panel.bl_options = set()
    bpy.utils.register_class(panel)
    outliner = next(area for area in window.screen.areas if area.type == "OUTLINER")
    with bpy.context.temp_override(window=window, area=outliner, region=outliner.regions[-1]):
        bpy.ops.screen.area_close()
    bpy.types.SpaceProperties.draw_handler_add(keep_picture, (), "WINDOW", "POST_PIXEL")
    bpy.context.view_layer.objects.active = bpy.data.objects["Wall -Z"]


def picture(name: str, tab: str) -> Iterator[None]:
    """Show a tab, and keep a picture of it once it is drawn."""
    global _wanted
    properties().spaces.active.context = tab
    yield
    region = next(region for region in properties().regions if region.type == "WINDOW")
    with bpy.context.temp_override(area=properties(), region=region):
        bpy.ops.view2d.pan(deltax=0, deltay=-5000)  # to the end
    _wanted = name
    properties().tag_redraw()
    yield
    _wanted = ""


def keep_picture() -> None:
    """Save what was drawn of a region."""
    if not _wanted:
        return
    drawn = drawn_region()
    FOUND["pictures"][_wanted] = colours_of(drawn)
    keep_png(drawn, FOLDER / f"{_wanted}.png")


def state() -> list[object]:
    """What is chosen, and whether the floor shows a probe now."""
    floor = bpy.data.objects["Wall -Z"]
    worn, mirror = floor.material_slots[0].material, bpy.data.materials["Mirror"]
    chosen = mirror.pcc.probe.name if mirror.pcc.probe else ""
    return [chosen, mirror.pcc.show_probes, floor.pcc.show_probes, bool(TWIN.shown_probe_groups(worn))]


def choose(path: str, value: object) -> None:
    """As a panel does: with an undo step."""
    if isinstance(value, str):
        bpy.ops.wm.context_set_id("EXEC_DEFAULT", True, data_path=path, value=value)
    else:
        bpy.ops.wm.context_set_value("EXEC_DEFAULT", True, data_path=path, value=repr(value))
    FOUND["states"].append(state())


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    yield from picture("material, not planned", "MATERIAL")
    bpy.ops.pcc.plan()
    bpy.ops.ed.undo_push(message="before")
    FOUND["states"].append(state())
    yield from picture("material", "MATERIAL")
    yield from picture("object", "OBJECT")
    choose("object.active_material.pcc.probe", "Room")
    yield from picture("material, one probe", "MATERIAL")
    choose("object.active_material.pcc.show_probes", False)
    yield from picture("material, excluded", "MATERIAL")
    yield from picture("object, material excluded", "OBJECT")
    choose("object.active_material.pcc.show_probes", True)
    choose("object.pcc.show_probes", False)
    yield from picture("object, excluded", "OBJECT")
    yield from picture("material, object excluded", "MATERIAL")
    for act, name in ((bpy.ops.ed.undo, "undone"), (bpy.ops.ed.redo, "redone")):
        FOUND[name] = []
        for _ in range(4):
            act()
            yield
            FOUND[name].append(state())
    [light] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if light:
        bpy.ops.script.execute_preset(filepath=light, menu_idname="USERPREF_MT_interface_theme_presets")
        yield from picture("object, light", "OBJECT")
        yield from picture("material, light", "MATERIAL")


drive(prepare, steps, FOUND, FOLDER / "choices.json")
