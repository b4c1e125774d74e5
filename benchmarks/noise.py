"""Noise and energy of materials that show probes, against path tracing at equal samples, in rooms with small lamps.

python3 dev.py run benchmarks/noise.py
"""

from __future__ import annotations

import bpy
import numpy as np

from benchmarks.measure import render, start, table, write_page
from pcc_addon.blender import marks
from sample_blends.two_rooms import two_rooms

SAMPLES, MANY = 32, 512
GLOSSY = {"Tiles", "Lounge Mirror"}


def receivers(scene: bpy.types.Scene) -> np.ndarray:
    """(h, w) mask of the pixels that show the floor or a mirror."""
    override = bpy.data.materials.new("Mask")
    if override.node_tree is None:
        override.use_nodes = True
    nodes = override.node_tree.nodes
    nodes.clear()
    info, glow, output = (
        nodes.new(kind) for kind in ("ShaderNodeObjectInfo", "ShaderNodeEmission", "ShaderNodeOutputMaterial")
    )
    override.node_tree.links.new(glow.outputs[0], output.inputs["Surface"])
    for item in scene.objects:
        item.pass_index = int(any(slot.material and slot.material.name in GLOSSY for slot in item.material_slots))
    override.node_tree.links.new(info.outputs["Object Index"], glow.inputs["Strength"])
    scene.view_layers[0].material_override = override
    mask = render(scene, samples=4).pixels[..., 0] > 0.5
    scene.view_layers[0].material_override = None
    bpy.data.materials.remove(override)
    return mask


def measure(scene: bpy.types.Scene, mask: np.ndarray) -> tuple[float, float, float, float]:
    """RMS noise of one render outside and inside the mask, and the converged mean outside and inside."""
    pair = []
    for seed in (1, 2):
        scene.cycles.seed = seed
        pair.append(render(scene, samples=SAMPLES).pixels)
    scene.cycles.seed = 3
    truth = render(scene, samples=MANY).pixels
    noise = np.square(pair[0] - pair[1]) / 2.0
    noises = [float(np.sqrt(noise[part].mean())) for part in (~mask, mask)]
    return noises[0], noises[1], float(truth[~mask].mean()), float(truth[mask].mean())


def main() -> None:
    start()
    rows = []
    for name, roughness in (("tiles, roughness 0.04 … 0.16", None), ("floor of roughness 0.12", 0.12)):
        scene = two_rooms(roughness)
        scene.render.resolution_x, scene.render.resolution_y = 160, 90
        for probe in (o.pcc_probe for o in scene.objects if o.pcc_probe.is_probe):
            probe.resolution, probe.samples = 256, 32
        mask = receivers(scene)
        path = measure(scene, mask)
        bpy.ops.pcc.bake(scope="ALL")
        bpy.ops.pcc.inject()
        shown = measure(scene, mask)
        for node in (n for m in bpy.data.materials for n in m.node_tree.nodes):
            if node.bl_idname == "ShaderNodeMixShader" and marks.role(node) == "glow":
                node.mute = True
        everywhere = measure(scene, mask)
        for what, found in (("all but diffuse rays (as injected)", shown), ("all rays", everywhere)):
            rows.append([name, what, *(f"{a / b:.3f}" for a, b in zip(found, path, strict=True))])
    text = (
        f"Two furnished rooms with area lamps of 0.5 and 0.7 m (`sample_blends/two_rooms.py`), a shared floor and a "
        f"mirror; {SAMPLES} samples without denoising, two seeds; means of {MANY} samples. Everything is divided by "
        "the same of path tracing. Receivers are the floor and the mirror; rays that left a diffuse surface meet their "
        "own lobe, so that what is lit by them is lit as without probes.\n\n"
        + table(
            ["floor", "who sees the probe", "noise elsewhere", "on receivers", "mean elsewhere", "on receivers"], rows
        )
    )
    write_page("noise.md", "Noise and energy", "python3 dev.py run benchmarks/noise.py", text)


if __name__ == "__main__":
    main()
