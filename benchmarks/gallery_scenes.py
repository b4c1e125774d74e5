"""Scenes of the gallery, and what makes each do without the system that it shows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from unittest.mock import patch

import bpy
from mathutils import Matrix

from benchmarks import anisotropy, doorway, engines, interior, moving
from pcc_addon.blender.compat import engine_id
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.shade.interior import interior_node
from pcc_addon.core.effects import metal
from pcc_addon.core.effects.surface import surface_formula
from pcc_addon.core.probe import Engine
from sample_blends import any_cubemap, by_hand
from sample_blends.scenes import (
    EMISSIVE_ROOM,
    Room,
    add_camera,
    add_room_probe,
    emissive_room,
    principled_node,
)
from sample_blends.two_rooms import LOUNGE, of_metal, two_rooms

FACE, LIT_FACE, SAMPLES = 256, 128, 16  # of captures; the second of rooms with lamps, whose pictures are softer
_FILES = TemporaryDirectory()  # until the interpreter ends; Blender's own goes with the file that is open


def probes() -> list[bpy.types.Object]:
    return [item for item in bpy.data.objects if item.pcc_probe.is_probe]


def uncorrected() -> None:
    for probe in probes():
        probe.pcc_probe.correction = "NONE"


def mirror_floor(room: Room = EMISSIVE_ROOM, offset: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
    emissive_room(room)
    add_room_probe(room, offset)


def sky() -> None:
    any_cubemap.chequered_sky(any_cubemap.mirror_ball())
    bpy.data.objects["Room"].pcc_probe.source = "WORLD"
    uncorrected()


def corrected() -> None:
    bpy.data.objects["Room"].pcc_probe.correction = "BOX"


def doorway_lounge() -> None:
    """The lounge's probe alone on a polished floor that runs on into the study."""
    doorway.build(LIT_FACE)
    bpy.data.objects.remove(bpy.data.objects["Study"])
    bpy.data.objects["Lounge"].pcc_probe.outside = "OWN"


def everywhere() -> None:
    bpy.data.objects["Lounge"].pcc_probe.outside = "UNCORRECTED"


def box_askew() -> None:
    """The box's bottom is up to 8 mm above one half of the floor, and as far below the other."""
    mirror_floor()
    probe = bpy.data.objects["Room"]
    tilt = Matrix.Rotation(math.atan(0.008 / EMISSIVE_ROOM.half_extents[0]), 4, "Y")
    probe.matrix_world = EMISSIVE_ROOM.matrix @ tilt @ Matrix.Diagonal((*EMISSIVE_ROOM.half_extents, 1.0))
    probe.pcc_probe.falloff, probe.pcc_probe.outside = 0.0, "UNCORRECTED"


def unpadded() -> None:
    bpy.data.objects["Room"].pcc_probe.padding = 0.0


def captured_in_the_centre() -> None:
    """Let the record say what is wrong: that the pictures were taken in the middle of the box."""
    probe = bpy.data.objects["Room"]
    record = bake_record(probe)
    probe.pcc_probe.bake_record = replace(record, capture_point=tuple(probe.matrix_world.translation)).to_json()


def lamps_lost() -> None:
    lamps = [item for item in bpy.data.objects if item.type == "LIGHT"]
    for lamp in lamps:
        lamp.visible_glossy = False
    bpy.ops.pcc.bake(scope="ALL")
    for lamp in lamps:
        lamp.visible_glossy = True


def mirrored_steel() -> None:
    """A near look into the mirror; without the table, which is off the walls and would be seen lying on the floor."""
    scene = of_metal()
    for item in list(scene.objects):
        if item.name.startswith(("Lounge Table", "Lounge Leg", "Lounge Pot")):
            bpy.data.objects.remove(item)
    bpy.data.objects.remove(scene.camera)
    add_camera(LOUNGE.world(0.6, -0.2, 0.35), LOUNGE.world(2.48, 0.4, 0.05), 30.0, 240, 150)


def metals_black() -> None:
    bpy.ops.pcc.remove()
    surface_formula.cache_clear()
    with patch.object(metal, "MATT", 0.0):
        bpy.ops.pcc.bake(scope="ALL")
    surface_formula.cache_clear()


def painted_walls(matrix: Matrix | None = None) -> None:
    """A mirror ball in a room of marked walls."""
    any_cubemap.mirror_ball()
    any_cubemap.paint_walls(matrix or bpy.data.objects["Room"].matrix_world, 64)
    bpy.data.objects["Room"].pcc_probe.hidden_objects.add().object = bpy.data.objects["Ball"]


def picture_from_elsewhere() -> None:
    """The walls are for the path tracer alone: the probe has a file."""
    painted_walls()
    settings = bpy.data.objects["Room"].pcc_probe
    settings.source = "IMAGE"
    settings.picture = str(Path(mkdtemp(dir=_FILES.name), "cross.png"))
    any_cubemap.write_cross(Path(settings.picture), 64)


def lounge_alone() -> None:
    doorway.show(("Lounge",))


def without_mirrors(roughness: float | None = None) -> None:
    """The two rooms; no probe shows what a mirror shows."""
    two_rooms(roughness)
    for name in ("Lounge Mirror", "Study Mirror"):
        bpy.data.objects.remove(bpy.data.objects[name])


def rough_floor() -> None:
    without_mirrors(0.22)
    principled_node(bpy.data.materials["Tiles"]).inputs["IOR"].default_value = 2.5


def sharp_picture() -> None:
    principled_node(bpy.data.materials["Tiles"]).inputs["Roughness"].default_value = 0.0


def low_over_rough_metal() -> None:
    mirror_floor()
    principled_node(bpy.data.materials["Mirror"]).inputs["Roughness"].default_value = 0.45
    bpy.data.objects.remove(bpy.context.scene.camera)
    room = EMISSIVE_ROOM
    add_camera(room.world(-4.2, -3.3, 0.4 - room.half_extents[2]), room.world(1.2, 0.9, -2.0), 24.0, 240, 150)


def hardening_floor() -> None:
    """Rough, so that walls are sharp at their foot and blurred farther up."""
    mirror_floor()
    principled_node(bpy.data.materials["Mirror"]).inputs["Roughness"].default_value = 0.3
    bpy.data.objects["Room"].pcc_probe.contact_hardening = True


def not_hardened() -> None:
    bpy.data.objects["Room"].pcc_probe.contact_hardening = False


def brushed_ball() -> None:
    _, ball = anisotropy.build("ball", True)
    inputs = principled_node(ball.data.materials[0]).inputs
    inputs["Roughness"].default_value, inputs["Anisotropic"].default_value = 0.3, 0.9


def brushed_no_more() -> None:
    principled_node(bpy.data.materials["Brushed"]).inputs["Anisotropic"].default_value = 0.0


def waves() -> None:
    mirror_floor()
    tree = bpy.data.materials["Mirror"].node_tree
    uv, waves, bump = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "TexWave", "Bump"))
    waves.inputs["Scale"].default_value, waves.inputs["Distortion"].default_value = 0.35, 2.0
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 1.0, 0.06
    tree.links.new(uv.outputs["UV"], waves.inputs["Vector"])
    tree.links.new(waves.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], principled_node(bpy.data.materials["Mirror"]).inputs["Normal"])


def flat_normal() -> None:
    tree = bpy.data.materials["Mirror"].node_tree
    tree.links.remove(principled_node(bpy.data.materials["Mirror"]).inputs["Normal"].links[0])


def leaning_room() -> None:
    """The room leans: the probe is turned within a parent that is stretched."""
    any_cubemap.mirror_ball()
    probe, parent = bpy.data.objects["Room"], bpy.data.objects.new("Stretched", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location, parent.scale = probe.location, (2.5, 1.0, 1.0)
    probe.parent, probe.location = parent, (0.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    any_cubemap.paint_walls(probe.matrix_world.copy(), 64)
    probe.pcc_probe.hidden_objects.add().object = bpy.data.objects["Ball"]


def right_angled() -> None:
    """The best box without shear: the one that Blender makes of the matrix when the parent goes."""
    probe = bpy.data.objects["Room"]
    location, turn, scale = probe.matrix_world.decompose()
    probe.parent = None
    probe.matrix_world = Matrix.LocRotScale(location, turn, scale)
    bpy.context.view_layer.update()


@contextmanager
def real_rooms() -> Iterator[None]:
    with interior.rooms_behind(interior.FAR_FRONT, bpy.data.collections["Furnished Room"]):
        yield


def flat_panes() -> None:
    interior_node(bpy.data.materials["Window"]).inputs["Depth"].default_value = 0.001


def moving_room() -> None:
    """The moving room as it is at last; saved, as sequences need files."""
    moving.build(Path(mkdtemp(dir=_FILES.name)))
    bpy.context.scene.frame_set(20)


def still_of_the_start() -> None:
    bpy.context.scene.frame_set(1)
    bpy.ops.pcc.bake(scope="ALL", frames="still")
    bpy.context.scene.frame_set(20)


def captured_from_behind() -> None:
    """The mirror ball stands between the capture point and the walls that it shows to the camera."""
    painted_walls()
    bpy.data.objects["Room"].pcc_probe.capture_offset = (2.4, 1.3, 0.1)


def with_itself() -> None:
    bpy.data.objects["Room"].pcc_probe.hidden_objects.clear()
    bpy.ops.pcc.bake(scope="ALL")


@contextmanager
def glossy_ball() -> Iterator[None]:
    """A reflection ray instead of the node, which meets what the capture saw."""
    ball, *others = (bpy.data.objects[name] for name in ("Iridescent Ball", "Toon Ball", "Mirror in Mist"))
    slots = ball.data.materials
    shown, slots[0] = slots[0], by_hand.iridescent_traced()
    for other in others:
        other.visible_glossy = False
    yield
    slots[0] = shown
    for other in others:
        other.visible_glossy = True


def metal_under_a_lamp() -> None:
    engines.build(next(case for case in engines.CASES if case.name == "metal, roughness 0.3"), True)


def in_eevee() -> None:
    scene = bpy.context.scene
    scene.render.engine = engine_id(Engine.EEVEE)
    scene.eevee.use_raytracing = True


def already() -> None:
    """The scene comes baked."""
