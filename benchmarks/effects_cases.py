"""One small scene for each effect, in which nothing but a reflection is seen, and how to switch the effect."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
from mathutils import Vector

from pcc_addon.core.decisions import Effect
from sample_blends.scenes import (
    EMISSIVE_COLORS,
    Room,
    add_box,
    add_camera,
    add_room_probe,
    add_wall,
    emissive_checker,
    empty_scene,
    principled,
    principled_node,
)

ROOM = Room((3.0, 3.0, 1.5), (0.0, 0.0, 0.0), 0.0)
GLOSSY = "Glossy"
WIDTH, HEIGHT = 240, 135


@dataclass(frozen=True)
class Case:
    """An effect, and a scene to measure it in.

    Attributes:
        effect: which.
        prepare: changes the scene of `build`; gets the glossy material's Principled BSDF and the probe.
        needed: whether the scene then needs the effect, so that it is measured against being forced off; else forced
            on is measured against being left out.
        beside: other effects that are forced on in both.
    """

    effect: Effect
    prepare: Callable[[bpy.types.Node, bpy.types.Object], None] = lambda node, probe: None
    needed: bool = True
    beside: tuple[Effect, ...] = field(default=())


def build(case: Case) -> tuple[bpy.types.Scene, bpy.types.Material, bpy.types.Object]:
    """A room with glowing walls, a glossy table that fills the picture, and a probe; prepared for a case."""
    scene = empty_scene()
    for side, colors in EMISSIVE_COLORS.items():
        add_wall(ROOM, side, emissive_checker(f"Wall {side}", *colors))
    glossy = principled(GLOSSY, Roughness=0.0, Metallic=0.0, Base_Color=(0.5, 0.4, 0.3, 1.0))
    principled_node(glossy).distribution = "GGX"
    add_box(ROOM, "Table", (0.0, 0.0, -0.5), (1.5, 1.5, 0.05), glossy)
    probe = add_room_probe(ROOM)
    probe.pcc_probe.resolution, probe.pcc_probe.samples = 128, 4
    camera = add_camera(Vector((0.0, -0.9, 0.3)), Vector((0.0, 0.05, -0.45)), 42.0, WIDTH, HEIGHT)
    scene.camera = camera
    case.prepare(principled_node(glossy), probe)
    bpy.context.view_layer.update()
    return scene, glossy, probe


def switch(case: Case, on: bool) -> None:
    """Force the effect on or leave it to the plan; where the scene needs it, force it off or leave it to the plan."""
    states = {effect.key: "ON" for effect in case.beside}
    states[case.effect.key] = ("AUTO" if on else "OFF") if case.needed else ("ON" if on else "AUTO")
    for settings in (*(o.pcc_probe.effects for o in bpy.data.objects), *(m.pcc.effects for m in bpy.data.materials)):
        for key, state in states.items():
            if hasattr(settings, key):
                setattr(settings, key, state)


def _given(**inputs: object) -> Callable[[bpy.types.Node, bpy.types.Object], None]:
    def prepare(node: bpy.types.Node, probe: bpy.types.Object) -> None:
        for key, value in inputs.items():
            node.inputs[key.replace("_", " ")].default_value = value

    return prepare


def _harden(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    node.inputs["Roughness"].default_value = 0.3
    probe.pcc_probe.contact_hardening = True


def _scatter(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    node.inputs["Roughness"].default_value = 0.3
    node.distribution = "MULTI_GGX"


def _vary(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    noise = node.id_data.nodes.new("ShaderNodeTexNoise")
    node.id_data.links.new(noise.outputs[0], node.inputs["Roughness"])


def _perturb(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    tree = node.id_data
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], node.inputs["Normal"])


def _halve(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    """Two probes, each with half of the room."""
    for x in (-1.5, 1.5):
        half = add_room_probe(Room((1.5, 3.0, 1.5), (x, 0.0, 0.0), 0.0))
        half.pcc_probe.resolution, half.pcc_probe.samples = 128, 4
    bpy.data.objects.remove(probe)


def _lay(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    """A mirror on the floor alone."""
    bpy.data.objects.remove(bpy.data.objects["Table"])
    add_wall(ROOM, "-Z", bpy.data.materials[GLOSSY])
    probe.pcc_probe.capture_offset.z = -0.4


def _stand(node: bpy.types.Node, probe: bpy.types.Object) -> None:
    probe.pcc_probe.correction = "RELIEF"


CASES = (
    Case(Effect.PARALLAX),
    Case(Effect.RELIEF, _stand),
    Case(Effect.TURN, needed=False),
    Case(Effect.OFFSET, needed=False),
    Case(Effect.FADE, needed=False),
    Case(Effect.OUTER_SIDES, needed=False, beside=(Effect.FADE,)),
    Case(Effect.FACE_FALLOFFS, needed=False, beside=(Effect.FADE,)),
    Case(Effect.NORMAL_FADE, needed=False),
    Case(Effect.WEIGHT, needed=False),
    Case(Effect.HARDENING, _harden),
    Case(Effect.WALLS, needed=False),
    Case(Effect.MULTISCATTER, _scatter),
    Case(Effect.ANISOTROPY, _given(Roughness=0.3, Anisotropic=0.6)),
    Case(Effect.FILM, _given(Thin_Film_Thickness=300.0)),
    Case(Effect.DIELECTRIC, _given(Metallic=1.0), needed=False),
    Case(Effect.TINT, needed=False),
    Case(Effect.METAL, needed=False),
    Case(Effect.TRANSMISSION, _given(Transmission_Weight=0.5)),
    Case(Effect.ROUGHNESS, _given(Roughness=0.3), needed=False),
    Case(Effect.BENT_NORMALS, _perturb),
    Case(Effect.OWN_LOBE, _vary),
    Case(Effect.BY_PLACE, _halve),
)
"""All that shaders compute."""

BAKES = (Case(Effect.LEVELS, needed=False), Case(Effect.FACES, _lay, needed=False))
"""What bakes have."""
