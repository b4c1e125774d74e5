"""The folder of an export: what lies there is replaced only where an earlier export put it and nobody changed it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import PccError
from ..sidecar import move_into_place
from ..workplace import UNFINISHED, temporary_folder
from . import document


@contextmanager
def parts_of(folder: Path) -> Iterator[Path]:
    """A folder on the disk of an export's, to write its files into; gone afterwards.

    Raises:
        PccError: nothing can be written there.
    """
    if folder.exists() and not folder.is_dir():
        raise PccError(f"'{folder}' is a file; name a folder")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with temporary_folder(UNFINISHED, folder) as parts:
            yield parts
    except OSError as error:
        raise cannot_write(folder, error) from error


def cannot_write(folder: Path, error: OSError) -> PccError:
    """What to say where a file of an export cannot be written."""
    return PccError(f"cannot write into '{folder}' ({error.strerror}); free space, or choose another folder")


def digest(path: Path) -> str:
    """Hexadecimal, of a file's content."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


def publish(parts: Path, folder: Path, names: Sequence[str]) -> None:
    """Move finished files into the folder, the JSON file last, and remove those of the export before that are not kept.

    Args:
        parts: where they are, the JSON file too.
        folder: where they go.
        names: all but the JSON file.

    Raises:
        PccError: somebody's file is in the way, or one cannot be moved.
    """
    before = _written_before(folder)
    for name in names:
        path = folder / name
        in_the_way = path.exists() or path.is_symlink()
        if in_the_way and not _is_ours(path, before) and not _is_same(path, parts / name):
            raise PccError(
                f"'{path}' was not written by an export, or was changed since; move it away, or choose another folder"
            )
    try:
        move_into_place(parts, folder, [*names, document.NAME])
    except OSError as error:
        raise cannot_write(folder, error) from error
    for name in set(before) - set(names):
        with suppress(OSError):
            if _is_ours(folder / name, before):
                (folder / name).unlink()


def _written_before(folder: Path) -> dict[str, str]:
    """What an earlier export put there, with digests; only what lies in the folder itself."""
    listing = folder / document.NAME
    found = document.files_of(_text(listing), str(listing)) if listing.exists() or listing.is_symlink() else {}
    return {name: known for name, known in found.items() if Path(name).name == name}


def _is_same(path: Path, other: Path) -> bool:
    """Whether a file has the content of another already, as where an export was stopped while it moved its files."""
    return path.is_file() and not path.is_symlink() and digest(path) == digest(other)


def _is_ours(path: Path, before: dict[str, str]) -> bool:
    return path.is_file() and not path.is_symlink() and before.get(path.name) == digest(path)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PccError(f"'{path}' cannot be read; move it away, or choose another folder") from error
