"""Runs inside a real Blender: shows a baked room in each way to judge it by, renders and saves meanwhile.

`blender FILE --python drive_judging.py -- FOLDER` writes pictures and `judging.json` into the folder, and ends Blender.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
from mathutils import Euler

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))  # where the scripts beside this one are too
import pointing  # noqa: E402
from driving import drive  # noqa: E402

PACKAGE = next(name for name in sys.modules if name.endswith("pcc_addon"))
JUDGING = sys.modules[f"{PACKAGE}.blender.judging"]
GROUPS = sys.modules[f"{PACKAGE}.blender.shade.groups"]
FOUND: dict[str, object] = {"rendered": {}, "after": {}, "shown": {}}
_rendered: list[bool] = []


def corrected() -> bool:
    """Whether the open file is as files and renders are to be."""
    muted = any(node.mute for node in GROUPS.parallax_nodes())
    floor = next(m for m in bpy.data.materials if m.node_tree and len(_outputs(m)) > 1)
    return not muted and not next(n for n in _outputs(floor) if n.name == "Material Output").is_active_output


def _outputs(material: bpy.types.Material) -> list[bpy.types.Node]:
    return [node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"]


def prepare(window: bpy.types.Window) -> None:
    """A look into the room in rendered view, with the sidebar's tab open."""
    bpy.context.preferences.use_preferences_save = False
    scene = bpy.context.scene
    probe = next(item for item in scene.objects if item.pcc_probe.is_probe)
    bpy.ops.pcc.inject()
    area, _ = pointing.view()
    space = area.spaces.active
    space.region_3d.view_perspective, space.region_3d.view_location = "PERSP", probe.location
    space.region_3d.view_distance = 2.0
    space.region_3d.view_rotation = Euler((math.radians(70.0), 0.0, math.radians(40.0))).to_quaternion()
    space.show_region_ui = True
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.location = camera, probe.location
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.render.engine, scene.cycles.samples, scene.cycles.preview_samples = "CYCLES", 1, 1
    bpy.app.handlers.render_pre.append(lambda *_: _rendered.append(corrected()))


def steps() -> Iterator[None]:
    """What is done; Blender draws and runs its timers at each `yield`."""
    yield
    area, _ = pointing.view()
    next(region for region in area.regions if region.type == "UI").active_panel_category = "Probes"
    area.spaces.active.shading.type = "RENDERED"
    for view in ("UNCORRECTED", "OFF"):
        bpy.ops.pcc.judge("INVOKE_DEFAULT", view=view)
        for _ in range(6):
            yield
        pointing.keep_screen(FOLDER / f"{view.lower()}.png")
        FOUND["shown"][view] = not corrected()
        for _ in range(3):
            _rendered.clear()
            bpy.ops.render.render("INVOKE_DEFAULT")
            for _ in range(40):
                yield
                if _rendered and not bpy.app.is_job_running("RENDER"):
                    break
            yield
            FOUND["rendered"].setdefault(view, []).append(list(_rendered))
        FOUND["after"][view] = not corrected()
    bpy.ops.pcc.judge("INVOKE_DEFAULT", view="MISFIT")
    for _ in range(60):
        yield
        if bpy.context.window_manager.pcc_show_misfit and not JUDGING._held:
            break
    yield
    pointing.keep_screen(FOLDER / "misfit.png")
    FOUND["misfit"] = corrected()
    bpy.ops.pcc.judge("INVOKE_DEFAULT", view="CORRECTED")
    for _ in range(6):
        yield
    pointing.keep_screen(FOLDER / "corrected.png")
    area.spaces.active.shading.type = "SOLID"
    FOUND["corrected"] = corrected()


bpy.context.preferences.view.show_splash = False
drive(prepare, steps, FOUND, FOLDER / "judging.json")
