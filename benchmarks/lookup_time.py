"""How long Cycles takes for a frame that is nothing but lookups: what one formula costs against another."""

from __future__ import annotations

import os
from collections.abc import Mapping
from statistics import median

import bpy
import numpy as np

from pcc_addon.blender.rendering import render
from pcc_addon.blender.shade import node_builder
from pcc_addon.core.expression import Expr
from sample_blends.scenes import emissive, empty_scene

WIDTH, SAMPLES, ROUNDS = 384, 64, 9


def relative_times(
    formulas: Mapping[str, Mapping[str, Expr]], constants: Mapping[str, tuple[float, float, float] | float]
) -> dict[str, float]:
    """Processor time of frames that show a picture looked up by formulas' "Direction", in shares of the first one's.

    A plane fills the frame; its point, view vector and normal come from the geometry, other inputs are constants.
    """
    scene = _scene()
    plane = next(item for item in scene.objects if item.type == "MESH")
    materials = {name: _material(name, outputs, constants) for name, outputs in formulas.items()}
    seconds: dict[str, list[float]] = {name: [] for name in materials}
    names = list(materials)
    for turn in range(ROUNDS + 1):
        for name in names[turn % len(names) :] + names[: turn % len(names)]:
            plane.data.materials.clear()
            plane.data.materials.append(materials[name])
            begin = os.times().user
            render(scene)
            seconds[name].append(os.times().user - begin)
    times = {name: median(values[1:]) for name, values in seconds.items()}  # the first round warms up
    return {name: time / times[names[0]] for name, time in times.items()}


def node_count(outputs: Mapping[str, Expr]) -> int:
    """How many nodes compute some outputs."""
    tree = bpy.data.node_groups.new("count", "ShaderNodeTree")
    node_builder.emit(tree, outputs)
    count = sum(not node.bl_idname.startswith("NodeGroup") for node in tree.nodes)
    bpy.data.node_groups.remove(tree)
    return count


def _scene() -> bpy.types.Scene:
    scene = empty_scene()
    scene.render.resolution_x = scene.render.resolution_y = WIDTH
    scene.cycles.samples, scene.cycles.max_bounces = SAMPLES, 0
    bpy.ops.mesh.primitive_plane_add(size=40.0, location=(0.0, 0.0, -1.0))
    eye = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    eye.location.z = 3.0
    scene.collection.objects.link(eye)
    scene.camera = eye
    return scene


def _material(name: str, outputs: Mapping[str, Expr], constants: Mapping) -> bpy.types.Material:
    material, emission = emissive(name)
    material.cycles.emission_sampling = "NONE"
    nodes, links = material.node_tree.nodes, material.node_tree.links
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    node_builder.emit(tree, {"Direction": outputs["Direction"]})
    group, geometry = nodes.new("ShaderNodeGroup"), nodes.new("ShaderNodeNewGeometry")
    group.node_tree = tree
    for socket in group.inputs:
        if socket.name in geometry.outputs:
            links.new(geometry.outputs[socket.name], socket)
        else:
            socket.default_value = constants[socket.name]
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = _picture()
    links.new(group.outputs["Direction"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], emission.inputs["Color"])
    return material


def _picture() -> bpy.types.Image:
    picture = bpy.data.images.get("Noise")
    if picture is None:
        picture = bpy.data.images.new("Noise", 512, 256, float_buffer=True)
        picture.pixels.foreach_set(np.random.default_rng(1).random(512 * 256 * 4).astype(np.float32))
    return picture
