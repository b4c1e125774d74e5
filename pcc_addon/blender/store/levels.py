"""A probe's pictures: storing a bake, making further levels from it, keeping the probe's group in step."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ...core import sidecar
from ...core.errors import BakeError
from ...core.pictures import PictureKey, PictureKind
from ...core.prefilter import prefilter
from ...core.workplace import UNFINISHED, temporary_folder
from ..read.probes import bake_record, check_own
from . import leftovers, pictures


def bake_folder(scene: bpy.types.Scene, blend: str | None = None) -> Path | None:
    """Where a scene's pictures go: the chosen folder, or one beside the .blend; None: packed into the unsaved file."""
    blend = blend or bpy.data.filepath
    chosen = scene.pcc.folder
    if chosen and (blend or not chosen.startswith("//")):
        start = str(Path(blend).parent) if blend else None
        return Path(bpy.path.abspath(chosen, start=start)).resolve()
    if not blend:
        return None
    return Path(blend).resolve().with_suffix(".pcc")


def store(
    probe: bpy.types.Object,
    record: sidecar.Sidecar,
    levels: dict[float, np.ndarray],
    folder: Path | None,
) -> None:
    """Write a probe's pictures and sidecar aside and move them into place; its shader is for the caller to refresh.

    Args:
        probe: the probe object; its `uid` is set.
        record: of the bake; its levels are filled in here.
        levels: pictures (h, 2h, 3) by roughness, with 0 for the capture itself.
        folder: where to; None packs the pictures into the .blend.

    Raises:
        BakeError: the folder or a file cannot be written; what was there before is untouched.
    """
    stem = sidecar.file_stem(probe.name, record.uid)
    described = tuple(_described(stem, k, r, levels[r]) for k, r in enumerate(sorted(levels)))
    with ExitStack() as stack:
        stack.enter_context(pictures.desk())
        parts = _folder_for_parts(stack, folder)
        for level in described:
            pictures.write_file(parts / level.file, levels[level.roughness])
        described = tuple(replace(level, size=(parts / level.file).stat().st_size) for level in described)
        record = replace(record, levels=described)
        own = _own_images(probe)
        if folder is None:
            images = {
                level.roughness: _packed(parts / level.file, own.get(_rung(level.roughness)), probe, level)
                for level in described
            }
        else:
            name = f"{stem}.json"
            try:
                (parts / name).write_text(record.to_json(), encoding="utf-8")
                names = [*(level.file for level in described), name]
                new = [folder / name for name in names if not (folder / name).exists()]
                sidecar.move_into_place(parts, folder, names)
                leftovers.wrote(new)
            except OSError as error:
                raise BakeError(_cannot_write(probe, folder, error)) from error
            images = {}
            for level in described:
                like = next(reversed(images.values()), None)
                old = own.get(_rung(level.roughness))
                images[level.roughness] = _linked(folder / level.file, old, like, probe, level)
    _keep(probe, record, images)


def _described(stem: str, k: int, roughness: float, picture: np.ndarray) -> sidecar.Level:
    key, digest = PictureKey(PictureKind.RADIANCE, k), sidecar.digest_of(picture)
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
    _rename_pictures(probe)
    have = {round(level.roughness, 4): level.image for level in probe.pcc_probe.levels}
    missing = sorted(set(roughnesses) - set(have))
    if not missing:
        return
    check_own(probe)
    pictures_now = {r: pictures.read_pixels(have[r]) for r in have if have[r]}
    if 0.0 not in pictures_now:
        raise BakeError(f"probe '{probe.name}': its capture is missing from the file; bake it again")
    for roughness in missing:
        pictures_now[roughness] = prefilter(pictures_now[0.0], roughness, progress)
    store(probe, record, pictures_now, folder)


def check_folder(folder: Path | None) -> None:
    """Make sure that a bake can be stored, before hours of rendering.

    Raises:
        BakeError: nothing can be written there.
    """
    with ExitStack() as stack:
        _folder_for_parts(stack, folder)


def faulty_picture(probe: bpy.types.Object, record: sidecar.Sidecar) -> str:
    """What is wrong with the first picture of a probe that is not what its record says; empty: nothing."""
    images = {round(level.roughness, 4): level.image for level in probe.pcc_probe.levels}
    if not record.levels:
        return "its record names no pictures"
    for level in record.levels:
        image = images.get(round(level.roughness, 4))
        if image is None:
            return f"its picture of roughness {level.roughness:.3g} is missing from the file"
        fault = _fault_of(image, level)
        if fault:
            return fault
    return ""


def _fault_of(image: bpy.types.Image, level: sidecar.Level) -> str:
    if image.packed_file:
        torn = level.size and image.packed_file.size != level.size
        return f"its packed picture '{image.name}' is not the one that was baked" if torn else ""
    path = Path(bpy.path.abspath(image.filepath))
    if not path.is_file():
        return f"its picture '{path}' is missing"
    if path.name != level.file:
        return f"its picture '{path}' is that of another bake"
    if level.size and path.stat().st_size != level.size:
        return f"its picture '{path}' is not the one that was baked: it has another size"
    if not level.size and not pictures.is_whole(path, level.width, level.height):
        return f"its picture '{path}' cannot be read"
    return ""


def _folder_for_parts(stack: ExitStack, folder: Path | None) -> Path:
    """A folder for unfinished files, on the same disk as the final one; folders that stay empty are gone afterwards."""
    try:
        if folder is not None:
            for missing in reversed([path for path in (folder, *folder.parents) if not path.exists()]):
                missing.mkdir(exist_ok=True)
                stack.callback(_remove_if_empty, missing)
            folder.mkdir(exist_ok=True)  # says what stands in its way
        return stack.enter_context(temporary_folder(UNFINISHED, folder))
    except OSError as error:
        raise BakeError(
            f"cannot write into '{folder or tempfile.gettempdir()}' ({error.strerror}); make it writable or choose "
            "another folder"
        ) from error


def _remove_if_empty(folder: Path) -> None:
    with contextlib.suppress(OSError):
        folder.rmdir()


def _cannot_write(probe: bpy.types.Object, folder: Path, error: OSError) -> str:
    return f"probe '{probe.name}': cannot write into '{folder}' ({error.strerror}); free space or choose another folder"


def _own_images(probe: bpy.types.Object) -> dict[int, bpy.types.Image]:
    """The images of a probe's levels, without those that a probe and its copy share, by `_rung`."""
    found = {_rung(level.roughness): level.image for level in probe.pcc_probe.levels if level.image}
    if found:
        others = [o.pcc_probe.levels for o in bpy.data.objects if o != probe and o.type == "EMPTY"]
        shared = {level.image for levels in others for level in levels}
        found = {rung: image for rung, image in found.items() if image not in shared}
    return found


def _rung(roughness: float) -> int:
    """A roughness as a key; what Blender keeps is rounded to single precision."""
    return round(roughness * 1e4)


def _rename_pictures(probe: bpy.types.Object) -> None:
    """Give a renamed probe's pictures its new name; their files follow at the next bake."""
    names = {level.image: _image_name(probe, level.roughness) for level in probe.pcc_probe.levels if level.image}
    if all(image.name.startswith(name) for image, name in names.items()):
        return
    for image in _own_images(probe).values():
        if not image.name.startswith(names[image]):
            image.name = names[image]


def _image_name(probe: bpy.types.Object, roughness: float) -> str:
    return f"PCC {probe.name} {roughness:.4f}"


def _linked(
    path: Path,
    old: bpy.types.Image | None,
    like: bpy.types.Image | None,
    probe: bpy.types.Object,
    level: sidecar.Level,
) -> bpy.types.Image:
    if old is not None and not old.packed_file and Path(bpy.path.abspath(old.filepath)).resolve() == path:
        old.reload()
        return _named(old, probe, level)
    return _in_place_of(old, pictures.load(path, like), probe, level)


def _packed(path: Path, old: bpy.types.Image | None, probe: bpy.types.Object, level: sidecar.Level) -> bpy.types.Image:
    image = pictures.load(path)
    image.pack()
    return _in_place_of(old, image, probe, level)


def _in_place_of(
    old: bpy.types.Image | None, image: bpy.types.Image, probe: bpy.types.Object, level: sidecar.Level
) -> bpy.types.Image:
    """A new picture wherever the one before was used. Each has its own data block, which undo brings back whole."""
    if old is not None:
        old.user_remap(image)
        bpy.data.images.remove(old)
    return _named(image, probe, level)


def _named(image: bpy.types.Image, probe: bpy.types.Object, level: sidecar.Level) -> bpy.types.Image:
    image.name = _image_name(probe, level.roughness)
    return image


def _keep(probe: bpy.types.Object, record: sidecar.Sidecar, images: dict[float, bpy.types.Image]) -> None:
    """Let the probe know its pictures and their record; pictures that nobody shows any more are removed."""
    settings = probe.pcc_probe
    before = {level.image for level in settings.levels if level.image}
    settings.levels.clear()
    for roughness in sorted(images):
        level = settings.levels.add()
        level.roughness, level.image = roughness, images[roughness]
    settings.bake_record = record.to_json()
    for image in before - set(images.values()):
        if image.users == 0:
            bpy.data.images.remove(image)
