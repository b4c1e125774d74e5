"""A baked and injected room in a file, to be saved, moved, linked, copied; and what must hold of it wherever it is."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from pcc_addon.blender import rendering
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.shade.probe_group import probe_of
from pcc_addon.blender.shade.twin import is_torn, shown_probe_groups
from pcc_addon.blender.status import ProbeStatus, statuses
from pcc_addon.blender.store.pictures import read_pixels
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, empty_scene, principled
from tests.blender.helpers import ROOM, bake, put_in, save, small_room
from tests.blender.materials import show


def build(blend: Path) -> None:
    """Save the small room with a polished floor and a table that is less so, baked and injected, and a camera."""
    empty_scene()
    probe = small_room()
    probe.pcc_probe.effects.levels = "AUTO"
    show(principled("Wood", Roughness=0.3), "Table").scale = (1.0, 1.0, 0.1)
    look()
    save(blend)
    bake(probe)
    put_in()
    save(blend)


def look() -> None:
    """A camera in the room."""
    add_camera(ROOM.world(-1.6, -1.2, 0.4), ROOM.world(1.0, 0.8, -1.0), 20.0, 24, 16)


def opened(blend: Path) -> Path:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    return blend


def seen(samples: int = 1) -> np.ndarray:
    """(16, 24, 3): what the scene's camera sees."""
    bpy.context.view_layer.update()
    settings = rendering.RenderSettings(Engine.CYCLES, samples, False, 24, 16)
    return rendering.render(bpy.context.scene, settings).pixels


def status(name: str = "Probe") -> ProbeStatus:
    return next(s for s in statuses(bpy.context.scene, bpy.context.view_layer) if s.probe == name)


def shown(material: str | bpy.types.Material = "Floor") -> list[str]:
    """Names of the probes that a material shows."""
    if isinstance(material, str):
        material = bpy.data.materials[material]
    return [probe_of(group).name_full for group in shown_probe_groups(material)]


def kept() -> dict[str, object]:
    """What a file has of ours, as plain values."""
    probe, wood = bpy.data.objects["Probe"].pcc_probe, bpy.data.materials["Wood"].pcc
    return {
        "shown": [shown(), shown("Wood")],
        "levels": [level.image.name for level in probe.levels],
        "record": probe.bake_record,
        "chosen": [wood.probe and wood.probe.name, bpy.data.materials["Floor"].pcc.effects.metal, probe.weight],
    }


def check() -> None:
    """Every probe of the scene is baked and fresh, with pictures that can be read; nothing that shows one is torn."""
    for found in statuses(bpy.context.scene, bpy.context.view_layer):
        assert (found.state, found.outdated) == ("baked", ()), found
    for probe in all_probes(bpy.context.scene):
        for level in probe.pcc_probe.levels:
            assert np.isfinite(read_pixels(level.image)).all()
    check_nothing_pink()


def check_nothing_pink() -> None:
    for material in bpy.data.materials:
        assert not is_torn(material), material.name
        for group in shown_probe_groups(material):
            read = [node.image for node in group.nodes if node.bl_idname == "ShaderNodeTexEnvironment"]
            assert read and all(image is not None and image.size[0] for image in read), group.name


def works_again() -> None:
    """Bakes and injections work, remove takes all of it out."""
    for found in all_probes(bpy.context.scene):
        found.pcc_probe.resolution = 24
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"}
    assert bpy.ops.pcc.inject() == {"FINISHED"}
    check()
    bpy.ops.pcc.remove()
    assert not [m.name for m in bpy.data.materials if m.node_tree and shown_probe_groups(m) and not m.library]
