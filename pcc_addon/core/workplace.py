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
from functools import cache
from pathlib import Path

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


def aside(path: Path) -> Path:
    """Where a file is written before it is moved to `path`; what killed runs left there is removed."""
    remove_abandoned(UNFINISHED, path.parent)
    return path.parent / f"{_signed(UNFINISHED)}{uuid.uuid4().hex[:8]}{path.suffix}"


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
