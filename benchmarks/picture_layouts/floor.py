"""The mirror floor of the emissive room: box-corrected lookups compared to the path-traced reflection."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from benchmarks.measure import covered, relative_rmse, render
from benchmarks.picture_layouts.layouts import Atlas, Equirectangular, GuardedEquirectangular, Layout, layouts_of
from benchmarks.picture_layouts.radiances import atlas_of, captured_faces, fill, room
from benchmarks.picture_layouts.shaders import group_node, image_of, lookup_of
from pcc_addon.blender.bake.capture import OVERSCAN
from pcc_addon.core import equirect
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import LookupEffects
from pcc_addon.core.probe import Box, Engine
from sample_blends.scenes import EMISSIVE_ROOM, emissive_room

RESOLUTION = 512  # face width of the captures
SAMPLES = 16


@dataclass(frozen=True)
class FloorResult:
    """The floor with one picture.

    Attributes:
        picture: where that came from.
        layout: how it is kept.
        errors: relative RMSE by engine.
    """

    picture: str
    layout: Layout
    errors: dict[Engine, float]


def measure_floor() -> list[FloorResult]:
    """The floor with each picture, compared over its own pixels."""
    scene = emissive_room()
    floor = bpy.data.objects["Wall -Z"]
    mask, truth = covered(scene, floor), render(scene, samples=SAMPLES).pixels
    results = []
    for label, layout, pixels in _pictures():
        lookup = lookup_of(layout, _box_corrected)
        lookup.show(image_of(pixels))
        floor.data.materials[0] = lookup.material
        errors = {engine: relative_rmse(render(scene, engine, SAMPLES).pixels, truth, mask) for engine in Engine}
        results.append(FloorResult(label, layout, errors))
    return results


def _pictures() -> list[tuple[str, Layout, np.ndarray]]:
    """Label, layout and pixels of what the floor is tried with; equirectangular ones are read as the add-on does."""
    layouts = [layout for layout in layouts_of(RESOLUTION) if type(layout) is not Equirectangular]
    faces = captured_faces(RESOLUTION)
    capture = f"{RESOLUTION} px capture"
    return [
        *((f"exact texels, {layout.label}", layout, fill(layout, room)) for layout in layouts),
        (
            f"{capture}, as the add-on bakes and reads it",
            GuardedEquirectangular(RESOLUTION),
            equirect.from_faces(faces, OVERSCAN),
        ),
        (f"{capture}, its faces as an atlas", Atlas(RESOLUTION), atlas_of(faces)),
    ]


def _box_corrected(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """The box-corrected direction on the floor, from the room's centre."""
    box = Box.from_matrix("room", np.array(EMISSIVE_ROOM.matrix @ Matrix.Diagonal((*EMISSIVE_ROOM.half_extents, 1.0))))
    node = group_node(tree, "box", formula.lookup(LookupEffects(box.correction, None, offset=False)))
    constants = {"Box Centre": box.centre, "Half Widths": box.half_widths, "Turn Mirror": box.turn_mirror}
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    for socket in node.inputs:
        if socket.name in constants:
            socket.default_value = tuple(constants[socket.name])
        else:
            tree.links.new(geometry.outputs[socket.name], socket)
    return node.outputs["Direction"]
