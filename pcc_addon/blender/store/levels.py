"""A probe's pictures: storing a bake, making further levels from it, keeping the probe's group in step."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ...core import sidecar
from ...core.errors import BakeError
from ...core.pictures import NEARNESS, PictureKey, PictureKind
from ...core.prefilter import prefilter
from ...core.radiance import as_half
from ...core.workplace import real
from ..properties import PCC_BakedLevel
from ..read.holders import Holders
from ..read.probes import bake_record, check_own
from . import pictures, sequences
from .keeping import folder_for_parts, linked, rename_pictures, rung, take_in


def bake_folder(scene: bpy.types.Scene, blend: str | None = None) -> Path | None:
    """Where a scene's pictures go: the chosen folder, or one beside the .blend; None: packed into the unsaved file."""
    blend = blend or bpy.data.filepath
    chosen = scene.pcc.folder
    if chosen and (blend or not chosen.startswith("//")):
        start = str(Path(blend).parent) if blend else None
        return real(bpy.path.abspath(chosen, start=start))
    if not blend:
        return None
    return real(blend).with_suffix(".pcc")


def store(
    probe: bpy.types.Object,
    record: sidecar.Sidecar,
    levels: dict[float, np.ndarray],
    folder: Path | None,
    holders: Holders | None = None,
    *,
    durable: bool = False,
) -> None:
    """Write a probe's pictures and sidecar aside and move them into place; its shader is for the caller to refresh.

    Args:
        probe: the probe object; its `uid` is set.
        record: of the bake; its levels are filled in here.
        levels: pictures (h, 2h, 3) by roughness, with 0 for the capture itself, and `NEARNESS` for how near things are.
        folder: where to; None packs the pictures into the .blend.
        holders: who shows which pictures, where that was asked before.
        durable: whether to wait until the disk has them.

    Raises:
        BakeError: the folder or a file cannot be written; what was there before is untouched.
    """
    holders = holders or Holders()
    stem = sidecar.file_stem(probe.name, record.uid)
    half = record.half_float
    levels = {r: as_half(picture) if half and r != NEARNESS else picture for r, picture in levels.items()}
    radiances = sorted(roughness for roughness in levels if roughness != NEARNESS)
    described = tuple(
        _described(stem, PictureKey(PictureKind.RADIANCE, k), r, levels[r]) for k, r in enumerate(radiances)
    )
    if NEARNESS in levels:
        described += (_described(stem, PictureKey(PictureKind.NEARNESS, 0), NEARNESS, levels[NEARNESS]),)
    with ExitStack() as stack:
        stack.enter_context(pictures.desk())
        parts = folder_for_parts(stack, folder)
        for level in described:
            coarse = half and level.key.kind is PictureKind.RADIANCE
            pictures.write_file(parts / level.file, levels[level.roughness], half=coarse)
        described = tuple(replace(level, size=(parts / level.file).stat().st_size) for level in described)
        take_in(probe, replace(record, levels=described), parts, folder, holders, durable=durable)


def _described(stem: str, key: PictureKey, roughness: float, picture: np.ndarray) -> sidecar.Level:
    digest = sidecar.digest_of(picture)
    height, width = picture.shape[:2]
    return sidecar.Level(key, roughness, sidecar.level_file(stem, key, digest), width, height, 0, digest)


def ensure_levels(
    probe: bpy.types.Object,
    roughnesses: Iterable[float],
    folder: Path | None,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Make the levels that are not there yet from the probe's capture, without rendering.

    Raises:
        PccError: the probe was never baked or cannot keep pictures, its capture cannot be read, or a level cannot be
            written.
    """
    record = bake_record(probe)
    if record is None:
        raise BakeError(f"probe '{probe.name}' has no bake; bake it first")
    rename_pictures(probe)
    have = {round(level.roughness, 4): level.image for level in probe.pcc_probe.levels}
    missing = sorted(set(roughnesses) - set(have))
    if not missing:
        return
    check_own(probe)
    if record.moments:
        sequences.add_levels(probe, record, missing, folder)
        return
    pictures_now = {r: pictures.read_pixels(have[r]) for r in have if have[r]}
    if 0.0 not in pictures_now:
        raise BakeError(f"probe '{probe.name}': its capture is missing from the file; bake it again")
    for roughness in missing:
        pictures_now[roughness] = prefilter(pictures_now[0.0], roughness, progress)
    store(probe, record, pictures_now, folder)


def find_again(probe: bpy.types.Object, folder: Path | None) -> None:
    """Load the pictures that a probe has no more, as undo took them; blurred ones whose files are gone it forgets.

    Args:
        probe: the probe object.
        folder: where its pictures go.

    Raises:
        PccError: its record is damaged.
    """
    settings, record = probe.pcc_probe, bake_record(probe)
    lost = {rung(level.roughness) for level in settings.levels if level.image is None}
    if record is None or not lost:
        return
    files = [level for level in record.levels if rung(level.roughness) in lost]
    there = [level for level in files if folder is not None and (folder / level.file).is_file()]
    with pictures.desk():
        found = {rung(level): image for level, image in linked(folder, there, {}, probe).items()} if there else {}
    needed = {rung(0.0), rung(NEARNESS)}  # status tells of these
    for index in reversed(range(len(settings.levels))):
        level = settings.levels[index]
        key = rung(level.roughness)
        if level.image is None and key in found:
            level.image = found[key]
        elif level.image is None and key not in needed:
            settings.levels.remove(index)
    gone = (lost - set(found)) - needed
    kept = tuple(level for level in record.levels if rung(level.roughness) not in gone)
    if len(kept) < len(record.levels):
        settings.bake_record = replace(record, levels=kept).to_json()


def check_folder(folder: Path | None) -> None:
    """Make sure that a bake can be stored, before hours of rendering.

    Raises:
        BakeError: nothing can be written there.
    """
    with ExitStack() as stack:
        folder_for_parts(stack, folder)


def picture_rows(probe: bpy.types.Object, level: PCC_BakedLevel) -> int:
    """The rows of a probe's picture, which is read only where the bake's record does not know it.

    Raises:
        BakeError: it is missing or cannot be read, or has no equirectangular shape, or the record is damaged.
    """
    record = bake_record(probe)
    for known in record.levels if record is not None else ():
        if known.size and rung(known.roughness) == rung(level.roughness) and level.image:
            return known.height if not _fault_of(level.image, known) else pictures.check_pixels(probe.name, level.image)
    return pictures.check_pixels(probe.name, level.image)


def faulty_picture(probe: bpy.types.Object, record: sidecar.Sidecar) -> str:
    """What is wrong with the first picture of a probe that is not what its record says; empty: nothing."""
    images = {round(level.roughness, 4): level.image for level in probe.pcc_probe.levels}
    if not record.levels:
        return "its record names no pictures"
    for level in record.levels:
        image = images.get(round(level.roughness, 4))
        if image is None:
            what = "distances" if level.key.kind is PictureKind.NEARNESS else f"roughness {level.roughness:.3g}"
            return f"its picture of {what} is missing from the file"
        fault = _fault_of(image, level)
        if fault:
            return fault
    return ""


def _fault_of(image: bpy.types.Image, level: sidecar.Level) -> str:
    if image.packed_file:
        torn = level.size and image.packed_file.size != level.size
        return f"its packed picture '{image.name}' is not the one that was baked" if torn else ""
    path = Path(bpy.path.abspath(image.filepath, library=image.library))
    if level.key.number > 0 and sidecar.file_family(path.name) == sidecar.file_family(level.file):
        path = path.with_name(level.file)
    if not path.is_file():
        return f"its picture '{path}' is missing"
    if path.name != level.file:
        return f"its picture '{path}' is that of another bake"
    if level.size and path.stat().st_size != level.size:
        return f"its picture '{path}' is not the one that was baked: it has another size"
    if not level.size and not pictures.is_whole(path, level.width, level.height):
        return f"its picture '{path}' cannot be read"
    return ""
