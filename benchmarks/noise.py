"""Noise, energy and fireflies of materials that show probes, against path tracing at equal samples, by light path.

python3 dev.py run benchmarks/noise.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Container, Iterator
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from benchmarks.measure import pixels_of, render, start, table, write_page
from pcc_addon.blender import handlers, marks
from pcc_addon.blender.shade import by_hand
from pcc_addon.blender.shade.surface_builder import PROBE
from sample_blends.scenes import (
    EMISSIVE_ROOM,
    add_box,
    add_camera,
    add_room_probe,
    add_wall,
    emissive_room,
    empty_scene,
    principled,
)
from sample_blends.two_rooms import of_metal, two_rooms

SAMPLES, SEEDS, MANY = 16, 4, 192
SIZE = (96, 54)
ROUGH = 0.6  # the roughest level of a probe
BRIGHT = 5.0  # times the local median: a firefly


@dataclass(frozen=True)
class Place:
    """A scene to measure: how it is built, and the materials that show probes there."""

    name: str
    build: Callable[[], bpy.types.Scene]
    served: Container[str]


@dataclass(frozen=True)
class Measured:
    """RMS noise, converged mean and number of fireflies, each elsewhere and on the receivers."""

    noise: tuple[float, float]
    mean: tuple[float, float]
    fireflies: tuple[int, int]


def _matt_boxes(room: object) -> None:
    white = principled("White", Base_Color=(0.8, 0.8, 0.8, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    for x, y in ((0.5, 1.5), (2.0, -0.5), (-1.5, 1.8)):
        add_box(room, "Block", (x, y, 0.7 - room.half_extents[2]), (0.5, 0.5, 0.7), white)


def glowing_room() -> bpy.types.Scene:
    """The emissive room with white boxes, which its mirror floor lights from below."""
    scene = emissive_room()
    _matt_boxes(EMISSIVE_ROOM)
    add_room_probe(EMISSIVE_ROOM)
    return scene


def under_the_sky() -> bpy.types.Scene:
    """A matt courtyard with a polished floor and white boxes, lit by a smooth sky alone."""
    scene = empty_scene()
    wall = principled("Wall", Base_Color=(0.6, 0.55, 0.5, 1.0), Roughness=0.9, Specular_IOR_Level=0.0)
    for side in ("+X", "-X", "+Y", "-Y"):
        add_wall(EMISSIVE_ROOM, side, wall)
    add_wall(EMISSIVE_ROOM, "-Z", principled("Mirror", Base_Color=(0.9, 0.9, 0.9, 1.0), Metallic=1.0, Roughness=0.1))
    _matt_boxes(EMISSIVE_ROOM)
    background = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (0.4, 0.6, 1.0, 1.0)
    background.inputs["Strength"].default_value = 1.0
    room = EMISSIVE_ROOM
    add_camera(room.world(-4.2, -3.3, 0.0), Vector(room.world(1.2, 0.9, -2.0)), 24.0, *SIZE)
    add_room_probe(EMISSIVE_ROOM)
    return scene


TWO = {"Tiles", "Lounge Mirror", "Study Mirror"}
METALS = TWO | {"Steel", "Leather"}
PLACES = (
    Place("lamps; tiles, roughness 0.04 … 0.16", two_rooms, TWO),
    Place("lamps; steel furniture, tiles of roughness 0.12", of_metal, METALS),
    Place("glowing walls; mirror", glowing_room, {"Mirror"}),
    Place("smooth sky; metal of roughness 0.1", under_the_sky, {"Mirror"}),
)


def fireflies(picture: np.ndarray, converged: np.ndarray) -> np.ndarray:
    """(h, w) mask of the pixels that are bright beside the median of the 5 × 5 around, and are not in the truth."""
    return _stands_out(picture) & ~_stands_out(converged)


def _stands_out(picture: np.ndarray) -> np.ndarray:
    bright = picture.mean(-1)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(bright, 2, "reflect"), (5, 5))
    return bright > BRIGHT * np.median(windows, (-2, -1))


def measure(scene: bpy.types.Scene, mask: np.ndarray) -> Measured:
    """Renders of few samples and one of many."""
    pictures = []
    for seed in range(1, SEEDS + 1):
        scene.cycles.seed = seed
        pictures.append(render(scene, samples=SAMPLES).pixels)
    scene.cycles.seed = SEEDS + 1
    truth = render(scene, samples=MANY).pixels
    noise = np.var(pictures, axis=0, ddof=1)
    bright = [fireflies(picture, truth) for picture in pictures]
    parts = (~mask, mask)
    return Measured(
        tuple(float(np.sqrt(noise[part].mean())) for part in parts),
        tuple(float(truth[part].mean()) for part in parts),
        tuple(int(np.sum([found[part].sum() for found in bright])) for part in parts),
    )


def _own_lobe_mixes() -> Iterator[tuple[bpy.types.ShaderNodeTree, bpy.types.Node]]:
    """The Mix Shaders by which twins show paths behind diffuse surfaces the own lobe, with their trees."""
    for material in bpy.data.materials:
        for node in material.node_tree.nodes:
            if node.bl_idname == "ShaderNodeMixShader" and marks.role(node):
                own = node.inputs[2].links[0].from_node
                if not marks.role(own):
                    yield material.node_tree, node


def own_lobe_for_diffuse_rays_alone() -> None:
    """Give the own lobe to rays that left a diffuse surface, and the probe to what they meet by way of a mirror."""
    for tree, _ in _own_lobe_mixes():
        for path in [n for n in tree.nodes if n.bl_idname == "ShaderNodeLightPath" and marks.role(n)]:
            for link in list(path.outputs["Diffuse Depth"].links):
                tree.links.new(path.outputs["Is Diffuse Ray"], link.to_socket)


def rough_for_diffuse_rays() -> None:
    """Show the twin itself behind diffuse surfaces in place of the own lobe, its probes at their roughest level."""
    for tree, mix in _own_lobe_mixes():
        mix.mute = True
        path = tree.nodes.new("ShaderNodeLightPath")
        for probe in [n for n in tree.nodes if marks.role(n) == PROBE]:
            owner = next(d.driver.variables[0].targets[0].id for d in probe.node_tree.animation_data.drivers)
            rough = tree.nodes.new("ShaderNodeGroup")
            rough.node_tree = by_hand.group_for(owner)
            rough.inputs["Roughness"].default_value = ROUGH
            for output in probe.outputs:
                if not output.name.startswith("Level"):
                    continue
                for link in list(output.links):
                    choice = tree.nodes.new("ShaderNodeMix")
                    choice.data_type = "RGBA"
                    wanted = link.to_socket
                    tree.links.new(path.outputs["Diffuse Depth"], choice.inputs[0])
                    tree.links.new(output, choice.inputs[6])
                    tree.links.new(rough.outputs["Radiance"], choice.inputs[7])
                    tree.links.new(choice.outputs[2], wanted)


def probe_for_diffuse_rays() -> None:
    """Show behind diffuse surfaces what all others see."""
    for _, mix in _own_lobe_mixes():
        mix.mute = True


def main() -> None:
    start()
    rows = []
    for place in PLACES:
        scene = place.build()
        scene.render.resolution_x, scene.render.resolution_y = SIZE
        for probe in (o.pcc_probe for o in scene.objects if o.pcc_probe.is_probe):
            probe.resolution, probe.samples = 128, 32
        mask = pixels_of(scene, place.served)
        path = measure(scene, mask)
        print(path, file=sys.stderr, flush=True)
        bpy.ops.pcc.bake(scope="ALL")
        bpy.ops.pcc.inject()
        found = {"own lobe (as injected)": measure(scene, mask)}
        with handlers.paused():  # or they would restore the twins
            own_lobe_for_diffuse_rays_alone()
            found["own lobe, but the probe by way of mirrors"] = measure(scene, mask)
            probe_for_diffuse_rays()
            found["the probe"] = measure(scene, mask)
            rough_for_diffuse_rays()
            found[f"the probe, roughness {ROUGH:g}"] = measure(scene, mask)
        rows.append([place.name, "path tracing", *["1"] * 4, *(f"{n:g}" for n in path.fireflies)])
        for what, ours in found.items():
            ratios = zip((*ours.noise, *ours.mean), (*path.noise, *path.mean), strict=True)
            rows.append([place.name, what, *(f"{a / b:.3f}" for a, b in ratios), *(f"{n:g}" for n in ours.fireflies)])
            print(rows[-1], file=sys.stderr, flush=True)
    head = [
        "light; floor",
        "what is seen behind diffuse surfaces",
        "noise elsewhere",
        "on receivers",
        "mean elsewhere",
        "on receivers",
    ]
    text = (
        "Two furnished rooms with area lamps of 0.5 and 0.7 m (`sample_blends/two_rooms.py`), a shared floor and a "
        "mirror; the same with steel furniture; a room of glowing walls with a mirror for a floor and white boxes; a "
        "courtyard under a smooth sky. "
        f"{SAMPLES} samples without denoising, {SEEDS} seeds; means of {MANY} samples, divided by those of path "
        "tracing. Receivers are the surfaces that show probes. Fireflies: of the "
        f"{SIZE[0] * SIZE[1] * SEEDS} pixels those that are more than {BRIGHT:g} times as bright as the median of the "
        f"5 × 5 around, and are not in the picture of {MANY} samples; "
        "what was counted, not divided.\n\n" + table([*head, "fireflies elsewhere", "on receivers"], rows)
    )
    write_page("noise.md", "Noise, energy and fireflies", "python3 dev.py run benchmarks/noise.py", text)


if __name__ == "__main__":
    main()
