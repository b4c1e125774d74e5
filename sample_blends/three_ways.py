"""One view rendered without parallax correction, with it, and path-traced; and the labelled picture of the three."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from pcc_addon.blender import rendering


@dataclass(frozen=True)
class Rendered:
    """One picture: its label, its PNG and how long it took."""

    label: str
    path: Path
    seconds: float


def render(scene: bpy.types.Scene, label: str, path: Path) -> Rendered:
    """Render a scene's camera into a PNG."""
    return Rendered(label, path, rendering.render(scene, shown=path).seconds)


def three_ways(scene: bpy.types.Scene, probe: bpy.types.Object, folder: Path) -> list[Rendered]:
    """Render classic, corrected and path-traced pictures of a scene whose probe is baked and injected.

    Afterwards the materials are as before the injection.
    """
    folder.mkdir(parents=True, exist_ok=True)
    probe.pcc_probe.correction = "NONE"
    bpy.ops.pcc.inject()  # each shader only as large as it need be
    classic = render(scene, "Probe, classic lookup", folder / "classic.png")
    probe.pcc_probe.correction = "BOX"
    bpy.ops.pcc.inject()
    corrected = render(scene, "Probe, parallax-corrected", folder / "corrected.png")
    bpy.ops.pcc.remove()
    truth = render(scene, "Path-traced reflections", folder / "path_traced.png")
    return [classic, corrected, truth]


def side_by_side(pictures: Sequence[Rendered], path: Path) -> None:
    """The pictures in a row, each under its label."""
    from PIL import Image, ImageDraw, ImageFont

    images = [Image.open(picture.path).convert("RGB") for picture in pictures]
    width, height = images[0].size
    head = max(28, height // 11)
    sheet = Image.new("RGB", (width * len(images) + 4 * (len(images) - 1), height + head), "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=head * 0.55)
    for k, (picture, image) in enumerate(zip(pictures, images, strict=True)):
        x = k * (width + 4)
        sheet.paste(image, (x, head))
        draw.text((x + 8, head * 0.18), f"{picture.label}  ({picture.seconds:.1f} s)", fill="black", font=font)
    sheet.save(path)
