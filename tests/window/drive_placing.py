"""Runs inside a real Blender: adds a probe by the menu, changes it in the panel, drags its handles, and undoes that.

`blender FILE --python drive_placing.py -- FOLDER` writes pictures and `placing.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import glob
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

PACKAGE = next(name for name in sys.modules if name.endswith("pcc_addon"))
SPEC = sys.modules[f"{PACKAGE}.blender.read.probes"].probe_spec
HANDLES = sys.modules[f"{PACKAGE}.ui.viewport.handles"]
PROBES = sys.modules[f"{PACKAGE}.ui.viewport.probes"]
WALL = sys.modules[f"{PACKAGE}.core.dragging"].Wall
FOUND: dict[str, object] = {"skipped": pointing.MISSING}


def prepare(window: bpy.types.Window) -> None:
    """The room without its probe and its ceiling, seen from above; the cursor is on its floor."""
    bpy.context.preferences.use_preferences_save = False
    scene = bpy.context.scene
    old = next(item for item in scene.objects if item.pcc_probe.is_probe)
    FOUND["true"] = {"centre": list(old.location), "half": list(old.scale), "turn": old.rotation_euler.z}
    scene.cursor.location = old.location - Vector((0.3, 0.2, old.scale.z))
    area, _ = pointing.view()
    region = area.spaces.active.region_3d
    region.view_perspective, region.view_location = "PERSP", old.location
    region.view_distance = 5.0 * max(old.scale)
    region.view_rotation = Euler((math.radians(40.0), 0.0, math.radians(20.0))).to_quaternion()
    area.spaces.active.shading.type = "SOLID"
    for item in scene.objects:
        item.select_set(False)
    bpy.data.objects.remove(old)
    bpy.data.objects["Wall +Z"].hide_set(True)
    bpy.ops.ed.undo_push(message="Prepared")


def keep_picture(name: str) -> None:
    pointing.keep_screen(FOLDER / f"{name}.png")


def probe() -> bpy.types.Object | None:
    return next((item for item in bpy.context.scene.objects if item.pcc_probe.is_probe), None)


def state() -> dict[str, object]:
    """What may be dragged of the probe."""
    spec = SPEC(probe())
    return {
        "centre": spec.box.centre.tolist(),
        "half": spec.box.half_extents.tolist(),
        "turn": math.atan2(spec.box.axes[1, 0], spec.box.axes[0, 0]),
        "capture": spec.capture_point.tolist(),
        "offset": list(spec.capture_offset),
        "low": list(spec.influence.low),
        "high": list(spec.influence.high),
    }


def handle(wall: object) -> tuple[Vector, Vector]:
    """Where the arrow of a wall begins, and its way."""
    spec = SPEC(probe())
    return Vector(HANDLES._place(spec, wall)), Vector(HANDLES.way_of(spec, wall))


def drag_wall(name: str, wall: object, key: str = "", *, cancel: bool = False) -> Iterator[None]:
    place, way = handle(wall)
    begin = pointing.pixel(place + 0.3 * way)
    yield from pointing.drag(begin, pointing.pixel(place + 1.6 * way), key, cancel=cancel)
    FOUND[name] = state()


def add() -> Iterator[None]:
    """By the menu, as a person does."""
    _, region = pointing.view()
    window = bpy.context.window_manager.windows[0]
    pointing.move(region.x + region.width // 3, window.height - region.y - region.height // 4)
    yield
    pointing.xdotool("key", "shift+a")
    yield
    yield
    pointing.xdotool("type", "parallax")
    yield
    yield
    pointing.xdotool("key", "Return")
    yield
    yield


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    if pointing.MISSING:
        return
    yield
    yield from add()
    FOUND["added"] = state()
    keep_picture("added, dark")
    pointing.xdotool("key", "F9")
    yield
    yield
    yield
    keep_picture("panel, dark")
    operator = bpy.context.window_manager.operators[-1]
    FOUND["panel"] = [operator.bl_idname, list(operator.properties.half_extents), operator.properties.around]
    pointing.xdotool("key", "Escape")
    yield
    yield
    yield from drag_wall("box", WALL(0, True))
    yield from drag_wall("cancelled", WALL(0, True), cancel=True)
    yield from drag_wall("precise", WALL(0, True), "shift")
    yield from drag_wall("snapped", WALL(1, False), "ctrl")
    yield from drag_wall("influence", WALL(0, False, influence=True))
    point = pointing.pixel(Vector(SPEC(probe()).capture_point))
    yield from pointing.drag(point, (point[0] + 60, point[1] - 30))
    FOUND["point"] = state()
    keep_picture("dragged, dark")
    FOUND["undone"] = []
    for _ in range(6):
        bpy.ops.ed.undo()
        bpy.context.view_layer.update()
        FOUND["undone"].append(state() if probe() else None)
    bpy.ops.ed.redo()
    yield
    yield from looks()


def looks() -> Iterator[None]:
    """Pictures of the lines on other backgrounds; nothing is drawn where overlays are off."""
    probe().select_set(True)
    bpy.context.view_layer.objects.active = probe()
    area, _ = pointing.view()
    space = area.spaces.active
    yield
    FOUND["drawn"] = len(PROBES._drawn)
    space.shading.type = "MATERIAL"
    yield
    yield
    keep_picture("material, dark")
    [light] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if light:
        bpy.ops.script.execute_preset(filepath=light, menu_idname="USERPREF_MT_interface_theme_presets")
    space.shading.type = "SOLID"
    yield
    yield
    keep_picture("solid, light")
    space.overlay.show_overlays = False
    yield
    yield
    FOUND["drawn without overlays"] = len(PROBES._drawn)


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "placing.json")
