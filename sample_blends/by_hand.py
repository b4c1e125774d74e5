"""Shaders of their own that read a probe: an iridescent ball, a toon ball, a mirror in mist, in a marked room."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy

from pcc_addon.blender.shade.by_hand import group_for
from pcc_addon.blender.shade.node_layout import spread

from .scenes import EMISSIVE_COLORS, Room, add_box, add_camera, add_wall, emissive_checker, empty_scene

ROOM = Room((3.0, 2.5, 1.5), (-20.0, 15.0, 1.5), math.radians(20.0))
HUES = ((0.9, 0.25, 0.5), (0.95, 0.75, 0.2), (0.2, 0.9, 0.6), (0.25, 0.45, 1.0), (0.8, 0.3, 1.0))
STEPS = ((0.0, (0.03, 0.05, 0.18)), (0.25, (0.1, 0.35, 0.75)), (0.45, (0.55, 0.85, 1.0)))  # from which luminance on
MIST, CLEAR = (0.55, 0.6, 0.65), 4.0  # its radiance, and how many metres dim what is seen to 1/e


def by_hand(resolution: int = 256, samples: int = 4) -> bpy.types.Scene:
    """The sample, with its probe baked at once, as nodes by hand need a bake; the arguments are the probe's."""
    scene = empty_scene()
    for side, (bright, dark) in EMISSIVE_COLORS.items():
        add_wall(ROOM, side, emissive_checker(f"Glow {side}", bright, dark))
    add_wall(ROOM, "-Z", emissive_checker("Glow -Z", (0.5, 0.4, 0.3), (0.2, 0.16, 0.12)))
    things = [_ball("Iridescent Ball", (-0.8, 0.5, -0.2)), _ball("Toon Ball", (0.8, 0.1, -0.2)), _mirror()]
    bpy.ops.pcc.probe_add(
        name="Room", location=ROOM.centre, rotation=(0.0, 0.0, ROOM.turn), half_extents=ROOM.half_extents
    )
    probe = bpy.context.object
    settings = probe.pcc_probe
    settings.resolution, settings.samples, settings.denoise = resolution, samples, False
    for thing in things:
        settings.hidden_objects.add().object = thing
    bpy.ops.pcc.bake(scope="ALL")
    for thing, shader in zip(things, (iridescent, toon, in_mist), strict=True):
        thing.data.materials.append(shader(probe))
    add_camera(ROOM.world(0.3, -2.3, 0.5), ROOM.world(0.1, 0.6, -0.2), 20.0, 480, 270)
    scene.cycles.samples = 16
    scene.view_settings.view_transform = "Standard"
    return scene


def iridescent(probe: bpy.types.Object) -> bpy.types.Material:
    """A mirror whose colour changes with the angle that it is seen at."""
    material, output = _empty("Iridescent")
    tree = material.node_tree
    node, tinted = _probe_node(tree, probe), tree.nodes.new("ShaderNodeVectorMath")
    tinted.operation = "MULTIPLY"
    tree.links.new(node.outputs["Radiance"], tinted.inputs[0])
    tree.links.new(_hue(tree), tinted.inputs[1])
    _emit(tree, tinted.outputs[0], node, output)
    return material


def iridescent_traced() -> bpy.types.Material:
    """The same with reflection rays: what the path tracer makes of it."""
    material, output = _empty("Iridescent, Traced")
    tree = material.node_tree
    glossy = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    glossy.inputs["Roughness"].default_value = 0.0
    tree.links.new(_hue(tree), glossy.inputs["Color"])
    tree.links.new(glossy.outputs[0], output.inputs["Surface"])
    return material


def toon(probe: bpy.types.Object) -> bpy.types.Material:
    """A blurred reflection in three flat colours."""
    material, output = _empty("Toon")
    tree = material.node_tree
    node = _probe_node(tree, probe)
    node.inputs["Roughness"].default_value = 0.1
    luminance, steps = tree.nodes.new("ShaderNodeRGBToBW"), tree.nodes.new("ShaderNodeValToRGB")
    _fill(steps.color_ramp, STEPS)
    steps.color_ramp.interpolation = "CONSTANT"
    tree.links.new(node.outputs["Radiance"], luminance.inputs[0])
    tree.links.new(luminance.outputs[0], steps.inputs[0])
    _emit(tree, steps.outputs["Color"], node, output)
    return material


def in_mist(probe: bpy.types.Object) -> bpy.types.Material:
    """A mirror in which far walls fade into mist, by the probe's Distance."""
    material, output = _empty("In Mist")
    tree = material.node_tree
    node = _probe_node(tree, probe)
    power, mixed = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMix")
    power.operation = "POWER"
    power.inputs[0].default_value = math.exp(-1.0 / CLEAR)
    mixed.data_type = "RGBA"
    factor, a, b = (next(s for s in mixed.inputs if s.identifier == n) for n in ("Factor_Float", "A_Color", "B_Color"))
    a.default_value = (*MIST, 1.0)
    tree.links.new(node.outputs["Distance"], power.inputs[1])
    tree.links.new(power.outputs[0], factor)
    tree.links.new(node.outputs["Radiance"], b)
    _emit(tree, next(s for s in mixed.outputs if s.identifier == "Result_Color"), node, output)
    return material


def _ball(name: str, place: tuple[float, float, float]) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.65, location=ROOM.world(*place))
    ball = bpy.context.object
    ball.name = name
    ball.data.shade_smooth()
    return ball


def _mirror() -> bpy.types.Object:
    mirror = add_box(ROOM, "Mirror in Mist", (0.0, 2.4, 0.2), (1.2, 0.04, 0.9), bpy.data.materials["Glow -Z"])
    mirror.data.materials.clear()
    return mirror


def _empty(name: str) -> tuple[bpy.types.Material, bpy.types.Node]:
    """A material of an output alone, whose light Cycles does not sample as a lamp's."""
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    material.cycles.emission_sampling = "NONE"
    material.node_tree.nodes.clear()
    return material, material.node_tree.nodes.new("ShaderNodeOutputMaterial")


def _probe_node(tree: bpy.types.NodeTree, probe: bpy.types.Object) -> bpy.types.Node:
    """What *Add › Parallax Probes* in the Shader Editor adds."""
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group_for(probe)
    return node


def _hue(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    facing, hues = tree.nodes.new("ShaderNodeLayerWeight"), tree.nodes.new("ShaderNodeValToRGB")
    _fill(hues.color_ramp, [(k / (len(HUES) - 1), hue) for k, hue in enumerate(HUES)])
    tree.links.new(facing.outputs["Facing"], hues.inputs[0])
    return hues.outputs["Color"]


def _fill(ramp: bpy.types.ColorRamp, stops: Sequence[tuple[float, tuple[float, float, float]]]) -> None:
    for k, (position, color) in enumerate(stops):
        element = ramp.elements[k] if k < len(ramp.elements) else ramp.elements.new(position)
        element.position, element.color = position, (*color, 1.0)


def _emit(tree: bpy.types.NodeTree, color: bpy.types.NodeSocket, node: bpy.types.Node, output: bpy.types.Node) -> None:
    """Show a colour by the weight of a probe's node; outside its reach the surface is matt."""
    emission, matt, mixed = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "BsdfDiffuse", "MixShader"))
    tree.links.new(color, emission.inputs["Color"])
    tree.links.new(node.outputs["Weight"], mixed.inputs[0])
    tree.links.new(matt.outputs[0], mixed.inputs[1])
    tree.links.new(emission.outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    matt.location.y = -400.0  # below the probe's node, whose three numbers take more room than links do
    spread(tree, list(tree.nodes))
