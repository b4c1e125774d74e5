"""What was baked, by what, in how long: a line of JSON for each probe, added as soon as its bake is done."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .errors import PccError


def manifest_file(folder: Path, blend: Path) -> Path:
    """Where the manifest of a file's bakes is, among its pictures; a link there may be a stranger's, and goes.

    Raises:
        PccError: it cannot go.
    """
    path = folder / f"{blend.stem}.bakes.jsonl"
    if path.is_symlink():
        try:
            path.unlink()
        except OSError as error:
            raise PccError(f"manifest '{path}' is a link that cannot be removed ({error.strerror}); move it") from error
    return path


def add(path: Path, entry: Mapping[str, Any]) -> None:
    """Add a line; one that a power cut tore before stays by itself.

    Raises:
        PccError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():  # a pipe would be waited for
            raise OSError(errno.EINVAL, "it is no file")
        with path.open("ab+") as file:
            end = file.seek(0, os.SEEK_END)
            torn = False
            if end:
                file.seek(end - 1)
                torn = file.read(1) != b"\n"
            file.write(b"\n" * torn + json.dumps(entry).encode() + b"\n")
    except OSError as error:
        raise PccError(
            f"manifest '{path}' cannot be written ({error.strerror}); free space, or name another with --manifest"
        ) from error


def entries(path: Path) -> list[dict[str, Any]]:
    """The whole lines of a manifest, oldest first.

    Raises:
        OSError: it cannot be read.
    """
    found = []
    for line in path.read_bytes().splitlines():
        try:
            entry = json.loads(line)
        except ValueError:  # torn
            continue
        if isinstance(entry, dict):
            found.append(entry)
    return found
