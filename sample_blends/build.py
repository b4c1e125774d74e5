"""Write the sample scenes as .blend files beside this script: `python3 dev.py samples`."""

from __future__ import annotations

import atexit
import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import bpy

import pcc_addon

from . import any_cubemap, by_hand, glass, interior, moving, scenes

FOLDER = Path(__file__).resolve().parent


def main() -> None:
    pcc_addon.register()
    atexit.register(pcc_addon.unregister)  # Blender 4.5 as a module crashes at exit where types are left registered
    any_cubemap.write_cross(any_cubemap.PICTURE, 64)
    for name, build in SAMPLES.items():
        _save(name, build)


def _emissive_room_with_probe() -> None:
    scenes.emissive_room()
    scenes.add_room_probe(scenes.EMISSIVE_ROOM, (0.0, 0.0, -0.35))


# Baked pictures, of eight levels each, are packed where windows and nodes by hand need a bake: small ones.
SAMPLES: dict[str, Callable[[], object]] = {
    "emissive_room.blend": _emissive_room_with_probe,
    "gallery.blend": scenes.gallery,
    "any_cubemap.blend": any_cubemap.any_cubemap,
    "by_hand.blend": partial(by_hand.by_hand, 32),
    "glass.blend": glass.glass,
    "interior.blend": partial(interior.interior, 40, 64),
    "moving.blend": moving.moving,
}


def _save(name: str, build: Callable[[], object]) -> None:
    build()
    path = FOLDER / name
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


if __name__ == "__main__":
    main()
