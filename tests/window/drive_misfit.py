"""Runs inside a real Blender: shows a misfit in the viewport and in its panel, and keeps pictures of both.

`blender FILE --python drive_misfit.py -- FOLDER` writes pictures and `misfit.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
from mathutils import Euler, Vector

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the script beside this one is too
from driving import drawn_region, drive, keep_png  # noqa: E402

UI = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.ui.panels.fit"))
VIEW = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.ui.viewport.misfit"))
FOUND: dict[str, object] = {"pictures": {}}
_wanted = ""  # what the next drawn pictures are of


def keep_picture(area: str) -> None:
    """Save what was drawn of a region."""
    if not _wanted:
        return
    drawn = drawn_region()
    name = f"{_wanted}, {area}"
    colours = drawn[..., :3].astype(int)
    magenta = (colours[..., 0] > 180) & (colours[..., 1] < 60) & (colours[..., 2] < 140)
    red = (colours[..., 0] > colours[..., 2] + 60) & ~magenta
    FOUND["pictures"][name] = {"magenta": int(magenta.sum()), "red": int(red.sum())}
    keep_png(drawn, FOLDER / f"{name}.png")


def prepare(window: bpy.types.Window) -> None:
    """A thing in the room, its panel open beside a view into it from above."""
    bpy.context.preferences.use_preferences_save = False
    bpy.utils.unregister_class(UI.PCC_PT_fit)
    UI.PCC_PT_fit.bl_options = set()
    bpy.utils.register_class(UI.PCC_PT_fit)
    probe = next(item for item in bpy.context.scene.objects if item.pcc_probe.is_probe)
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=probe.location + Vector((0.5, 0.0, -0.9)))
    bpy.data.objects["Wall +Z"].hide_set(True)
    for item in bpy.context.scene.objects:
        item.select_set(item == probe)
    bpy.context.view_layer.objects.active = probe
    view = next(area for area in window.screen.areas if area.type == "VIEW_3D").spaces.active
    view.region_3d.view_perspective, view.region_3d.view_location = "PERSP", probe.location
    view.region_3d.view_distance = 5.0 * max(probe.scale)
    view.region_3d.view_rotation = Euler((math.radians(30.0), 0.0, math.radians(40.0))).to_quaternion()
    view.overlay.show_overlays, view.show_gizmo = False, False
    for kind, area in ((bpy.types.SpaceView3D, "view"), (bpy.types.SpaceProperties, "panel")):
        kind.draw_handler_add(keep_picture, (area,), "WINDOW", "POST_PIXEL")


def pictures(name: str) -> Iterator[None]:
    """Wait until something is drawn, then keep it."""
    global _wanted
    yield
    _wanted = name
    for area in bpy.context.window_manager.windows[0].screen.areas:
        area.tag_redraw()
    yield
    _wanted = ""


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "PROPERTIES":
            area.spaces.active.context = "DATA"
    yield from pictures("before")
    bpy.ops.pcc.misfit()
    yield
    for area in bpy.context.window_manager.windows[0].screen.areas:
        for region in area.regions:
            if area.type == "PROPERTIES" and region.type == "WINDOW":
                with bpy.context.temp_override(area=area, region=region):
                    bpy.ops.view2d.pan(deltax=0, deltay=-5000)  # to the end
    yield from pictures("found")
    bpy.context.window_manager.pcc_show_misfit = True
    yield from pictures("shown")
    made = dict(VIEW._drawn)
    yield from pictures("shown again")
    FOUND["made once"] = len(made) == 1 and all(VIEW._drawn[name] is drawn for name, drawn in made.items())
    theme = bpy.context.preferences.themes[0].view_3d.space.gradients
    theme.high_gradient = theme.gradient = (0.9, 0.9, 0.9)
    yield from pictures("light")
    bpy.context.window_manager.pcc_show_misfit = False
    yield from pictures("off")
    FOUND["forgotten"] = not VIEW._drawn


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "misfit.json")
