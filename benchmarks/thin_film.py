"""Floors under a film of oil that show a probe, against path tracing: errors, pictures, and what a frame costs.

python3 dev.py run benchmarks/thin_film.py
"""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from PIL import Image

from benchmarks.measure import ROOT, covered, relative_rmse, start, table, write_page
from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room, principled_node

SIZE = (144, 81)
FACE = 256
FLOORS = {
    "metal": {"Base Color": (0.9, 0.8, 0.6, 1.0), "Metallic": 1.0},
    "dielectric": {"Base Color": (0.02, 0.02, 0.02, 1.0), "Metallic": 0.0, "IOR": 1.5},
}
ROUGHNESSES = (0.0, 0.2)
FILM_IOR = 1.8
SHOWN_ROUGHNESS = 0.2
ROUNDS = 3


def film_room(floor: str, roughness: float) -> bpy.types.Scene:
    """The emissive room, its floor under a film of 100 nm to 800 nm, thicker along the room."""
    scene = emissive_room()
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    material = bpy.data.objects["Wall -Z"].data.materials[0]
    node, tree = principled_node(material), material.node_tree
    for name, value in {**FLOORS[floor], "Roughness": roughness, "Thin Film IOR": FILM_IOR}.items():
        node.inputs[name].default_value = value
    place, along, thickness = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "SeparateXYZ", "Math"))
    thickness.operation = "MULTIPLY_ADD"
    thickness.inputs[1].default_value, thickness.inputs[2].default_value = 700.0, 100.0
    tree.links.new(place.outputs["Generated"], along.inputs[0])
    tree.links.new(along.outputs["X"], thickness.inputs[0])
    tree.links.new(thickness.outputs[0], node.inputs["Thin Film Thickness"])
    probe = add_room_probe(EMISSIVE_ROOM, (0.0, 0.0, -0.35)).pcc_probe
    probe.samples, probe.denoise, probe.resolution, probe.contact_hardening = 4, False, FACE, True
    return scene


def without_film() -> None:
    """Take the film off the floor."""
    tree = bpy.data.objects["Wall -Z"].data.materials[0].node_tree
    node = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    tree.links.remove(node.inputs["Thin Film Thickness"].links[0])


def measure(floor: str, roughness: float, folder: Path) -> list[str]:
    """A row of the table; writes the pictures of one roughness into a folder."""
    scene = film_room(floor, roughness)
    mask = covered(scene, bpy.data.objects["Wall -Z"])

    def picture(name: str, samples: int, engine: Engine = Engine.CYCLES) -> np.ndarray:
        path = folder / f"{floor} {name}.png" if roughness == SHOWN_ROUGHNESS else None
        return render(scene, RenderSettings(engine, samples), shown=path).pixels

    truth = picture("traced", 128)
    own = picture("own", 2, Engine.EEVEE)
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    shown = picture("probe", 16), picture("eevee", 2, Engine.EEVEE)
    with_it = _seconds(scene)
    bpy.ops.pcc.remove()
    without_film()
    bpy.ops.pcc.inject()
    bare = render(scene, RenderSettings(samples=16)).pixels
    errors = [relative_rmse(found, truth, mask) for found in (*shown, bare, own)]
    return [floor, f"{roughness:g}", *(f"{error:.3f}" for error in errors), f"{with_it / _seconds(scene):.2f}"]


def _seconds(scene: bpy.types.Scene) -> float:
    """Of a frame in Cycles."""
    return median(render(scene, RenderSettings(samples=32)).seconds for _ in range(ROUNDS))


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), TemporaryDirectory() as folder:
        rows = [measure(floor, roughness, Path(folder)) for floor in FLOORS for roughness in ROUGHNESSES]
        ways = ("traced", "probe", "eevee", "own")
        sheet = Image.new("RGB", (SIZE[0] * len(ways), SIZE[1] * len(FLOORS)))
        for row, floor in enumerate(FLOORS):
            for column, way in enumerate(ways):
                sheet.paste(Image.open(Path(folder) / f"{floor} {way}.png"), (column * SIZE[0], row * SIZE[1]))
        sheet.save(ROOT / "docs" / "images" / "thin_film.png", optimize=True)
    head = ["floor", "roughness", "probe, Cycles", "probe, EEVEE", "probe without the film", "EEVEE's own", "frame"]
    text = (
        "![Path traced, the probe in Cycles and in EEVEE, EEVEE by itself](images/thin_film.png)\n\n"
        "*A film of 100 nm on the left of the room to 800 nm on its right (index 1.8) over a metal above and over a "
        f"dark dielectric below, roughness {SHOWN_ROUGHNESS:g}: path traced, the probe in Cycles, the probe in EEVEE, "
        "EEVEE without the probe.*\n\n"
        f"Relative RMSE against path tracing (128 samples) over the floor of the emissive room, {FACE} px faces, "
        "contact hardening; `frame`: seconds of a Cycles frame with the film over one without it.\n\n"
        + table(head, rows)
        + "\n\n"
        "The colours are those of Cycles from 5.0 on, which follows Belcour and Barla (2017): in a uniform white world "
        "every channel is within 0.03 of it, and within 0.015 from 20° above the surface on, from 100 nm to "
        "1 µm, film indices of 1.2 to 2, roughness 0 to 0.4, from straight above to 8° above the surface, over "
        "dielectrics, metals and glass (`tests/render/test_thin_film.py`); against the spectrum itself they are "
        "within 0.03, for bubbles 0.07 (`tests/core/test_thin_film.py`). Before 5.2 a film over a surface "
        "that is metal in part is shown over the rest alone, as Cycles has no room for both. "
        "Cycles 4.5 has other sensitivities, no film "
        "over metals, which the probe follows, and none below 30 nm: the probe is up to 0.03 from it, and 0.12 at 8° "
        "where what is under the film does not reflect by itself.\n\n"
        "EEVEE has no films of its own: it shows one where it shows a probe, and only there.\n\n"
        "What passes a film over glass is what it does not reflect; both sides of a solid or of a pane have one, and "
        "the inner side of a single surface sees it with the indices turned around, as in Cycles."
    )
    write_page("thin_film.md", "Thin films", "python3 dev.py run benchmarks/thin_film.py", text)


if __name__ == "__main__":
    main()
