"""Standard output without Blender's own lines; imports nothing of Blender, whose first import writes there too."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator
from typing import TextIO


@contextlib.contextmanager
def quiet_blender() -> Iterator[TextIO]:
    """Standard output for us alone: Blender's own lines, from C code and through Python, go nowhere."""
    _flush_all()
    _open_what_is_closed()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    out = os.fdopen(os.dup(kept), "w", encoding="utf-8", errors="backslashreplace")
    os.dup2(nowhere, 1)
    try:
        with open(os.devnull, "w", encoding="utf-8") as silence, contextlib.redirect_stdout(silence):
            yield out
    finally:
        _flush_all()
        os.dup2(kept, 1)
        with contextlib.suppress(OSError):  # whoever wrote has met the fault already
            out.close()
        os.close(kept)
        os.close(nowhere)


def _open_what_is_closed() -> None:
    """Whoever started us may have closed standard output; the next file to be opened must not become it."""
    try:
        os.fstat(1)
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        if nowhere != 1:
            os.dup2(nowhere, 1)
            os.close(nowhere)


def _flush_all() -> None:
    """Empty Python's buffer of standard output and the C library's."""
    if sys.stdout is not None:
        sys.stdout.flush()
    library = ctypes.CDLL("ucrtbase" if os.name == "nt" else None)
    library.fflush(None)
