"""Brushed metal that shows a probe by several looks along its lobe, by one or by none, against path tracing.

python3 dev.py run benchmarks/anisotropy.py
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import replace
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from unittest.mock import patch

import bpy
import numpy as np
from mathutils import Vector
from PIL import Image

from benchmarks.measure import ROOT, covered, relative_rmse, start, table, write_page
from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.core.effects import anisotropy, surface
from pcc_addon.core.effects.anisotropy import LOOKS, Anisotropy, Looks
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive, emissive_room, principled, principled_node

SIZE = (104, 58)
ROUNDS = 3
FEW = Looks(
    LOOKS.ratios,
    (0.227, 0.372, 0.516, 0.666, 0.827),
    ((0.473, 0.587, 0.664, 0.715, 0.741),),
    ((0.382, 0.440, 0.515, 0.617, 0.766), (0.309, 0.280, 0.243, 0.191, 0.117)),
)
MANY = Looks(
    LOOKS.ratios,
    (0.146, 0.293, 0.451, 0.622, 0.808),
    ((0.255, 0.358, 0.434, 0.412, 0.270), (0.534, 0.773, 0.986, 1.104, 1.030), (0.870, 1.321, 1.779, 2.128, 2.269)),
    (
        (0.182, 0.241, 0.322, 0.372, 0.301),
        (0.169, 0.196, 0.212, 0.223, 0.292),
        (0.139, 0.118, 0.088, 0.069, 0.044),
        (0.101, 0.065, 0.039, 0.022, 0.013),
    ),
)
WAYS = ("none", "3 looks", "5 looks", "7 looks")


@contextmanager
def shown_by(way: str) -> Iterator[None]:
    """While this lasts, anisotropic surfaces are looked up so."""
    surface.surface_formula.cache_clear()
    with _patched(way):
        yield
    surface.surface_formula.cache_clear()


@contextmanager
def _patched(way: str) -> Iterator[None]:
    if way == "none":
        plain = {
            name: replace(
                kind, effects=tuple(e for e in kind.effects if getattr(e, "__self__", None) is not Anisotropy)
            )
            for name, kind in surface.KINDS.items()
        }
        with patch.object(surface, "KINDS", plain):
            yield
    else:
        looks = {"3 looks": FEW, "5 looks": LOOKS, "7 looks": MANY}[way]
        with patch.object(anisotropy, "LOOKS", looks), patch.object(surface, "look", anisotropy.look.__wrapped__):
            yield


def build(thing: str, lamp: bool) -> tuple[bpy.types.Scene, bpy.types.Object]:
    """The emissive room, its walls glowing or dark but for a lamp of 0.7 m, and what is brushed in it."""
    scene = emissive_room()
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    item = bpy.data.objects["Wall -Z"]
    if lamp:
        for wall in (o for o in scene.objects if o.name.startswith("Wall") and o != item):
            grey, emission = emissive(f"Grey {wall.name}")
            emission.inputs["Color"].default_value = (0.2, 0.2, 0.22, 1.0)
            wall.data.materials[0] = grey
        bpy.ops.mesh.primitive_plane_add(size=0.7, location=EMISSIVE_ROOM.world(1.0, 0.8, 1.0) - Vector((0, 0, 0.01)))
        white, emission = emissive("Lamp")
        emission.inputs["Strength"].default_value = 20.0
        bpy.context.object.data.materials.append(white)
        bpy.context.object.location = EMISSIVE_ROOM.world(1.0, 0.8, EMISSIVE_ROOM.half_extents[2] - 0.01)
    probe = add_room_probe(EMISSIVE_ROOM, (0.0, 0.0, -0.35))
    settings = probe.pcc_probe
    settings.samples, settings.denoise, settings.resolution, settings.contact_hardening = 4, False, 128, True
    if thing == "ball":
        item.data.materials[0] = principled("Matt", Base_Color=(0.2, 0.2, 0.2, 1.0), Specular_IOR_Level=0.0)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.9, segments=64, ring_count=32)
        item = bpy.context.object
        item.location = EMISSIVE_ROOM.world(-0.6, -0.4, -EMISSIVE_ROOM.half_extents[2] + 0.9)
        bpy.ops.object.shade_smooth()
        item.data.materials.append(principled("Brushed", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0))
        settings.hidden_objects.add().object = item
    return scene, item


def measure(thing: str, lamp: bool, roughness: float, rotation: float, amount: float, folder: Path) -> list[str]:
    """A row of the table; writes the pictures of some cases into a folder."""
    scene, item = build(thing, lamp)
    inputs = principled_node(item.data.materials[0]).inputs
    inputs["Roughness"].default_value, inputs["Anisotropic Rotation"].default_value = roughness, rotation
    inputs["Anisotropic"].default_value = amount
    picture_of = f"{thing} {lamp}" if (roughness, rotation, amount) == SHOWN else ""

    def picture(name: str, samples: int, engine: Engine = Engine.CYCLES) -> np.ndarray:
        path = folder / f"{picture_of} {name}.png" if picture_of else None
        return render(scene, RenderSettings(engine, samples), shown=path).pixels

    item.hide_render = True
    empty = render(scene, RenderSettings(samples=4)).pixels
    item.hide_render = False
    truth = picture("traced", 96)
    mask = np.abs(truth - empty).max(-1) > 0.02 if thing == "ball" else covered(scene, item)
    bpy.ops.pcc.bake(scope="ALL")
    errors = []
    for way in WAYS:
        with shown_by(way):
            bpy.ops.pcc.inject()
            errors.append(relative_rmse(picture(way, 16), truth, mask))
            if way == "5 looks":
                eevee = relative_rmse(picture("eevee", 2, Engine.EEVEE), truth, mask) if picture_of else None
            bpy.ops.pcc.remove()
    place = f"{thing}, {'lamp' if lamp else 'glowing walls'}"
    head = [place, f"{roughness:g}", f"{360 * rotation:g}°", f"{amount:g}"]
    return [*head, *(f"{error:.3f}" for error in errors), "" if eevee is None else f"{eevee:.3f}"]


def cost() -> list[list[str]]:
    """Frames that show nothing but the floor, over those of a lobe that is round."""
    scene, floor = build("floor", lamp=False)
    inputs = principled_node(floor.data.materials[0]).inputs
    inputs["Roughness"].default_value, inputs["Anisotropic"].default_value = 0.3, 0.8
    bpy.ops.pcc.bake(scope="ALL")
    seconds: dict[tuple[str, Engine], list[float]] = {}
    for _ in range(ROUNDS + 1):
        for way in WAYS:
            with shown_by(way):
                bpy.ops.pcc.inject()
                for engine, samples in ((Engine.CYCLES, 32), (Engine.EEVEE, 2)):
                    render(scene, RenderSettings(engine, 1))
                    taken = render(scene, RenderSettings(engine, samples)).seconds
                    seconds.setdefault((way, engine), []).append(taken)
                bpy.ops.pcc.remove()
    middle = {key: median(values[1:]) for key, values in seconds.items()}
    return [[e.value.title(), *(f"{middle[way, e] / middle['none', e]:.2f}" for way in WAYS)] for e in Engine]


SHOWN = (0.3, 0.0, 0.9)
CASES = [(0.3, 0.0, 0.5), (0.3, 0.25, 0.2), (0.3, 0.25, 0.5), (0.3, 0.25, 0.9)]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), TemporaryDirectory() as name:
        folder = Path(name)
        rows = [measure("floor", lamp, *case, folder) for lamp in (False, True) for case in CASES]
        kinds = [(thing, lamp) for thing in ("floor", "ball") for lamp in (False, True)]
        rows += [measure(*kind, *SHOWN, folder) for kind in kinds]
        shown = ("traced", "none", "5 looks", "eevee")
        sheet = Image.new("RGB", (SIZE[0] * len(shown), SIZE[1] * len(kinds)))
        for row, (thing, lamp) in enumerate(kinds):
            for column, way in enumerate(shown):
                sheet.paste(Image.open(folder / f"{thing} {lamp} {way}.png"), (column * SIZE[0], row * SIZE[1]))
        sheet.save(ROOT / "docs" / "images" / "anisotropy.png", optimize=True)
        costs = cost()
    head = ["scene", "roughness", "rotation", "anisotropic", *WAYS, "5 looks, EEVEE"]
    text = (
        "![Path traced, shown as round, by five looks in Cycles and in EEVEE](images/anisotropy.png)\n\n"
        "*A floor and a ball of brushed metal (roughness 0.3, Anisotropic 0.9) between glowing walls and under a lamp: "
        "path traced, shown as rough alike all around, by five looks in Cycles and in EEVEE.*\n\n"
        "Relative RMSE against path tracing (96 samples), 128 px faces, contact hardening. `none`: a round lobe of "
        "the geometric mean of both widths; `looks`: "
        "round lobes about as wide as the narrow width, "
        "at places along the wide axis with shares that were "
        "fitted to the lobe, each weighted by how much of its facets the view sees. The add-on does five above "
        "an anisotropy of 0.2; up to that it shows none.\n\n"
        + table(head, rows)
        + "\n\nFrames that show nothing but a floor of roughness 0.3, over those of a round lobe (medians of "
        f"{ROUNDS}):\n\n"
        + table(["engine", *WAYS], costs)
        + "\n\nThe figures of a ball are over all pixels that it changes, its shade on the floor too, which glowing "
        "walls do not light in EEVEE. Two samples of EEVEE cost little beside the rest of its frame here."
        + "\n\nWhere no tangent is linked it is that of the Geometry node, which both engines take around the object's "
        "Z axis by its generated coordinates. EEVEE by itself draws no anisotropy; with a probe it shows what Cycles "
        "shows. A texture on *Anisotropic* itself keeps the surface's own lobe; roughness, rotation and tangent may "
        "vary. What is seen through glass is as wide all around, as in Cycles."
    )
    write_page("anisotropy.md", "Anisotropy", "python3 dev.py run benchmarks/anisotropy.py", text)


if __name__ == "__main__":
    main()
