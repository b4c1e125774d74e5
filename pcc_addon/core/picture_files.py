"""Which files make up the picture that a user chose: one, or six whose names end in the faces that they show."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from .errors import ProbeError

# The endings of six files, in the order +X, −X, +Y, −Y, +Z, −Z of engines, whose Y is up.
FACE_NAMES: tuple[tuple[str, ...], ...] = (
    ("px", "nx", "py", "ny", "pz", "nz"),
    ("posx", "negx", "posy", "negy", "posz", "negz"),
    ("+x", "-x", "+y", "-y", "+z", "-z"),
    ("right", "left", "top", "bottom", "front", "back"),
    ("right", "left", "up", "down", "front", "back"),
)


def picture_files(probe: str, chosen: str) -> tuple[Path, ...]:
    """The files of a picture: the chosen one, or six in the order of `FACE_NAMES` where it is one of six.

    Args:
        probe: the probe's name, for errors.
        chosen: the path of the file, or of any of the six; letters' case in the names does not count.

    Raises:
        ProbeError: no file is chosen, or it does not exist.
    """
    if not chosen:
        raise ProbeError(
            f"probe '{probe}' shows an image, but none is chosen; choose a picture, or set its source to Bake"
        )
    path = Path(chosen)
    if not _is_file(path):
        raise ProbeError(f"probe '{probe}': its picture '{chosen}' does not exist; choose another, or put it back")
    beside = _by_name(path)
    for names in _sets_with(path):
        found = [beside.get(name) for name in names]
        if all(found):
            return tuple(file for file in found if file)
    return (path,)


def missing_faces(path: Path) -> tuple[str, ...]:
    """The names, in small letters, that lack beside a file to make it one of six faces; none where it has no such name.

    Where the name may belong to several sets, the one that lacks least.
    """
    beside = _by_name(path)
    lacking = [tuple(name for name in names if name not in beside) for names in _sets_with(path)]
    return min(lacking, key=len, default=())


def digest(files: Sequence[Path]) -> str:
    """A hexadecimal SHA-256 of what files hold, in their order.

    Raises:
        OSError: one cannot be read.
    """
    whole = hashlib.sha256()
    for file in files:
        with file.open("rb") as stream:
            whole.update(hashlib.file_digest(stream, "sha256").digest())
    return whole.hexdigest()


def _sets_with(path: Path) -> Iterator[tuple[str, ...]]:
    """The sets of six file names, in small letters, that a file's name may belong to."""
    stem, suffix = path.stem.lower(), path.suffix.lower()
    for names in FACE_NAMES:
        for name in names:
            if stem.endswith(name):
                yield tuple(f"{stem.removesuffix(name)}{other}{suffix}" for other in names)


def _by_name(path: Path) -> dict[str, Path]:
    """The files beside one and itself, by their names in small letters."""
    return {file.name.lower(): file for file in sorted(path.parent.iterdir())} | {path.name.lower(): path}


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that the system does not allow
        return False
