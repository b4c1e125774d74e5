"""EEVEE's own ray tracing with and without probes, against path tracing: what a served surface gains or loses by it.

python3 dev.py run benchmarks/engines.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import bpy
import numpy as np
from mathutils import Vector

from benchmarks.measure import pixels_of, relative_rmse, render, start, table, write_page
from pcc_addon.blender.shade.twin import reflection_nodes
from pcc_addon.core.probe import Engine
from sample_blends.scenes import (
    EMISSIVE_COLORS,
    Room,
    add_camera,
    add_room_probe,
    add_wall,
    emissive_checker,
    empty_scene,
    principled,
)

ROOM = Room((2.5, 2.0, 1.3), (40.0, -20.0, 1.3), 0.4)
SIZE, FACE, SAMPLES, TRUTH = (64, 40), 128, 16, 256
SERVED = "Served"


@dataclass(frozen=True)
class Case:
    """Something that shows a probe.

    Attributes:
        name: of the case, for tables.
        inputs: of its Principled BSDF, underscores for spaces.
        ball: whether it is a ball over a matt floor; otherwise the floor itself.
        weight: of the probe; the rest of the surface keeps its own lobe.
    """

    name: str
    inputs: dict[str, object]
    ball: bool = False
    weight: float = 1.0


_EXPLAINED = """## EEVEE

A twin emits the reflection and its base has no specular lobe left, so rays that EEVEE traces find nothing to add; they
are cast only for what keeps its own lobe. A surface that shows half of a probe therefore is the mean of both. *Diffuse
Depth* is 0 where EEVEE shades what the camera sees. The diffuse base of a dielectric is EEVEE's own and gains
from its ray tracing as it does without a probe; so do the coat, and whatever shows no probe.

What rays off other surfaces find in the picture is the twin's emission: where EEVEE's ray tracing is on, a served
surface lights the walls around it a little, as it should. The picture of a lamp comes out some per cent weaker than in
Cycles, with ray tracing and without.

## Which rays see the probe

In Cycles paths that left a diffuse surface see the surface's own lobe, all others the probe. There is no setting: the
other choices, the probe for all rays or its roughest level for those, are measured in [noise and
fireflies](noise.md), and [decisions](decisions.md) say what follows. To have the probe for all rays in one material,
use it [by hand](artists/by_hand.md)."""
_METAL = {"Base_Color": (0.9, 0.9, 0.9, 1.0), "Metallic": 1.0}
CASES = (
    Case("mirror", _METAL | {"Roughness": 0.0}),
    Case("metal, roughness 0.3", _METAL | {"Roughness": 0.3}),
    Case("dielectric floor, roughness 0.1", {"Base_Color": (0.2, 0.15, 0.1, 1.0), "Roughness": 0.1}),
    Case("ball of glass", {"Transmission_Weight": 1.0, "Roughness": 0.0}, ball=True),
    Case("mirror, weight ½", _METAL | {"Roughness": 0.0}, weight=0.5),
)


@dataclass(frozen=True)
class Seen:
    """Pictures of a case, (h, w, 3) linear radiance: whole, and without what the probe shows."""

    whole: np.ndarray
    base: np.ndarray


def build(case: Case, lit: bool) -> bpy.types.Scene:
    """A new file with a small room, turned and away from the origin: lit by a lamp, or of glowing walls."""
    scene = empty_scene()
    served = principled(SERVED, **case.inputs)
    for side, (bright, dark) in EMISSIVE_COLORS.items():
        matt = principled(f"Matt {side}", Base_Color=(*bright, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
        add_wall(ROOM, side, matt if lit else emissive_checker(f"Glow {side}", bright, dark))
    matt = principled("Matt", Base_Color=(0.4, 0.4, 0.4, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    add_wall(ROOM, "-Z", matt if case.ball else served)
    probe = add_room_probe(ROOM).pcc_probe
    if case.ball:
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, segments=64, ring_count=32, location=ROOM.world(0.4, 0.2, 0.0))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(served)
        probe.hidden_objects.add().object = bpy.context.object
    if lit:
        light = bpy.data.lights.new("Lamp", "AREA")
        light.size, light.energy = 0.8, 60.0
        lamp = bpy.data.objects.new("Lamp", light)
        lamp.location = ROOM.world(0.6, 0.3, 1.25)
        scene.collection.objects.link(lamp)
    target = (0.4, 0.2, 0.0) if case.ball else (0.8, 0.6, -1.2)
    add_camera(ROOM.world(-2.2, -1.7, 0.2), Vector(ROOM.world(*target)), 22.0, *SIZE)
    probe.resolution, probe.samples, probe.denoise, probe.weight = FACE, 64 if lit else 4, False, case.weight
    scene.eevee.use_shadows = False  # nine tenths of the time; the room is convex
    scene.world.probe_resolution = "128"
    scene.cycles.transmission_bounces = scene.cycles.max_bounces = 16
    scene.cycles.sample_clamp_indirect = 0.0
    return scene


def eevee(scene: bpy.types.Scene, traced: bool) -> np.ndarray:
    """EEVEE's picture with its own ray tracing off or on, with Blender's default settings of it."""
    scene.eevee.use_raytracing = traced
    return render(scene, Engine.EEVEE, SAMPLES).pixels


def cycles(scene: bpy.types.Scene) -> np.ndarray:
    """Cycles' picture."""
    return render(scene, samples=SAMPLES).pixels


def served(take: Callable[[], np.ndarray], case: Case) -> Seen:
    """What an engine shows of a scene whose materials show probes; `take` renders it."""
    whole = take()
    if case.ball:  # all of glass is the probe's; muted, as captures see it, it is Blender's own
        return Seen(whole, np.zeros_like(whole))
    shining = reflection_nodes(bpy.data.materials[SERVED])
    for node in shining:
        node.mute = True
    base = take()
    for node in shining:
        node.mute = False
    return Seen(whole, base)


def measure(case: Case, lit: bool) -> list[str]:
    """A row of the table."""
    scene = build(case, lit)
    mask = pixels_of(scene, {SERVED})
    truth = render(scene, samples=TRUTH if lit else 64).pixels
    alone = [eevee(scene, traced) for traced in (False, True)]
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    boxed = served(partial(cycles, scene), case)
    off, on = (served(partial(eevee, scene, traced), case) for traced in (False, True))
    pictures = (*alone, boxed.whole, off.whole, on.whole)
    means = [f"{picture[mask].mean() / truth[mask].mean():.3f}" for picture in pictures]
    errors = [f"{relative_rmse(picture, truth, mask):.3f}" for picture in pictures]
    ours, without, traced = ((seen.whole - seen.base)[mask].mean() for seen in (boxed, off, on))
    ratios = [f"{traced / without:.4f}", f"{without / ours:.3f}"] if case.weight == 1.0 else ["own lobe too"] * 2
    elsewhere = [f"{picture[~mask].mean() / truth[~mask].mean():.3f}" for picture in (*alone, off.whole, on.whole)]
    room = "lamp" if lit else "glowing walls"
    print(room, case.name, means, ratios, file=sys.stderr, flush=True)
    return [room, case.name, *(f"{m} ({e})" for m, e in zip(means, errors, strict=True)), *ratios, *elsewhere]


def main() -> None:
    start()
    rows = [measure(case, lit) for lit in (False, True) for case in CASES]
    head = [
        "room",
        "surface",
        "alone, off",
        "alone, on",
        "probe, Cycles",
        "probe, off",
        "probe, on",
        "reflection, on ÷ off",
        "EEVEE ÷ Cycles",
        "elsewhere: alone, off",
        "alone, on",
        "probe, off",
        "probe, on",
    ]
    text = (
        f"A small room, turned and away from the origin, of glowing walls or lit by a lamp; {SIZE[0]} × {SIZE[1]} "
        f"pixels, faces of {FACE} px, {SAMPLES} samples, in EEVEE without shadow maps. *Off* and *on*: EEVEE's own ray "
        "tracing, with its default settings. *Alone*: without a probe. Mean radiance over the pixels of the surface, "
        "and in brackets the relative RMSE, against path tracing. *Reflection*: what the probe adds to the picture, "
        "that of EEVEE's ray tracing on over off (1: nothing doubled, nothing lost), and of EEVEE over Cycles. "
        "*Elsewhere*: the mean of the other pixels.\n\n" + table(head, rows) + "\n\n" + _EXPLAINED
    )
    write_page("engines.md", "The result in each engine", "python3 dev.py run benchmarks/engines.py", text)


if __name__ == "__main__":
    main()
