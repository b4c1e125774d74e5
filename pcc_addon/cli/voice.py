"""What a command says, and to whom."""

from __future__ import annotations

import json
import sys
from typing import TextIO


class Voice:
    """Sentences for people, or JSON lines; never Blender's own chatter.

    Where nobody can be told any more (a closed pipe, a full disk) the work goes on in silence.

    Attributes:
        lost: why standard output could not be written, or None.
    """

    def __init__(self, out: TextIO, as_json: bool) -> None:
        self.lost: str | None = None
        self._out, self._as_json = out, as_json
        self._kinds: set[str] = set()

    def said(self, kind: str) -> bool:
        """Whether such an event has happened."""
        return kind in self._kinds

    def event(self, kind: str, text: str, **details: object) -> None:
        """Something happened: a line of JSON, or `text`."""
        self._kinds.add(kind)
        if self.lost is not None:
            return
        line = json.dumps({"event": kind, **details}) if self._as_json else text
        try:
            print(line, file=self._out, flush=True)
        except OSError as error:
            self.lost = error.strerror or str(error)

    def progress(self, fraction: float, message: str) -> None:
        self.event("progress", f"{fraction:4.0%} {message}", progress=round(fraction, 4), message=message)

    def error(self, text: str) -> None:
        """A failure, in one line, on standard error too where standard output is for machines."""
        line = " ".join(text.split())
        if self._as_json:
            self.event("error", line, error=line)
        if sys.stderr is None:  # closed by whoever started us
            return
        try:
            print(f"pcc: {line}", file=sys.stderr, flush=True)
        except OSError:  # then the exit code alone can tell
            return
