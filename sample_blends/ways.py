"""One view rendered with each correction of a probe and path-traced; and the labelled picture of them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from pcc_addon.blender import rendering

_GAP = 4  # pixels between pictures


@dataclass(frozen=True)
class Rendered:
    """One picture: its label, its PNG and how long it took."""

    label: str
    path: Path
    seconds: float


def render(scene: bpy.types.Scene, label: str, path: Path) -> Rendered:
    """Render a scene's camera into a PNG."""
    return Rendered(label, path, rendering.render(scene, shown=path).seconds)


_CORRECTIONS = {"NONE": "Probe, classic lookup", "BOX": "Probe, box", "RELIEF": "Probe, box with relief"}


def all_ways(scene: bpy.types.Scene, probe: bpy.types.Object, folder: Path) -> list[Rendered]:
    """Render a scene with each correction of its probe, whose bake has relief, and path-traced.

    Afterwards the materials are as before the injection.
    """
    folder.mkdir(parents=True, exist_ok=True)
    pictures = []
    for correction, label in _CORRECTIONS.items():
        probe.pcc_probe.correction = correction
        bpy.ops.pcc.inject()  # each shader only as large as it need be
        pictures.append(render(scene, label, folder / f"{correction.lower()}.png"))
    bpy.ops.pcc.remove()
    return [*pictures, render(scene, "Path-traced reflections", folder / "path_traced.png")]


def side_by_side(pictures: Sequence[Rendered], path: Path, columns: int = 0) -> None:
    """The pictures in rows of so many, in one row by default, each under its label."""
    from PIL import Image, ImageDraw, ImageFont

    images = [Image.open(picture.path).convert("RGB") for picture in pictures]
    width, height = images[0].size
    head = max(28, height // 11)
    columns = columns or len(images)
    rows = -(-len(images) // columns)
    sheet = Image.new("RGB", (columns * (width + _GAP) - _GAP, rows * (height + head)), "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=head * 0.55)
    for k, (picture, image) in enumerate(zip(pictures, images, strict=True)):
        x, y = k % columns * (width + _GAP), k // columns * (height + head)
        sheet.paste(image, (x, y + head))
        draw.text((x + 8, y + head * 0.18), f"{picture.label}  ({picture.seconds:.1f} s)", fill="black", font=font)
    sheet.save(path)
