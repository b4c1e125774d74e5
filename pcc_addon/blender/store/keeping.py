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
from ...core.workplace import UNFINISHED, real, temporary_folder
from ..read.holders import Holders
from . import leftovers, pictures


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
            f"cannot write into '{folder or tempfile.gettempdir()}' ({error.strerror}); free space there, make it "
            "writable or choose another folder"
        ) from error


def take_in(
    probe: bpy.types.Object,
    record: sidecar.Sidecar,
    parts: Path,
    folder: Path | None,
    holders: Holders,
    *,
    durable: bool = False,
) -> None:
    """Move the files of a whole bake into place, and let the probe know them.

    Args:
        probe: the probe object; its `uid` is the record's.
        record: of the bake.
        parts: where the files that it names are, on the disk of `folder`.
        folder: where to; None packs them into the .blend.
        holders: who shows which pictures.
        durable: whether to wait until the disk has them.

    Raises:
        BakeError: a file cannot be moved; what was there before is untouched.
    """
    if folder is None:
        own = own_images(probe, holders)
        images = {
            level.roughness: _packed(parts / level.file, own.get(rung(level.roughness)), probe, level)
            for level in record.levels
        }
        _keep(probe, record, images, holders)
        return
    name = sidecar.sidecar_file(probe.name, record.uid)
    names = [*(level.file for level in record.levels), name]
    try:
        if not sidecar.may_replace(folder / name):
            raise BakeError(
                f"probe '{probe.name}': '{folder / name}' is in the way and none of ours; move it away, or choose "
                "another folder"
            )
        (parts / name).write_text(record.to_json(), encoding="utf-8")
        new = [folder / file for file in names if not (folder / file).exists()]
        sidecar.move_into_place(parts, folder, names, durable=durable)
        leftovers.wrote(new)
    except OSError as error:
        raise BakeError(cannot_write(probe, folder, error)) from error
    show_files(probe, record, folder, holders)


def show_files(probe: bpy.types.Object, record: sidecar.Sidecar, folder: Path, holders: Holders) -> None:
    """Let the probe know the files of a bake that are in a folder."""
    first = [level for level in record.levels if level.key.number <= 0]  # of a sequence, which nodes go through
    _keep(probe, record, linked(folder, first, own_images(probe, holders), probe), holders)


def _remove_if_empty(folder: Path) -> None:
    with contextlib.suppress(OSError):
        folder.rmdir()


def cannot_write(probe: bpy.types.Object, folder: Path, error: OSError) -> str:
    return f"probe '{probe.name}': cannot write into '{folder}' ({error.strerror}); free space or choose another folder"


def own_images(probe: bpy.types.Object, holders: Holders) -> dict[int, bpy.types.Image]:
    """The images of a probe's levels, without those that it shares with a copy or another file, by `rung`."""
    images = {rung(level.roughness): level.image for level in probe.pcc_probe.levels if level.image}
    return {key: image for key, image in images.items() if not image.library and not holders.share(image)}


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
        level.roughness: _link_of(folder / level.file, own.get(rung(level.roughness)), probe, level) for level in levels
    }


def _link_of(path: Path, old: bpy.types.Image | None, probe: bpy.types.Object, level: sidecar.Level) -> bpy.types.Image:
    if old is not None and not old.packed_file and real(bpy.path.abspath(old.filepath)) == path:
        old.buffers_free()  # it is read anew where it is shown; `reload` asks all nodes of the file who that is
        old.update_tag()
        return _named(old, probe, level)
    image = pictures.load(path)
    source = "FILE" if level.key.number == STILL else "SEQUENCE"  # which shows its file first; nodes say which when
    if image.source != source:
        image.source = source
    return _in_place_of(old, image, probe, level)


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
    image.rename(_image_name(probe, level.roughness), mode="ALWAYS")  # a copy may show the picture that has it now
    return image


def _keep(
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
    held = {image for image in gone if image.users}
    for image in gone - held:
        bpy.data.images.remove(image)
    for other in bpy.data.objects if held else ():
        if any(level.image in held for level in other.pcc_probe.levels):
            rename_pictures(other)  # a copy, which may show them alone from now on
