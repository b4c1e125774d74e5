"""Runs inside a real Blender: the nodes of a toon shader that reads a probe.

`blender FILE --python by_hand.py -- FOLDER` writes pictures into the folder, and ends Blender.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the scripts beside this one are too
import pointing  # noqa: E402
from driving import drive  # noqa: E402

FOUND: dict[str, object] = {"crops": {}}
MATERIAL = "Toon"


def prepare(window: bpy.types.Window) -> None:
    """The Shader Editor in place of the 3D view, with that material."""
    bpy.context.preferences.use_preferences_save = False
    wearer = next(
        item for item in bpy.context.scene.objects if item.active_material and MATERIAL in item.active_material.name
    )
    bpy.context.view_layer.objects.active = wearer
    area, _ = pointing.view()
    area.ui_type = "ShaderNodeTree"
    area.spaces.active.show_region_ui = area.spaces.active.show_region_toolbar = False


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    yield
    area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "NODE_EDITOR")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(area=area, region=region):
        bpy.ops.node.select_all(action="DESELECT")
        bpy.ops.node.view_all()
    pointing.move(*pointing.edges(area)[:2])
    for _ in range(4):
        area.tag_redraw()
        yield
    pointing.keep_screen(FOLDER / "by_hand_nodes.png")
    FOUND["crops"]["by_hand_nodes"] = pointing.edges(area)


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "by_hand.json")
