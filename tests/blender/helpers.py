"""Small scenes that the tests of this folder share: quick to render, with one thing to see."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

from pcc_addon.blender.bake.job import BakedProbe, BakeJob
from pcc_addon.blender.probes import add_probe, ensure_uid
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.shade.injection import InjectionReport, inject
from pcc_addon.blender.shade.probe_group import refresh_group
from pcc_addon.blender.shade.twin import shown_probe_groups
from pcc_addon.blender.store.levels import bake_folder, store
from pcc_addon.core.sidecar import Sidecar
from sample_blends.scenes import Room, add_wall, principled, principled_node

ROOM = Room((2.0, 1.5, 1.0), (3.0, -2.0, 1.0), 0.0)


def small_probe(
    name: str = "Probe",
    location: Sequence[float] = ROOM.centre,
    half_extents: Sequence[float] = ROOM.half_extents,
    rotation: Sequence[float] = (0.0, 0.0, 0.0),
    capture_offset: Sequence[float] = (0.0, 0.0, 0.0),
) -> bpy.types.Object:
    """A probe whose bake takes a moment: 16 pixels, 1 sample, no denoising; with all levels, so with many files."""
    collection = bpy.context.scene.collection
    probe = add_probe(collection, name, location, rotation, half_extents, capture_offset)
    settings = probe.pcc_probe
    settings.resolution, settings.samples, settings.denoise = 16, 1, False
    settings.effects.levels = "ON"
    bpy.context.view_layer.update()
    return probe


def glow(name: str, color: Sequence[float]) -> bpy.types.Material:
    """A material that only emits."""
    return principled(
        name, Base_Color=(0, 0, 0, 1), Specular_IOR_Level=0.0, Emission_Color=(*color, 1), Emission_Strength=1.0
    )


def small_room() -> bpy.types.Object:
    """A room with a polished floor and glowing walls, and its probe; returns the probe."""
    for side, color in zip(("+X", "-X", "+Y", "-Y", "+Z"), np.eye(3).tolist() * 2, strict=False):
        add_wall(ROOM, side, glow(f"Glow {side}", color))
    add_wall(ROOM, "-Z", principled("Floor", Roughness=0.0))
    return small_probe()


def paint_wall() -> None:
    """Change what the small room's probe sees."""
    principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Color"].default_value = (0.5, 0.5, 0.5, 1.0)


def bake(*probes: bpy.types.Object) -> list[BakedProbe]:
    """Bake at once, to where the scene's bakes go."""
    scene = bpy.context.scene
    return BakeJob(scene, bpy.context.view_layer, probes, bake_folder(scene)).run()


def put_in() -> InjectionReport:
    """Let every material show the baked probes."""
    return inject(bpy.context.scene, bpy.context.view_layer)


def shown_group(material: bpy.types.Material) -> bpy.types.ShaderNodeTree | None:
    """The probe group that a material shows; one that shows several is no case for this."""
    groups = shown_probe_groups(material)
    assert len(groups) < 2
    return groups[0] if groups else None


def pretend_bake(probe: bpy.types.Object) -> None:
    """Give a probe the pictures and the record of a bake without rendering."""
    spec = probe_spec(probe)
    record = Sidecar.of_bake(spec, ensure_uid(probe), seconds=0.0, content_hash="", blender="", addon="")
    store(probe, record, {0.0: np.full((32, 64, 3), 0.5, np.float32)}, None)
    refresh_group(probe)


def picture(probe: bpy.types.Object, roughness: float = 0.0) -> np.ndarray:
    """(h, 2h, 3): a level of a probe's bake."""
    from pcc_addon.blender.store.pictures import read_pixels

    level = next(level for level in probe.pcc_probe.levels if abs(level.roughness - roughness) < 1e-4)
    return read_pixels(level.image)


def pictures_of(probe: bpy.types.Object) -> list[Path]:
    """The files of a probe's pictures."""
    return [Path(bpy.path.abspath(level.image.filepath)).resolve() for level in probe.pcc_probe.levels]


def save(path: Path) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, by relative path."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}
