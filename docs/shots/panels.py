"""Runs inside a real Blender: draws each panel of ours by itself, all of it, in a dark and in a light theme.

`blender FILE --python panels.py -- FOLDER` writes `NAME, dark.png` and `NAME, light.png` into the folder, and ends
Blender.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import bpy
import numpy as np
from mathutils import Vector

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the scripts beside this one are too
from driving import drawn_region, drive, keep_png, light_theme  # noqa: E402


def module(name: str) -> ModuleType:
    """A module of the installed add-on."""
    return next(found for known, found in sys.modules.items() if known.endswith(f"pcc_addon.ui.{name}"))


REGISTERING = module("registering")
FOUND: dict[str, object] = {"pictures": []}
TABS = {"data": "Lounge", "material": "Floor", "object": "Floor", "scene": "Lounge"}  # and what is active in each
_HIDDEN = {"PCC_PT_presets"}  # a menu
_TABS, _MARGIN, _BEHIND = 30, 8, 96  # pixels of the tabs' names and below a panel; grey
_PATIENCE = 60  # steps
_wanted = ""  # what the next drawn picture is of


def prepare(window: bpy.types.Window) -> None:
    """A high column for properties, the sidebar beside the 3D view, and no panels at all."""
    preferences = bpy.context.preferences
    preferences.use_preferences_save, preferences.view.show_splash = False, False
    view = area("VIEW_3D").spaces.active
    view.show_region_ui, view.overlay.show_overlays, view.show_gizmo = True, False, False
    view.region_3d.view_distance = 0.01  # nothing to draw
    bpy.types.VIEW3D_HT_header.remove(module("panels.judging").draw_in_header)  # would open a panel that is not there
    for panel in set(bpy.types.Panel.__subclasses__()) - set(panels()):
        if getattr(panel, "bl_context", "") in TABS:
            panel.poll = classmethod(lambda cls, context: False)
            if panel.__module__.startswith("bl_ui.") and panel.is_registered:
                with contextlib.suppress(RuntimeError):  # went with its parent
                    bpy.utils.unregister_class(panel)
    for panel in reversed(panels()):
        if panel.is_registered:
            bpy.utils.unregister_class(panel)
    outliner = next(area for area in window.screen.areas if area.type == "OUTLINER")
    with bpy.context.temp_override(window=window, area=outliner, region=outliner.regions[-1]):
        bpy.ops.screen.area_close()
    bpy.types.SpaceProperties.draw_handler_add(keep_picture, ("PROPERTIES",), "WINDOW", "POST_PIXEL")
    bpy.types.SpaceView3D.draw_handler_add(keep_picture, ("VIEW_3D",), "UI", "POST_PIXEL")


def panels() -> list[type[bpy.types.Panel]]:
    """Ours, in their order."""
    every = [cls for cls in REGISTERING._classes() if issubclass(cls, bpy.types.Panel)]
    return [cls for cls in every if cls.__name__ not in _HIDDEN]


def area(kind: str) -> bpy.types.Area:
    """The highest area of a kind."""
    found = [a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == kind]
    return max(found, key=lambda a: a.height)


def keep_picture(kind: str) -> None:
    """Save what was drawn of a region, down to where the panel ends."""
    if not _wanted or bpy.context.area != area(kind) or not _wanted.startswith(kind):
        return
    drawn = drawn_region()
    if kind == "VIEW_3D":  # which shows through the sidebar
        drawn = drawn[:, :-_TABS]
        share = drawn[..., 3:] / 255.0
        drawn[..., :3] = np.minimum(drawn[..., :3] + (1.0 - share) * _BEHIND, 255.0)
    drawn[..., 3] = 255
    empty = (drawn == drawn[:1, :1]).all(axis=(1, 2))
    low = max(int((~empty).argmax()) - _MARGIN, 0)
    keep_png(drawn[low:], FOLDER / f"{_wanted.partition(' ')[2]}.png")
    FOUND["pictures"].append(_wanted)


def wait(rounds: int = 2) -> Iterator[None]:
    for _ in range(rounds):
        for kind in ("PROPERTIES", "VIEW_3D"):
            for region in area(kind).regions:
                if region.type in ("UI", "WINDOW" if kind == "PROPERTIES" else "UI"):
                    region.tag_redraw()
        yield


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield from wait()
    activate("Lounge")
    add_window()
    bpy.ops.pcc.misfit()
    for _ in range(_PATIENCE):
        yield
        if module("kept.thumbnails").of(bpy.data.objects["Lounge"]) is not None:
            break
    yield from wait(4)  # until the new pane is no change any more
    bpy.ops.pcc.status()
    bpy.ops.pcc.plan()
    yield from every("dark")
    light_theme()
    yield from every("light")
    for panel in panels():  # as the add-on will want to take them away
        bpy.utils.register_class(panel)


def add_window() -> None:
    """A pane that shows the lounge, away from both rooms."""
    bpy.context.scene.cursor.location = bpy.data.objects["Lounge"].matrix_world @ Vector((0.0, -3.0, 0.0))
    bpy.ops.pcc.interior_add()
    bpy.context.object.name, bpy.context.object.hide_render = "Pane", True  # so that no bake is stale by it
    activate("Lounge")


def every(theme: str) -> Iterator[None]:
    for panel in panels():
        yield from shown(panel, theme)
    named = {panel.__name__: panel for panel in panels()}
    yield from shown(named["PCC_PT_interior"], theme, "Pane")
    bpy.data.objects["Study"].pcc_probe.source = "IMAGE"
    yield from shown(named["PCC_PT_probe"], theme, "Study", "probe_picture")
    bpy.data.objects["Study"].pcc_probe.source = "BAKE"


def activate(name: str) -> None:
    layer = bpy.context.view_layer
    for item in layer.objects.selected:
        item.select_set(False)
    layer.objects.active = bpy.data.objects[name]
    layer.objects[name].select_set(True)


def shown(panel: type[bpy.types.Panel], theme: str, active: str = "", name: str = "") -> Iterator[None]:
    """Show a panel by itself, open and under no other, of an active object, and keep a picture."""
    global _wanted
    tab = getattr(panel, "bl_context", "")
    activate(active or TABS.get(tab, "Lounge"))
    panel.bl_parent_id = ""
    panel.bl_options = getattr(panel, "bl_options", set()) - {"DEFAULT_CLOSED"}
    bpy.utils.register_class(panel)
    yield from wait(1)
    if tab:
        area("PROPERTIES").spaces.active.context = tab.upper()
    else:
        region = next(region for region in area("VIEW_3D").regions if region.type == "UI")
        with contextlib.suppress(TypeError):  # is drawn for the first time
            region.active_panel_category = "Probes"
    yield from wait(1)
    _wanted = f"{'PROPERTIES' if tab else 'VIEW_3D'} {name or panel.__name__.removeprefix('PCC_PT_')}, {theme}"
    yield from wait(1)
    _wanted = ""
    bpy.utils.unregister_class(panel)


drive(prepare, steps, FOUND, FOLDER / "panels.json")
