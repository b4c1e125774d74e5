"""Particles, hair, curves, points, volumes, drawings."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, stale
from tests.blender.stale.things import (
    drawing,
    placed,
    scene,
    the,
    thing,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE


def particles(kind: str = "HAIR") -> bpy.types.ParticleSystem:
    the().modifiers.new("Particles", "PARTICLE_SYSTEM")
    system = the().particle_systems[0]
    system.settings.type = kind
    return system


@stale("particles", "their count")
def _(folder: Path) -> Steps:
    system = particles()
    yield
    system.settings.count += 1


@stale("particles", "their seed")
def _(folder: Path) -> Steps:
    system = particles()
    yield
    system.seed = 5


@stale("particles", "the object that they show")
def _(folder: Path) -> Steps:
    other = thing("Other", link=False)
    system = particles()
    system.settings.render_type, system.settings.instance_object = "OBJECT", other
    yield
    other.data.vertices[0].co.x += 0.1


@stale("particles", "the frame, where they move")
def _(folder: Path) -> Steps:
    particles("EMITTER")
    yield
    scene().frame_set(scene().frame_current + 3)


@stale("other shapes", "a point of hair curves")
def _(folder: Path) -> Steps:
    hair = bpy.data.hair_curves.new("Hair")
    hair.add_curves([3, 4])
    placed("Hair", hair)
    yield
    hair.attributes["position"].data[2].vector = (0.0, 0.5, 0.0)


@stale("other shapes", "where hair curves end")
def _(folder: Path) -> Steps:
    hair = bpy.data.hair_curves.new("Hair")
    hair.add_curves([3, 4])
    item = placed("Hair", hair)
    other = bpy.data.hair_curves.new("Other")
    other.add_curves([4, 3])
    yield
    item.data = other


def bezier() -> bpy.types.Curve:
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.splines.new("BEZIER").bezier_points.add(2)
    curve.bevel_depth = 0.1
    placed("Curve", curve)
    return curve


@stale("other shapes", "a handle of a curve")
def _(folder: Path) -> Steps:
    curve = bezier()
    yield
    curve.splines[0].bezier_points[1].handle_left = (0.0, 0.5, 0.0)


@stale("other shapes", "how thick a curve is")
def _(folder: Path) -> Steps:
    curve = bezier()
    yield
    curve.bevel_depth = 0.2


@stale("other shapes", "the profile of a curve")
def _(folder: Path) -> Steps:
    curve, other = bezier(), bpy.data.curves.new("Profile", "CURVE")
    other.splines.new("POLY").points.add(3)
    curve.bevel_mode, curve.bevel_object = "OBJECT", placed("Profile", other)
    the("Profile").hide_render = True
    yield
    other.splines[0].points[1].co = (1.0, 0.0, 0.0, 1.0)


@stale("other shapes", "a point of a surface")
def _(folder: Path) -> Steps:
    made = bpy.data.curves.new("Surface", "SURFACE")
    made.splines.new("NURBS").points.add(3)
    placed("Surface", made)
    yield
    made.splines[0].points[1].co = (1.0, 0.0, 0.0, 1.0)


@stale("other shapes", "a text")
def _(folder: Path) -> Steps:
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "here"
    placed("Text", text)
    yield
    text.body = "there"


@stale("other shapes", "the material of a letter")
def _(folder: Path) -> Steps:
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "here"
    placed("Text", text)
    yield
    text.body_format[1].material_index = 1


@stale("other shapes", "a metaball")
def _(folder: Path) -> Steps:
    balls = bpy.data.metaballs.new("Ball")
    element = balls.elements.new()
    placed("Ball", balls)
    yield
    element.radius = 1.5


@stale("other shapes", "a metaball of another family")
def _(folder: Path) -> Steps:
    for name in ("Ball", "Ball.001"):
        balls = bpy.data.metaballs.new(name)
        balls.elements.new()
        placed(name, balls)
    yield
    the("Ball.001").name = "Drop"


@stale("other shapes", "a point of a cloud")
def _(folder: Path) -> Steps:
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.convert(target="POINTCLOUD")
    item = bpy.context.object
    assert item.type == "POINTCLOUD"
    yield
    item.data.attributes["position"].data[0].vector = (3.0, 0.0, 0.0)


def volume(folder: Path) -> bpy.types.Volume:
    (folder / "smoke.vdb").write_bytes(b"one")
    made = bpy.data.volumes.new("Smoke")
    made.filepath = str(folder / "smoke.vdb")
    placed("Smoke", made)
    return made


@stale("other shapes", "the file of a volume")
def _(folder: Path) -> Steps:
    volume(folder)
    yield
    (folder / "smoke.vdb").write_bytes(b"two")
    os.utime(folder / "smoke.vdb", ns=(1, 1))


@stale("other shapes", "how a volume is rendered")
def _(folder: Path) -> Steps:
    made = volume(folder)
    yield
    made.render.step_size = 0.5


@stale("other shapes", "the density of a volume's material")
def _(folder: Path) -> Steps:
    smoke = bpy.data.materials.new("Smoke")
    if smoke.node_tree is None:
        smoke.use_nodes = True
    made = smoke.node_tree.nodes.new("ShaderNodeVolumePrincipled")
    output = next(n for n in smoke.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    smoke.node_tree.links.new(made.outputs[0], output.inputs["Volume"])
    volume(folder).materials.append(smoke)
    yield
    made.inputs["Density"].default_value = 3.0


@stale("other shapes", "a point that is drawn")
def _(folder: Path) -> Steps:
    made = drawing()
    yield
    made.layers[0].current_frame().drawing.attributes["position"].data[0].vector = (0.0, 0.0, 2.0)


@stale("other shapes", "a layer of a drawing hidden")
def _(folder: Path) -> Steps:
    made = drawing()
    yield
    made.layers[0].hide = True


@stale("other shapes", "the strokes of a drawing's material")
def _(folder: Path) -> Steps:
    made = drawing()
    yield
    made.materials[-1].grease_pencil.color = (1.0, 0.0, 0.0, 1.0)


@stale("other shapes", "a plane that EEVEE mirrors in", EEVEE)
def _(folder: Path) -> Steps:
    bpy.ops.object.lightprobe_add(type="PLANE")
    yield
    bpy.context.object.location.x += 1.0
