"""Runs inside a real Blender: shows the panels, keeps pictures of them, and tries what they are for.

`blender FILE --python drive_panels.py -- FOLDER` writes pictures and `panels.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import contextlib
import glob
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the script beside this one is too
from driving import colours_of, drawn_region, drive, keep_png  # noqa: E402


def module(name: str) -> ModuleType:
    """A module of the installed add-on."""
    return next(found for known, found in sys.modules.items() if known.endswith(f"pcc_addon.ui.{name}"))


LAST_PLAN, THUMBNAILS, REGISTERING = module("kept.last_plan"), module("kept.thumbnails"), module("registering")
FOUND: dict[str, object] = {"pictures": {}}
_wanted = ""  # what the next drawn pictures are of
_ALL, _PAGE = 9000, 600  # pixels to scroll


def prepare(window: bpy.types.Window) -> None:
    """Nothing but our panels, all of them open, in a narrow column and where the 3D view was."""
    preferences = bpy.context.preferences
    preferences.use_preferences_save, preferences.view.show_splash = False, False
    mine = [cls for cls in REGISTERING._classes() if issubclass(cls, bpy.types.Panel)]
    for panel in reversed(mine):
        bpy.utils.unregister_class(panel)
    for panel in mine:  # in their order
        panel.bl_options = getattr(panel, "bl_options", set()) - {"DEFAULT_CLOSED"}
        bpy.utils.register_class(panel)
    for panel in set(bpy.types.Panel.__subclasses__()) - set(mine):
        if getattr(panel, "bl_context", "") in {"data", "material", "scene"}:
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
    drawn = drawn_region()
    name = f"{_wanted} {'wide' if drawn.shape[1] > 500 else 'narrow'}"
    FOUND["pictures"][name] = colours_of(drawn)
    keep_png(drawn, FOLDER / f"{name}.png")


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
    scroll(-_ALL)


def scroll(pixels: int) -> None:
    """Scroll all that is shown, down where that is below 0."""
    for area in screen().areas:
        for region in area.regions:
            if area.type == "PROPERTIES" and region.type == "WINDOW":
                with bpy.context.temp_override(area=area, region=region):
                    bpy.ops.view2d.pan(deltax=0, deltay=pixels)


def pages(name: str) -> Iterator[None]:
    """Pictures of all that the tabs of an object or a scene show, a page each."""
    scroll(_ALL)
    for page in (1, 2, 3):
        yield from pictures(f"{name} {page}")
        scroll(-_PAGE)
    scroll(-_ALL)


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
    yield from pages("tab")
    bpy.data.objects[probe].pcc_probe.correction = "RELIEF"
    bpy.data.objects[probe].pcc_probe.falloff_per_face = True
    yield from pages("tab, more settings")
    bpy.data.objects[probe].pcc_probe.correction = "BOX"
    bpy.data.objects[probe].pcc_probe.falloff_per_face = False
    FOUND["pictures of the bake"] = len(THUMBNAILS._collection)
    yield from show("SCENE", probe)
    yield from pictures("scene")
    bpy.ops.pcc.plan()
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
    bpy.context.view_layer.update()
    FOUND["late after a move"] = LAST_PLAN.of(bpy.context.scene).late
    [light] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if light:
        bpy.ops.script.execute_preset(filepath=light, menu_idname="USERPREF_MT_interface_theme_presets")
        yield from pictures("probe, light")
        yield from show("DATA", probe)
        yield from pages("tab, light")
        yield from show("SCENE", probe)
        yield from pictures("scene, light")
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
