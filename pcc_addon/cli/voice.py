"""What a command says, and to whom."""

from __future__ import annotations

import json
import sys
from typing import TextIO

from ..core.errors import Cancelled


class Voice:
    """Sentences for people, or JSON lines; never Blender's own chatter.

    Where nobody can be told any more (a closed pipe, a full disk) the work goes on in silence, unless it is all for
    somebody who listens.

    Attributes:
        lost: why standard output could not be written, or None.
    """

    def __init__(self, out: TextIO, as_json: bool, *, attended: bool = False) -> None:
        self.lost: str | None = None
        self._out, self._as_json, self._attended = out, as_json, attended
        self._kinds: set[str] = set()

    def said(self, kind: str) -> bool:
        """Whether such an event has happened."""
        return kind in self._kinds

    def begin_file(self, path: str) -> None:
        """What is told from now on is about another file."""
        self._kinds.clear()
        self.event("file", path, file=path)

    def event(self, kind: str, text: str, **details: object) -> None:
        """Something happened: a line of JSON, or `text`.

        Raises:
            Cancelled: nobody listens any more, and it was all for who did.
        """
        self._kinds.add(kind)
        if self.lost is not None:
            return
        line = json.dumps({"event": kind, **details}) if self._as_json else text
        try:
            print(line, file=self._out, flush=True)
        except OSError as error:
            self.lost = error.strerror or str(error)
            if self._attended:
                raise Cancelled("the Blender that asked for this is gone") from error

    def progress(self, fraction: float, message: str, **details: object) -> None:
        self.event("progress", f"{fraction:4.0%} {message}", progress=round(fraction, 4), message=message, **details)

    def error(self, text: str, **details: object) -> None:
        """A failure, in one line, on standard error too where standard output is for machines."""
        line = " ".join(text.split())
        if self._as_json:
            self.event("error", line, error=line, **details)
        if sys.stderr is None:  # closed by whoever started us
            return
        try:
            print(f"pcc: {line}", file=sys.stderr, flush=True)
        except OSError:  # then the exit code alone can tell
            return
