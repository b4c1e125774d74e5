"""Runs inside a real Blender: shows the panels, keeps pictures of them, and tries what they are for.

`blender FILE --python drive_panels.py -- FOLDER` writes pictures and `panels.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import contextlib
import glob
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import gpu
import numpy as np

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the script beside this one is too
from driving import drive  # noqa: E402

LAST_PLAN = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.ui.last_plan"))
FOUND: dict[str, object] = {"pictures": {}}
_wanted = ""  # what the next drawn pictures are of


def prepare(window: bpy.types.Window) -> None:
    """Nothing but our panels, those of effects open, in a narrow column and where the 3D view was."""
    preferences = bpy.context.preferences
    preferences.use_preferences_save, preferences.view.show_splash = False, False
    for panel in bpy.types.Panel.__subclasses__():
        context = getattr(panel, "bl_context", "")
        ours = panel.__name__.startswith("PCC_")
        if ours and panel.bl_label == "Effects":
            bpy.utils.unregister_class(panel)
            panel.bl_options = set()
            bpy.utils.register_class(panel)
        elif not ours and context in {"data", "material"}:
            panel.poll = classmethod(lambda cls, context: False)
            if panel.__module__.startswith("bl_ui.") and panel.is_registered:  # others go with their add-on
                with contextlib.suppress(RuntimeError):  # went with its parent
                    bpy.utils.unregister_class(panel)
    areas = {area.type: area for area in window.screen.areas}
    with bpy.context.temp_override(window=window, area=areas["OUTLINER"], region=areas["OUTLINER"].regions[-1]):
        bpy.ops.screen.area_close()
    areas["VIEW_3D"].type = "PROPERTIES"
    bpy.types.SpaceProperties.draw_handler_add(keep_picture, (), "WINDOW", "POST_PIXEL")


def keep_picture() -> None:
    """Save what was drawn of a region."""
    if not _wanted:
        return
    x, y, width, height = gpu.state.viewport_get()
    pixels = gpu.state.active_framebuffer_get().read_color(x, y, width, height, 4, 0, "UBYTE")
    pixels.dimensions = width * height * 4
    drawn = np.array(pixels, np.uint8).reshape(height, width, 4)
    name = f"{_wanted} {'wide' if width > 500 else 'narrow'}"
    FOUND["pictures"][name] = len(np.unique(drawn[..., :3].reshape(-1, 3), axis=0))
    image = bpy.data.images.new(name, width, height)
    image.pixels.foreach_set((drawn.astype(np.float32) / 255.0).ravel())
    image.file_format, image.filepath_raw = "PNG", str(FOLDER / f"{name}.png")
    image.save()


def screen() -> bpy.types.Screen:
    return bpy.context.window_manager.windows[0].screen


def show(tab: str, name: str) -> Iterator[None]:
    """Make an object active, and show one of its tabs as soon as it has that."""
    bpy.context.view_layer.objects.active = bpy.data.objects[name]
    redraw()
    yield
    for area in screen().areas:
        if area.type == "PROPERTIES":
            area.spaces.active.context = tab
    yield
    for area in screen().areas:
        for region in area.regions:
            if area.type == "PROPERTIES" and region.type == "WINDOW":
                with bpy.context.temp_override(area=area, region=region):
                    bpy.ops.view2d.pan(deltax=0, deltay=-5000)  # to the end


def redraw() -> None:
    for area in screen().areas:
        area.tag_redraw()


def pictures(name: str) -> Iterator[None]:
    """Wait until something is drawn, then keep it."""
    global _wanted
    yield
    _wanted = name
    redraw()
    yield
    _wanted = ""


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    scene = bpy.context.scene
    probe = next(item.name for item in scene.objects if item.pcc_probe.is_probe)
    yield from show("DATA", probe)
    yield from pictures("probe, not planned")
    bpy.ops.pcc.plan()
    yield from pictures("probe")
    material = next(material for material in LAST_PLAN.of(scene).plan.materials if material.probes)
    receiver = material.objects[0][0]
    yield from show("MATERIAL", receiver)
    yield from pictures("material")
    bpy.ops.pcc.inject()
    yield
    FOUND["late after injection"] = LAST_PLAN.of(scene).late
    counted, planned = [], LAST_PLAN.plan_scene
    LAST_PLAN.plan_scene = lambda *where: counted.append(where) or planned(*where)
    for _ in range(3):
        yield from pictures("material, injected")
    FOUND["planned by drawing"] = len(counted)
    LAST_PLAN.plan_scene = planned
    yield from choose(probe)
    bpy.data.objects[receiver].location.x += 0.01
    yield
    FOUND["late after a move"] = LAST_PLAN.of(bpy.context.scene).late
    [light] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if light:
        bpy.ops.script.execute_preset(filepath=light, menu_idname="USERPREF_MT_interface_theme_presets")
        yield from pictures("probe, light")
        yield from show("MATERIAL", receiver)
        yield from pictures("material, light")


def choose(name: str) -> Iterator[None]:
    """Choose as a panel does, with an undo step, and undo it."""

    def group() -> bpy.types.Object:
        return bpy.data.objects[name]

    def forced() -> list[str]:
        plan = LAST_PLAN.of(bpy.context.scene).plan.probe(name)
        return [decision.effect.key for decision in plan.decisions if decision.forced]

    def lookups() -> list[str]:
        tree = group().pcc_probe.group
        return [node.node_tree.name for node in tree.nodes if node.bl_idname == "ShaderNodeGroup"]

    yield from show("DATA", name)
    bpy.ops.ed.undo_push(message="before")
    before = lookups()
    bpy.ops.wm.context_set_enum("EXEC_DEFAULT", True, data_path="object.pcc_probe.effects.weight", value="ON")
    FOUND["shown at once"] = lookups() != before
    yield
    FOUND["forced"] = forced()
    yield from pictures("probe, forced")
    bpy.ops.ed.undo()
    yield
    FOUND["undone"] = [group().pcc_probe.effects.weight, lookups() == before]


FOUND["started"] = True
drive(prepare, steps, FOUND, FOLDER / "panels.json")
