"""Write the sample scenes as .blend files beside this script: `python3 dev.py samples`."""

from __future__ import annotations

import atexit
import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import bpy

import pcc_addon

from . import any_cubemap, interior, moving, scenes

FOLDER = Path(__file__).resolve().parent


def main() -> None:
    pcc_addon.register()
    atexit.register(pcc_addon.unregister)  # Blender 4.5 as a module crashes at exit where types are left registered
    _save("emissive_room.blend", _emissive_room_with_probe)
    _save("gallery.blend", scenes.gallery)
    any_cubemap.write_cross(any_cubemap.PICTURE, 64)
    _save("any_cubemap.blend", any_cubemap.any_cubemap)
    _save("interior.blend", partial(interior.interior, 96, 48))
    _save("moving.blend", moving.moving)


def _emissive_room_with_probe() -> None:
    scenes.emissive_room()
    scenes.add_room_probe(scenes.EMISSIVE_ROOM, (0.0, 0.0, -0.35))


def _save(name: str, build: Callable[[], object]) -> None:
    build()
    path = FOLDER / name
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


if __name__ == "__main__":
    main()
