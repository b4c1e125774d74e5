"""Runs inside a real Blender: two rooms with a probe each, from above.

`blender FILE --python several.py -- FOLDER` writes pictures into the folder, and ends Blender.
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

FOUND: dict[str, object] = {"crops": {}}
PROBES = ("Lounge", "Study")


def wait(rounds: int = 3) -> Iterator[None]:
    for _ in range(rounds):
        pointing.view()[0].tag_redraw()
        yield


def keep(name: str, crop: tuple[int, int, int, int]) -> None:
    pointing.keep_screen(FOLDER / f"{name}.png")
    FOUND["crops"][name] = crop


def prepare(window: bpy.types.Window) -> None:
    """From above, without ceilings; both probes are selected."""
    bpy.context.preferences.use_preferences_save = False
    for item in bpy.context.scene.objects:
        item.select_set(item.name in PROBES)
    for name in PROBES:
        bpy.data.objects[f"{name} +Z"].hide_set(True)
    bpy.context.view_layer.objects.active = bpy.data.objects["Lounge"]
    area, _ = pointing.view()
    region = area.spaces.active.region_3d
    middle = sum((bpy.data.objects[name].location for name in PROBES), Vector()) / len(PROBES)
    region.view_perspective, region.view_location, region.view_distance = "PERSP", middle, 17.0
    region.view_rotation = Euler((math.radians(40.0), 0.0, math.radians(40.0))).to_quaternion()
    area.spaces.active.shading.type = "SOLID"


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield from wait()
    area, _ = pointing.view()
    keep("several_boxes", pointing.edges(area))


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "several.json")
