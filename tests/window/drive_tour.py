"""Runs inside a real Blender: the README's steps on a file with two rooms, done with mouse and keys alone.

`blender FILE --python drive_tour.py -- FOLDER` writes pictures and `tour.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import bpy
from mathutils import Vector

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the scripts beside this one are too
import pointing  # noqa: E402
from driving import drive  # noqa: E402

RUNNING = next(module for name, module in sys.modules.items() if name.endswith("pcc_addon.ui.kept.running_bake"))
_PATIENCE = 900.0  # seconds
_MOST_STEPS = 12  # of undo
STEPS: list[dict[str, object]] = []  # what a person did: name, clicks, keys, and how long the machine then took
FOUND: dict[str, object] = {"skipped": pointing.MISSING, "steps": STEPS}
FLOOR = "tour floor"  # of a scene: a place of another room's floor that the camera sees


def prepare(window: bpy.types.Window) -> None:
    """Nothing but quick bakes: what a person finds is a fresh Blender and the file."""
    bpy.context.preferences.use_preferences_save = False
    bpy.context.scene.pcc.preset = "PREVIEW"
    FOUND["shading"] = [pointing.view()[0].spaces.active.shading.type]


def step(name: str, clicks: int = 0, keys: int = 0) -> None:
    """Note what was done, and keep what is seen then."""
    STEPS.append({"name": name, "clicks": clicks, "keys": keys})
    pointing.keep_screen(FOLDER / f"{len(STEPS)} {name}.png")


def probes() -> list[bpy.types.Object]:
    return sorted((o for o in bpy.context.scene.objects if o.pcc_probe.is_probe), key=lambda o: o.session_uid)


def state() -> dict[str, object]:
    """What there is: boxes, which of them are baked, and how many materials show one."""
    return {
        "boxes": [[*probe.location, *probe.scale, probe.rotation_euler.z] for probe in probes()],
        "baked": sum(bool(probe.pcc_probe.bake_record) for probe in probes()),
        "showing": sum(_shows(material) for material in bpy.data.materials),
    }


def _shows(material: bpy.types.Material) -> bool:
    nodes = material.node_tree.nodes if material.node_tree else ()
    return sum(node.type == "OUTPUT_MATERIAL" for node in nodes) > 1


def drawn() -> Iterator[float]:
    """Until what was asked for has surely been drawn; here without a graphics card."""
    yield 1.0
    yield 1.0


def steps() -> Iterator[float]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    if pointing.MISSING:
        return
    yield from drawn()
    area, region = pointing.view()
    height = bpy.context.window_manager.windows[0].height
    pointing.move(region.x + region.width // 3, height - region.y - region.height // 3)
    yield from drawn()
    pointing.shortcut("KP_0")
    yield from drawn()
    FOUND["empty"] = state()
    step("look through the camera", keys=1)
    pointing.shortcut("n")
    yield from drawn()
    yield from pointing.open_tab("Probes")
    yield from drawn()
    step("open the tab Probes", clicks=1, keys=1)
    yield from pointing.click((yield from pointing.button("pcc.probe_add")))
    yield from drawn()
    step("Add Parallax Probe", clicks=1)
    if FLOOR in bpy.context.scene:
        yield from pointing.click(pointing.pixel(Vector(bpy.context.scene[FLOOR])), 3, "shift")
        yield from drawn()
        yield from pointing.click((yield from pointing.button("pcc.probe_add", of_width=0.83)))
        yield from drawn()
        step("cursor into the other room, and plus", clicks=2)
    FOUND["added"] = state()
    yield from pointing.click((yield from pointing.button("show=True")))
    begun = time.monotonic()
    yield from drawn()
    step("Bake and Show", clicks=1)
    while RUNNING.running() is not None:
        assert time.monotonic() - begun < _PATIENCE, RUNNING.words()
        yield 0.5
    FOUND["bake seconds"] = time.monotonic() - begun
    FOUND["outcome"] = [RUNNING.outcome().done, *RUNNING.outcome().errors]
    yield from drawn()
    for _ in range(10):
        yield 1.0
    FOUND["shown"] = state()
    FOUND["shading"].append(area.spaces.active.shading.type)
    step("it shows")
    yield from undoes()


def undoes() -> Iterator[float]:
    """Back to the file as it was opened, by keys, and forth again."""
    FOUND["undone"], FOUND["redone"] = [], []
    area, region = pointing.view()
    area.spaces.active.shading.type = "SOLID"  # which takes no time to draw
    pointing.move(region.x + region.width // 3, bpy.context.window_manager.windows[0].height - region.y - 60)
    yield from drawn()
    ends = (("ctrl+z", FOUND["undone"], FOUND["empty"]), ("ctrl+shift+z", FOUND["redone"], FOUND["shown"]))
    for key, into, end in ends:
        while state() != end and len(into) < _MOST_STEPS:
            pointing.shortcut(key)
            yield from drawn()
            into.append(state())


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "tour.json")
