"""Lamps and the world."""

from __future__ import annotations

from pathlib import Path

import bpy

from pcc_addon.core.probe import Engine
from tests.blender.stale.rows import Steps, settings_rows, stale
from tests.blender.stale.things import (
    background,
    collection,
    lamp,
    picture,
    scene,
    the,
    thing,
    world,
)

CYCLES, EEVEE = Engine.CYCLES, Engine.EEVEE

settings_rows(
    True, "lamp", lamp, "{}", CYCLES, energy=11.0, color=(1.0, 0.5, 0.5), size=0.3, shape="DISK", spread=1.0,
    use_shadow=False, exposure=1.0, type="POINT",
)  # fmt: skip
settings_rows(True, "lamp", lambda: lamp().cycles, "{}", CYCLES, max_bounces=2, is_portal=True)
settings_rows(True, "lamp", lamp, "{}", EEVEE, specular_factor=0.5, use_custom_distance=True)


@stale("lamp", "its nodes")
def _(folder: Path) -> Steps:
    if lamp().node_tree is None:
        lamp().use_nodes = True
    made = next(n for n in lamp().node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
    yield
    made.inputs["Strength"].default_value = 3.0


@stale("lamp", "which objects it lights")
def _(folder: Path) -> Steps:
    made = collection("Lit", link=False)
    made.objects.link(the())
    yield
    the("Lamp").light_linking.receiver_collection = made


@stale("lamp", "an object more that it lights")
def _(folder: Path) -> Steps:
    made = collection("Lit", link=False)
    made.objects.link(the())
    the("Lamp").light_linking.receiver_collection = made
    other = thing("Other")
    yield
    made.objects.link(other)


@stale("world", "its colour")
def _(folder: Path) -> Steps:
    yield
    background().inputs["Color"].default_value = (1.0, 0.0, 0.0, 1.0)


@stale("world", "its nodes")
def _(folder: Path) -> Steps:
    yield
    sky = world().node_tree.nodes.new("ShaderNodeTexSky")
    world().node_tree.links.new(sky.outputs[0], background().inputs["Color"])


@stale("world", "its image")
def _(folder: Path) -> Steps:
    made = world().node_tree.nodes.new("ShaderNodeTexEnvironment")
    world().node_tree.links.new(made.outputs[0], background().inputs["Color"])
    made.image = bpy.data.images.load(str(picture(folder)))
    yield
    picture(folder, value=0.25)


@stale("world", "another one")
def _(folder: Path) -> Steps:
    other = world().copy()
    next(n for n in other.node_tree.nodes if n.bl_idname == "ShaderNodeBackground").inputs[1].default_value = 2.0
    yield
    scene().world = other


@stale("world", "none")
def _(folder: Path) -> Steps:
    yield
    scene().world = None


settings_rows(
    True, "world", lambda: world().cycles_visibility, "visible: {}", CYCLES, diffuse=False, glossy=False,
    transmission=False, scatter=False,
)  # fmt: skip
settings_rows(True, "world", world, "{}", EEVEE, sun_threshold=3.0, use_sun_shadow=False)
