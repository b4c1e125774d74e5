"""Temporary folders and files whose names say which process made them, so that those of killed runs can be removed."""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import re
import shutil
import tempfile
import uuid
from collections.abc import Iterator
from contextlib import ExitStack
from functools import cache
from pathlib import Path

from .errors import PccError

UNFINISHED = ".unfinished-"  # beside finished files, on their disk
WORKPLACE = "pcc-"  # in the system's folder for temporary files


@contextlib.contextmanager
def temporary_folder(prefix: str, parent: Path | None = None) -> Iterator[Path]:
    """A new folder in `parent`, or in the system's place for such, removed afterwards; abandoned ones go with it.

    Raises:
        OSError: it cannot be made.
    """
    parent = Path(tempfile.gettempdir()) if parent is None else parent
    remove_abandoned(prefix, parent)
    with tempfile.TemporaryDirectory(prefix=_signed(prefix), dir=parent) as name:
        yield Path(name)


def workplace(stack: ExitStack) -> Path:
    """A folder in the system's place for temporary files; gone when `stack` closes.

    Raises:
        PccError: it cannot be made.
    """
    try:
        return stack.enter_context(temporary_folder(WORKPLACE))
    except OSError as error:
        raise PccError(
            f"no folder for temporary files can be made in '{tempfile.gettempdir()}' ({error.strerror}); free space "
            "there"
        ) from error


def aside(path: Path) -> Path:
    """Where a file is written before it is moved to `path`; what killed runs left there is removed."""
    remove_abandoned(UNFINISHED, path.parent)
    return path.parent / f"{_signed(UNFINISHED)}{uuid.uuid4().hex[:8]}{path.suffix}"


def discard(path: Path) -> None:
    """Remove what was written aside, and what Blender wrote aside for that; it may be gone."""
    for left in (path, path.with_name(f"{path.name}@")):
        with contextlib.suppress(OSError):  # it was told already why nothing can be done there
            left.unlink(missing_ok=True)


def write_whole(path: Path, text: str) -> None:
    """Write a file aside and move it into place: the one before, or that which a link of its name leads to, stays.

    Raises:
        OSError: it cannot be written; what was there is as it was.
    """
    unfinished = aside(path)
    try:
        unfinished.write_text(text, encoding="utf-8")
        os.replace(unfinished, path)
    finally:
        discard(unfinished)


def real(path: Path | str) -> Path:
    """Where a path leads, links followed; one that leads to itself, which `Path.resolve` refuses, stays."""
    return Path(os.path.realpath(path))


def link(file: Path, to: Path) -> None:
    """Give a file a second name; a copy where the disk has none.

    Raises:
        OSError: neither can be made.
    """
    try:
        os.link(file, to)
    except OSError:
        shutil.copyfile(file, to)


def on_disk(path: Path) -> None:
    """Wait until what was written into a file is on its disk, so that no power cut takes it once it has its name.

    Raises:
        OSError: the disk is full, or broken.
    """
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def remove_abandoned(prefix: str, parent: Path) -> None:
    """Remove what processes of this machine made that run no more; whatever cannot be told stays."""
    with contextlib.suppress(OSError):
        signed = [entry for entry in os.scandir(parent) if entry.name.startswith(prefix)]
        for entry in signed:
            if not entry.is_symlink() and _is_abandoned(entry.name[len(prefix) :]):
                if entry.is_dir():
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    Path(entry.path).unlink(missing_ok=True)


def _signed(prefix: str) -> str:
    return f"{prefix}{_machine()}-{_start()}-{os.getpid()}-"


def _is_abandoned(signature: str) -> bool:
    """Whether the process that signed so is surely gone: one of this machine, before it was started anew or ended."""
    found = re.match(r"([0-9a-f]{8})-([0-9a-f]{8})-(\d+)-", signature)
    if found is None or found[1] != _machine():
        return False
    return found[2] != _start() or not _is_running(int(found[3]))


def _is_running(process: int) -> bool:
    """Whether there is such a process; True where that cannot be asked."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # another user's
        return True
    return True


@cache
def _machine() -> str:
    """Eight digits that tell this machine from others that may write to the same disk; containers count as machines."""
    return _digits(platform.node(), _read("/etc/machine-id") or str(uuid.getnode()), _link("/proc/self/ns/pid"))


@cache
def _start() -> str:
    """Eight digits that change when the machine is started anew, where that can be told."""
    return _digits(_read("/proc/sys/kernel/random/boot_id"))


def _digits(*words: str) -> str:
    return hashlib.blake2b("\n".join(words).encode(), digest_size=4).hexdigest()


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8").strip()
    except OSError:
        return ""


def _link(path: str) -> str:
    try:
        return os.readlink(path)
    except OSError:
        return ""
