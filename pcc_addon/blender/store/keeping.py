"""How a probe comes to its pictures: a place for unfinished files, image data blocks for finished ones."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

import bpy

from ...core import sidecar
from ...core.errors import BakeError
from ...core.pictures import NEARNESS, STILL
from ...core.workplace import UNFINISHED, temporary_folder
from ..read.holders import Holders
from . import pictures


def folder_for_parts(stack: ExitStack, folder: Path | None) -> Path:
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


def cannot_write(probe: bpy.types.Object, folder: Path, error: OSError) -> str:
    return f"probe '{probe.name}': cannot write into '{folder}' ({error.strerror}); free space or choose another folder"


def own_images(probe: bpy.types.Object, holders: Holders) -> dict[int, bpy.types.Image]:
    """The images of a probe's levels, without those that a probe and its copy share, by `rung`."""
    images = {rung(level.roughness): level.image for level in probe.pcc_probe.levels if level.image}
    return {key: image for key, image in images.items() if not holders.share(image)}


def rung(roughness: float) -> int:
    """A roughness as a key; what Blender keeps is rounded to single precision."""
    return round(roughness * 1e4)


def rename_pictures(probe: bpy.types.Object) -> None:
    """Give a renamed probe's pictures its new name; their files follow at the next bake."""
    names = {level.image: _image_name(probe, level.roughness) for level in probe.pcc_probe.levels if level.image}
    if all(image.name.startswith(name) for image, name in names.items()):
        return
    for image in own_images(probe, Holders()).values():
        if not image.name.startswith(names[image]):
            image.name = names[image]


def _image_name(probe: bpy.types.Object, roughness: float) -> str:
    return f"PCC {probe.name} Distance" if roughness == NEARNESS else f"PCC {probe.name} {roughness:.4f}"


def linked(
    folder: Path, levels: Sequence[sidecar.Level], own: Mapping[int, bpy.types.Image], probe: bpy.types.Object
) -> dict[float, bpy.types.Image]:
    """The pictures of files in a folder, by roughness, each in place of the probe's own of its `rung`."""
    return {
        level.roughness: _linked(folder / level.file, own.get(rung(level.roughness)), probe, level) for level in levels
    }


def _linked(path: Path, old: bpy.types.Image | None, probe: bpy.types.Object, level: sidecar.Level) -> bpy.types.Image:
    if old is not None and not old.packed_file and Path(bpy.path.abspath(old.filepath)).resolve() == path:
        old.buffers_free()  # it is read anew where it is shown; `reload` asks all nodes of the file who that is
        old.update_tag()
        return _named(old, probe, level)
    image = pictures.load(path)
    source = "FILE" if level.key.number == STILL else "SEQUENCE"  # which shows its file first; nodes say which when
    if image.source != source:
        image.source = source
    return _in_place_of(old, image, probe, level)


def packed(path: Path, old: bpy.types.Image | None, probe: bpy.types.Object, level: sidecar.Level) -> bpy.types.Image:
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


def keep(
    probe: bpy.types.Object, record: sidecar.Sidecar, images: dict[float, bpy.types.Image], holders: Holders
) -> None:
    """Let the probe know its pictures and their record; pictures that nobody shows any more are removed."""
    settings = probe.pcc_probe
    gone = {level.image for level in settings.levels if level.image} - set(images.values())
    holders.let_go(gone)
    settings.levels.clear()
    for roughness in sorted(images):
        level = settings.levels.add()
        level.roughness, level.image = roughness, images[roughness]
    settings.bake_record = record.to_json()
    for image in gone:
        if image.users == 0:
            bpy.data.images.remove(image)
