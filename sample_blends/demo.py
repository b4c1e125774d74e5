"""`python3 dev.py demo`: bake the gallery, render its floor four ways, say what was made and how long it took."""

from __future__ import annotations

import argparse
import atexit
import time
from pathlib import Path

import bpy

import pcc_addon
from pcc_addon.quiet import quiet_blender

from . import scenes
from .ways import all_ways, side_by_side

ROOT = Path(__file__).resolve().parent.parent


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "demo", help="where the pictures go")
    options = parser.parse_args()
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    pcc_addon.register()
    atexit.register(pcc_addon.unregister)  # Blender 4.5 as a module crashes at exit where types are left registered
    scene = scenes.gallery()
    with quiet_blender():
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "gallery.blend"))
    probe = bpy.data.objects["Gallery Probe"]
    probe.pcc_probe.resolution, probe.pcc_probe.samples, probe.pcc_probe.correction = 384, 24, "RELIEF"
    say(f"Baking '{probe.name}': six faces of {probe.pcc_probe.resolution} px …")
    with quiet_blender():
        baking = time.perf_counter()
        bpy.ops.pcc.bake(scope="ALL")
        bpy.ops.pcc.inject()
        baking = time.perf_counter() - baking
    say(f"  baked and injected in {baking:.1f} s")
    say("Rendering the floor four ways …")
    with quiet_blender():
        scene.cycles.samples, scene.cycles.use_denoising = 32, True
        pictures = all_ways(scene, probe, folder)
        bpy.ops.pcc.inject()
        bpy.ops.wm.save_mainfile()
    for picture in pictures:
        say(f"  {picture.label}: {picture.seconds:.1f} s")
    sheet = folder / "demo.png"
    side_by_side(pictures, sheet, columns=2)
    say(f"{sheet}  (all of it took {time.perf_counter() - start:.0f} s)")
    return 0


def say(text: str) -> None:
    print(text, flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
