"""What is lost where a probe shows an anisotropic surface as rough alike all around, against path tracing.

python3 dev.py run benchmarks/anisotropy.py
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import replace
from unittest.mock import patch

import bpy

from benchmarks.measure import covered, relative_rmse, render, start, table, write_page
from pcc_addon.core import plan
from pcc_addon.core.effects.kinds import KINDS
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room, principled_node

ANISOTROPIES = (0.0, 0.2, 0.4, 0.6, 0.8)


@contextmanager
def nothing_refused() -> Iterator[None]:
    """While this lasts, surfaces are served whatever their anisotropy."""
    with patch.object(plan, "KINDS", {name: replace(kind, refused={}) for name, kind in KINDS.items()}):
        yield


def measure(roughness: float, rotation: float) -> list[str]:
    """A row of the table."""
    scene = emissive_room()
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    floor = bpy.data.objects["Wall -Z"]
    inputs = principled_node(floor.data.materials[0]).inputs
    inputs["Roughness"].default_value, inputs["Anisotropic Rotation"].default_value = roughness, rotation
    probe = add_room_probe(EMISSIVE_ROOM, (0.0, 0.0, -0.35)).pcc_probe
    probe.samples, probe.denoise, probe.resolution, probe.contact_hardening = 16, False, 256, True
    mask = covered(scene, floor)
    bpy.ops.pcc.bake(scope="ALL")
    errors = []
    for anisotropic in ANISOTROPIES:
        bpy.ops.pcc.remove()
        inputs["Anisotropic"].default_value = anisotropic
        truth = render(scene, samples=256).pixels
        bpy.ops.pcc.inject()
        errors.append(relative_rmse(render(scene, samples=16).pixels, truth, mask))
    return [f"{roughness:g}", f"{360 * rotation:g}°", *(f"{error:.3f}" for error in errors)]


def main() -> None:
    start()
    with redirect_stdout(sys.stderr), nothing_refused():
        rows = [measure(roughness, rotation) for roughness in (0.2, 0.4) for rotation in (0.0, 0.25)]
    text = (
        "The floor of the emissive room as a metal of a Principled BSDF, shown with contact hardening, 256 px faces; "
        "relative RMSE against the path-traced picture (256 samples), by *Anisotropic*. The probe shows a lobe that is "
        "as wide all around as the geometric mean of the two widths, which anisotropy leaves as it is. Above 0.2, "
        "where the reflectance at 8° above the surface is off by more than 0.017, the add-on leaves a surface its own "
        "lobe; this page shows the rest too.\n\n"
        + table(["roughness", "rotation", *(f"{anisotropic:g}" for anisotropic in ANISOTROPIES)], rows)
    )
    write_page("anisotropy.md", "Anisotropy", "python3 dev.py run benchmarks/anisotropy.py", text)


if __name__ == "__main__":
    main()
