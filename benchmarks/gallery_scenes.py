"""Scenes of the gallery, and what makes each do without the system that it shows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp

import bpy
from mathutils import Matrix

from benchmarks import doorway, interior, moving
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.shade.interior import interior_node
from sample_blends import any_cubemap, by_hand
from sample_blends.scenes import (
    EMISSIVE_ROOM,
    Room,
    add_room_probe,
    emissive_room,
    principled_node,
)
from sample_blends.two_rooms import two_rooms

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


def rough_floor() -> None:
    two_rooms(0.22)
    for name in ("Lounge Mirror", "Study Mirror"):
        bpy.data.objects.remove(bpy.data.objects[name])  # no probe shows what a mirror shows
    principled_node(bpy.data.materials["Tiles"]).inputs["IOR"].default_value = 2.5


def sharp_picture() -> None:
    principled_node(bpy.data.materials["Tiles"]).inputs["Roughness"].default_value = 0.0


def hardening_floor() -> None:
    """Rough, so that walls are sharp at their foot and blurred farther up."""
    mirror_floor()
    principled_node(bpy.data.materials["Mirror"]).inputs["Roughness"].default_value = 0.3
    bpy.data.objects["Room"].pcc_probe.contact_hardening = True


def not_hardened() -> None:
    bpy.data.objects["Room"].pcc_probe.contact_hardening = False


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


def already() -> None:
    """The scene comes baked."""
