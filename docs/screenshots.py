"""Takes the screenshots of the pages for artists, from a real Blender's window of 1600 × 900 pixels.

`PCC_BLENDER="blender" python3 dev.py run docs/screenshots.py [NAME…]` builds the zip, installs it for a new user,
has the scripts of `docs/shots` (all, or those named) drive a Blender with our sample scenes, and writes small pictures
into `docs/artists/images`. It needs what the window tests need: a screen, xdotool and ImageMagick.
"""

from __future__ import annotations

import atexit
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import bpy
from PIL import Image

import pcc_addon
from sample_blends import by_hand, moving, scenes, two_rooms
from tests.packaging.extension import build
from tests.window import real

HERE = Path(__file__).resolve().parent
IMAGES = HERE / "artists" / "images"
_GAP = 12  # pixels between the themes of a panel
_COLORS = 256
_PATIENCE = 1500.0  # seconds for a script, on a machine that draws in software


@dataclass(frozen=True)
class Shots:
    """Pictures that a script of `docs/shots` takes.

    Attributes:
        scene: what builds the scene that it begins with.
        keep: what becomes of its pictures, from their folder and what the script found.
        baked: whether the scene's probes are baked and injected before, by that Blender, for which they are fresh.
    """

    scene: Callable[[], object]
    keep: Callable[[Path, dict[str, object]], None]
    baked: bool = False


def main() -> int:
    chosen = sys.argv[1:] or list(SHOTS)
    unknown = sorted(set(chosen) - set(SHOTS))
    if unknown or not real.BLENDER:
        sys.exit(f"there are no shots {', '.join(unknown)}" if unknown else "PCC_BLENDER names no real Blender")
    pcc_addon.register()
    atexit.register(pcc_addon.unregister)  # Blender 4.5 as a module crashes at exit where types are left registered
    IMAGES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        os.environ["BLENDER_USER_RESOURCES"] = str(Path(place) / "user")  # of a new user
        real.install(build(Path(place), pages=False), Path(place))
        for name in chosen:
            folder = Path(place) / name
            folder.mkdir()
            SHOTS[name].scene()
            bpy.ops.wm.save_as_mainfile(filepath=str(folder / "room.blend"))
            if SHOTS[name].baked:
                real.run("room.blend", "--command", "pcc", "bake", "--inject", "--save", cwd=folder, seconds=_PATIENCE)
            found = real.in_window(folder, HERE / "shots" / f"{name}.py", "room.blend", seconds=_PATIENCE)
            SHOTS[name].keep(folder, found)
            print(f"{name}: done", flush=True)
    return 0


def furnished() -> None:
    """Two furnished rooms with a doorway and a probe each."""
    two_rooms.two_rooms(0.12, doorway=True)
    for name in ("Lounge", "Study"):
        probe = bpy.data.objects[name]
        probe.pcc_probe.resolution, probe.pcc_probe.samples = 128, 16


def gallery() -> None:
    """The gallery without a probe; new probes are for a preview."""
    scenes.gallery()
    bpy.data.objects.remove(bpy.data.objects["Gallery Probe"])
    bpy.context.scene.pcc.preset = "PREVIEW"


def keep_panels(folder: Path, found: dict[str, object]) -> None:
    """Both themes of each panel side by side, at the width of the panel."""
    for dark in sorted(folder.glob("*, dark.png")):
        name = dark.name.removesuffix(", dark.png")
        pair = [Image.open(folder / f"{name}, {theme}.png").convert("RGB") for theme in ("dark", "light")]
        sheet = Image.new("RGB", (sum(one.width for one in pair) + _GAP, max(one.height for one in pair)), "#808080")
        sheet.paste(pair[0], (0, 0))
        sheet.paste(pair[1], (pair[0].width + _GAP, 0))
        keep(sheet, f"panel_{name}")


def keep_crops(folder: Path, found: dict[str, object]) -> None:
    """Screenshots, each cropped to what it is about: left, top, right and bottom in pixels."""
    for name, box in found["crops"].items():
        keep(Image.open(folder / f"{name}.png").convert("RGB").crop(box), name)


def keep(picture: Image.Image, name: str) -> None:
    """Write a picture with few colours, which is small."""
    beside = IMAGES / f"{name}.new"
    picture.quantize(_COLORS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(beside, "PNG", optimize=True)
    os.replace(beside, IMAGES / f"{name}.png")


SHOTS = {
    "panels": Shots(furnished, keep_panels, baked=True),
    "first_probe": Shots(gallery, keep_crops),
    "several": Shots(furnished, keep_crops),
    "by_hand": Shots(partial(by_hand.by_hand, 64), keep_crops),
    "animation": Shots(moving.moving, keep_crops),
}

if __name__ == "__main__":
    raise SystemExit(main())
