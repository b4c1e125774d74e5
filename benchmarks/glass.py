"""Glass that shows a probe, against the path tracer: a ball, an egg, a pane and a water surface in a marked room.

python3 dev.py run benchmarks/glass.py
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from mathutils import Vector
from PIL import Image

from benchmarks.measure import ROOT, relative_rmse, start, table, write_page
from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.core.probe import Engine
from sample_blends.scenes import Room, add_camera, add_wall, empty_scene, principled, principled_node

ROOM = Room((2.5, 2.0, 1.5), (40.0, -20.0, 1.5), 0.4)
PLACE = Vector(ROOM.centre) + Vector((-0.4, 0.3, -0.2))
COLORS = {
    "+X": (1.0, 0.3, 0.2),
    "-X": (0.2, 0.8, 0.9),
    "+Y": (0.3, 0.9, 0.3),
    "-Y": (0.9, 0.4, 0.9),
    "+Z": (1.0, 1.0, 1.0),
    "-Z": (0.8, 0.7, 0.3),
}
INDICES = (1.0, 1.1, 1.33, 1.5, 2.4)
FACE, SIZE = 256, (240, 180)


def ball() -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, segments=96, ring_count=48, location=PLACE)
    bpy.ops.object.shade_smooth()


def egg() -> None:
    ball()
    bpy.context.object.scale = (0.6, 0.8, 1.1)


def cube() -> None:
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=PLACE, rotation=(0.0, 0.0, 0.3))


def pane() -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=PLACE, rotation=(0.0, 0.0, 0.5))
    bpy.context.object.scale = (1.4, 0.02, 1.4)


def surface() -> None:
    bpy.ops.mesh.primitive_plane_add(size=1.4, location=PLACE, rotation=(math.pi / 2.0, 0.0, 0.5))


THINGS: dict[str, Callable[[], None]] = {
    "ball": ball,
    "egg": egg,
    "cube": cube,
    "pane": pane,
    "single surface": surface,
}


def checkered(name: str, color: tuple) -> bpy.types.Material:
    """A glowing wall of one-metre squares in world space."""
    material = principled(name, Base_Color=(0, 0, 0, 1), Specular_IOR_Level=0.0, Emission_Strength=1.0)
    tree = material.node_tree
    squares, place = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeNewGeometry")
    squares.inputs["Color1"].default_value = (*color, 1.0)
    squares.inputs["Color2"].default_value = (*(0.3 * c for c in color), 1.0)
    squares.inputs["Scale"].default_value = 1.0
    tree.links.new(place.outputs["Position"], squares.inputs["Vector"])
    tree.links.new(squares.outputs["Color"], principled_node(material).inputs["Emission Color"])
    return material


def build(thing: str, ior: float, roughness: float) -> bpy.types.Object:
    """A new file: the room, its probe and camera, and the thing; returns the thing."""
    empty_scene()
    for side, color in COLORS.items():
        add_wall(ROOM, side, checkered(side, color))
    THINGS[thing]()
    item = bpy.context.object
    glass = principled("Glass", Base_Color=(0.95, 0.95, 1, 1), Roughness=roughness, Transmission_Weight=1.0, IOR=ior)
    item.data.materials.append(glass)
    bpy.ops.pcc.probe_add(name="Room", location=ROOM.centre, half_extents=ROOM.half_extents, rotation=(0.0, 0.0, 0.4))
    settings = bpy.data.objects["Room"].pcc_probe
    settings.resolution, settings.samples, settings.denoise = FACE, 4, False
    settings.hidden_objects.add().object = item
    add_camera(PLACE + Vector((1.6, -1.0, 0.4)), PLACE, 35.0, *SIZE)
    scene = bpy.context.scene
    scene.cycles.transmission_bounces = scene.cycles.max_bounces = 16
    scene.cycles.sample_clamp_indirect = 0.0
    scene.view_settings.view_transform = "Standard"
    return item


def measure(thing: str, ior: float, roughness: float, shown: Path | None) -> list[str]:
    """A row of the table; writes the pictures into a folder where there is one."""
    item, scene = build(thing, ior, roughness), bpy.context.scene

    def picture(name: str, samples: int, engine: Engine = Engine.CYCLES) -> np.ndarray:
        path = shown / f"{thing} {name}.png" if shown else None
        return render(scene, RenderSettings(engine, samples), shown=path).pixels

    truth = picture("truth", 256)
    item.hide_render = True
    empty = render(scene, RenderSettings(Engine.CYCLES, 4)).pixels
    item.hide_render = False
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    boxed, eevee = picture("box", 16), picture("eevee", 4, Engine.EEVEE)
    bpy.data.objects["Room"].pcc_probe.correction = "NONE"
    bpy.ops.pcc.inject()
    classic = picture("classic", 16)
    mask = np.maximum(np.abs(truth - empty), np.abs(boxed - empty)).max(-1) > 0.02
    errors = [relative_rmse(found, truth, mask) for found in (classic, boxed, eevee)]
    return [thing, f"{ior:g}", f"{roughness:g}", *(f"{error:.3f}" for error in errors)]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), TemporaryDirectory() as folder:
        shown = Path(folder)
        cases = [(thing, 1.5, 0.0) for thing in THINGS]
        rows = [measure(*case, shown) for case in cases]
        names = [[shown / f"{thing} {kind}.png" for kind in ("truth", "box", "classic")] for thing in THINGS]
        sheet = Image.new("RGB", (SIZE[0] * len(names), SIZE[1] * 3))
        for column, files in enumerate(names):
            for row, file in enumerate(files):
                sheet.paste(Image.open(file), (column * SIZE[0], row * SIZE[1]))
        sheet.save(ROOT / "docs" / "images" / "glass.png")
        others = [(thing, ior, 0.0) for thing in ("ball", "pane", "single surface") for ior in INDICES if ior != 1.5]
        rough = [(thing, 1.5, roughness) for thing in ("ball", "pane") for roughness in (0.2, 0.4)]
        rows += [measure(*case, None) for case in (*others, *rough)]
    head = ["thing", "IOR", "roughness", "classic lookup", "box, Cycles", "box, EEVEE"]
    text = (
        "![Path traced, through the box, and uncorrected](images/glass.png)\n\n"
        f"*Above: path traced; middle: the probe through its box ({FACE} px faces); below: without correction.*"
        "\n\nRelative RMSE over the pixels that show the glass. A ball, an egg and a cube are looked through as an "
        "ellipsoid of their size, with the refraction at both sides; a pane straight on; a single surface, such as "
        "water's, bends once. What is mirrored inside, which makes most of a cube's picture, is not traced.\n\n"
        + table(head, rows)
    )
    write_page("glass.md", "Glass", "python3 dev.py run benchmarks/glass.py", text)


if __name__ == "__main__":
    main()
