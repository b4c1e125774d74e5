"""Runs inside a real Blender: bakes in the background while the file is worked on with keys, and keeps pictures of it.

`blender FILE --enable-event-simulate --python drive_background.py -- FOLDER` writes pictures and `background.json` into
the folder, and ends Blender.
"""

from __future__ import annotations

import glob
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the script beside this one is too
from driving import drawn_region, drive, keep_png  # noqa: E402

RUNNING = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.ui.kept.running_bake"))
STATUS = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.blender.status"))
FOUND: dict[str, object] = {}
_PATIENCE = 120.0  # seconds
_wanted = ""  # what the next drawn pictures are of


def window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def area(kind: str) -> bpy.types.Area:
    return next(area for area in window().screen.areas if area.type == kind)


def prepare(_: bpy.types.Window) -> None:
    """A thing in the room, and panels that show bakes."""
    preferences = bpy.context.preferences
    preferences.use_preferences_save, preferences.view.show_splash = False, False
    probe = next(item for item in bpy.context.scene.objects if item.pcc_probe.is_probe)
    probe.pcc_probe.resolution, probe.pcc_probe.samples = 64, 4
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=probe.location)
    bpy.context.object.name = "Box"
    area("VIEW_3D").spaces.active.show_region_ui = True
    for kind, region in ((bpy.types.SpaceView3D, "UI"), (bpy.types.SpaceProperties, "WINDOW")):
        kind.draw_handler_add(keep_picture, (f"{kind.__name__[5:]}",), region, "POST_PIXEL")
    bpy.ops.wm.save_mainfile()
    bpy.ops.ed.undo_push(message="begun")


def key(kind: str, aside: int = 0, **held: bool) -> None:
    """Press and release a key over the 3D view, so many pixels aside from its middle."""
    view = area("VIEW_3D")
    at = {"x": view.x + view.width // 2 + aside, "y": view.y + view.height // 2}
    window().event_simulate(type="MOUSEMOVE", value="NOTHING", **at)
    for value in ("PRESS", "RELEASE"):
        window().event_simulate(type=kind, value=value, **at, **held)


def keep_picture(of: str) -> None:
    """Save what was drawn of a region."""
    if not _wanted:
        return
    keep_png(drawn_region(), FOLDER / f"{_wanted}, {of}.png")


def picture(name: str) -> Iterator[None]:
    """Wait until panels are drawn, then keep pictures of them."""
    global _wanted
    yield
    _wanted = name
    for each in window().screen.areas:
        each.tag_redraw()
    yield
    _wanted = ""


def select(name: str) -> None:
    for item in bpy.context.scene.objects:
        item.select_set(item.name == name)
    bpy.context.view_layer.objects.active = bpy.data.objects[name]


def probe() -> bpy.types.Object:
    return next(item for item in bpy.context.scene.objects if item.pcc_probe.is_probe)


def begin() -> None:
    assert RUNNING.running() is None
    bpy.ops.pcc.bake("INVOKE_DEFAULT", scope="ALL")
    assert RUNNING.running() is not None


def until(what: Callable[[], bool]) -> Iterator[None]:
    end = time.monotonic() + _PATIENCE
    while not what():
        assert time.monotonic() < end, RUNNING.running() and RUNNING.words()
        yield


def finish() -> Iterator[None]:
    yield from until(lambda: RUNNING.running() is None)
    yield


def state() -> list[str]:
    found = STATUS.statuses(bpy.context.scene, bpy.context.view_layer)
    return [f"{each.probe}: {each.state}" for each in found]


def pictures() -> list[str]:
    return [Path(bpy.path.abspath(level.image.filepath)).name for level in probe().pcc_probe.levels]


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    for region in area("VIEW_3D").regions:
        if region.type == "UI":
            region.active_panel_category = "Probes"
    select(probe().name)
    yield
    area("PROPERTIES").spaces.active.context = "DATA"
    yield from picture("before")
    yield from moves_while_it_bakes()
    yield from undoes()
    yield from cancels()
    yield from renames_and_deletes()
    yield from opens_another()
    [light] = glob.glob(f"{bpy.utils.resource_path('SYSTEM')}/**/Blender_Light.xml", recursive=True) or [""]
    if light:
        bpy.ops.script.execute_preset(filepath=light, menu_idname="USERPREF_MT_interface_theme_presets")
        begin()
        yield from until(lambda: RUNNING.running().progress > 0.0)
        yield from picture("light, running")
        yield from finish()
        yield from picture("light, done")
    begin()
    yield from until(lambda: RUNNING.running().progress > 0.0)  # Blender is closed now


def moves_while_it_bakes() -> Iterator[None]:
    """Move a thing with G, for longer than the bake takes: the bake waits and is stale then."""
    select("Box")
    yield
    before = bpy.data.objects["Box"].location.copy()
    begin()
    FOUND["changed by starting"] = state()
    key("G")
    yield
    FOUND["tool"] = [tool.bl_idname for tool in window().modal_operators]
    yield from until(lambda: RUNNING.running().progress > 0.0)
    yield from picture("running")
    yield from until(lambda: bool(RUNNING.running().waiting) and "waits" in RUNNING.words())
    FOUND["waits"] = RUNNING.words()
    yield from picture("waiting")
    FOUND["while it waits"] = state()
    key("RET", aside=100)
    yield from finish()
    FOUND["moved by"] = (bpy.data.objects["Box"].location - before).length
    FOUND["after a move"] = state()
    yield from picture("done")
    begin()
    key("G")
    yield
    key("ESC")
    yield
    FOUND["esc"] = [len(window().modal_operators), RUNNING.running() is not None]
    yield from finish()
    FOUND["baked again"] = state()


def undoes() -> Iterator[None]:
    """Ten times back and forth over the last bake, with keys."""
    after, seen = pictures(), []
    for _ in range(10):
        key("Z", ctrl=True)
        yield
        before = pictures()
        there = all((Path(bpy.data.filepath).with_suffix(".pcc") / name).is_file() for name in before)
        key("Z", ctrl=True, shift=True)
        yield
        seen.append([before != after, there, pictures() == after])
    FOUND["undone and redone"] = seen
    FOUND["after undo"] = state()


def cancels() -> Iterator[None]:
    kept = sorted(path.name for path in Path(bpy.data.filepath).with_suffix(".pcc").iterdir())
    begin()
    yield
    bpy.ops.pcc.bake_cancel()
    yield from picture("cancelled")
    left = sorted(path.name for path in Path(bpy.data.filepath).with_suffix(".pcc").iterdir())
    copies = [path.name for path in FOLDER.iterdir() if "unfinished" in path.name]
    FOUND["cancelled"] = [RUNNING.running() is None, left == kept, copies, state()]


def renames_and_deletes() -> Iterator[None]:
    begin()
    probe().name = "Hall"
    bpy.ops.wm.save_mainfile()
    yield from finish()
    FOUND["renamed"] = [state(), sorted({level.image.name.partition(" 0.")[0] for level in probe().pcc_probe.levels})]
    bpy.ops.ed.undo_push(message="renamed")
    begin()
    select("Hall")
    key("DEL")
    yield
    FOUND["left"] = [item.name for item in bpy.context.scene.objects if item.pcc_probe.is_probe]
    yield from finish()
    FOUND["deleted"] = RUNNING.outcome().errors
    key("Z", ctrl=True)
    yield
    FOUND["brought back"] = state()


def opens_another() -> Iterator[None]:
    """What is baked for a file that is left is dropped, and what it had stays."""
    bpy.ops.wm.save_mainfile()
    begin()
    yield
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    yield
    FOUND["opened"] = [RUNNING.running() is None, RUNNING.outcome() is None, state()]
    FOUND["left behind"] = [path.name for path in FOLDER.rglob("*") if "unfinished" in path.name]


drive(prepare, steps, FOUND, FOLDER / "background.json")
