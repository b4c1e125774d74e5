"""What images and other files hold, whatever they are called and wherever they lie."""

from __future__ import annotations

import hashlib
import re
from functools import lru_cache
from pathlib import Path

import bpy
import numpy as np

from .digests import digest, numbers, plain

_NUMBER = re.compile(r"(.*?)(\d+)(\D*?(?:\.\w+)?)", re.DOTALL)
PLAYED = frozenset({"SEQUENCE", "MOVIE"})
_GENERATED = ("generated_type", "generated_width", "generated_height", "use_generated_float", "generated_color")


def image(picture: bpy.types.Image, user: bpy.types.ImageUser | None = None, frame: int = 0) -> bytes:
    """A digest of what an image shows and how it is read; of a sequence what it shows to `user` at a frame."""
    packed = picture.packed_file is not None or len(picture.packed_files) > 0
    how = (
        "FILE" if picture.source == "GENERATED" and packed else picture.source,
        picture.alpha_mode,
        picture.use_half_precision,
        picture.colorspace_settings.name,
    )
    return digest(plain(how), _pixels(picture, user, frame))


def file(path: str, library: bpy.types.Library | None = None) -> bytes:
    """A digest of what a file holds; read again only where it was written since."""
    place = Path(bpy.path.abspath(path, library=library)) if path else None
    try:
        return contents(place) if place is not None and place.is_file() else b"missing"
    except (OSError, ValueError):  # it cannot be read, or its name is none
        return b"missing"


def contents(path: Path) -> bytes:
    """`file` of one that must be there.

    Raises:
        OSError: it cannot be read.
    """
    stat = path.stat()
    return _contents(path, stat.st_mtime_ns, stat.st_size)


def held(packed: bpy.types.PackedFile) -> bytes:
    """A digest of a packed file, the same as of the file that it was."""
    return hashlib.blake2b(packed.data, digest_size=20).digest()


@lru_cache(maxsize=4096)
def _contents(path: Path, written: int, size: int) -> bytes:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=20)).digest()


def _pixels(picture: bpy.types.Image, user: bpy.types.ImageUser | None, frame: int) -> bytes:
    if picture.source in {"FILE", "GENERATED"} and picture.is_dirty:  # painted, and not saved yet
        values = np.empty(len(picture.pixels), np.float32)
        picture.pixels.foreach_get(values)
        return digest(plain(tuple(picture.size)), numbers(values))
    if picture.source == "GENERATED" and picture.packed_file is None:
        return plain([plain(getattr(picture, name)) for name in _GENERATED]).encode()
    if picture.source == "TILED":
        return digest(*(digest(plain(tile.number), _tile(picture, tile.number)) for tile in _tiles(picture)))
    if picture.packed_file is not None:
        return held(picture.packed_file)
    if picture.source in PLAYED and user is not None:
        number = _shown_number(user, frame)
        path = _numbered(picture.filepath, number) if picture.source == "SEQUENCE" else picture.filepath
        return digest(plain(number), file(path, picture.library))
    return file(picture.filepath, picture.library)


def _shown_number(user: bpy.types.ImageUser, frame: int) -> int:
    """Which picture of a film is shown, as renderers count: from its first frame on, again and again if cyclic."""
    number, length = frame - user.frame_start + 1, max(user.frame_duration, 1)
    number = (number - 1) % length + 1 if user.use_cyclic else min(max(number, 0), length)
    return number + user.frame_offset


def _numbered(path: str, number: int) -> str:
    """The path of another file of a sequence: the last digits of its name are its number."""
    head, digits, tail = _NUMBER.fullmatch(path).groups() if _NUMBER.fullmatch(path) else (path, "", "")
    return f"{head}{number:0{len(digits)}d}{tail}" if digits else path


def _tiles(picture: bpy.types.Image) -> list[bpy.types.UDIMTile]:
    return sorted(picture.tiles, key=lambda tile: tile.number)


def _tile(picture: bpy.types.Image, number: int) -> bytes:
    u, v = (number - 1001) % 10, (number - 1001) // 10
    path = picture.filepath.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{u + 1}_v{v + 1}")
    for packed in picture.packed_files:
        if Path(packed.filepath.replace("\\", "/")).name == Path(path.replace("\\", "/")).name:
            return held(packed.packed_file)
    return file(path, picture.library)
