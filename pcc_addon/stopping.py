"""Being asked to stop, by Ctrl+C, SIGTERM or a closed terminal: heard at any time, answered between two steps of work.

Imports nothing of Blender, whose first import takes a second in which the user may change his mind.
"""

from __future__ import annotations

import signal
from types import FrameType, TracebackType
from typing import Any

from .core.errors import Cancelled

_SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


def hold() -> None:
    """Let the signals wait until a `Stop` can hear them, where the system can do that."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)


def _is_outlived(number: int) -> bool:
    """Whether a signal is one that whoever started us, as `nohup` does, wants us to outlive."""
    return number == getattr(signal, "SIGHUP", None) and signal.getsignal(number) == signal.SIG_IGN


class Stop:
    """Hears the signals while it is entered; whoever works asks it between two steps.

    A second signal does not wait for the next step: it raises KeyboardInterrupt.

    Attributes:
        asked: whether there was a signal.
    """

    def __init__(self) -> None:
        self.asked = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Stop:
        self._before = {number: signal.signal(number, self._hear) for number in _SIGNALS if not _is_outlived(number)}
        if hasattr(signal, "pthread_sigmask"):
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for number, before in self._before.items():
            # None: Blender's own C code had it, and Python cannot give it back.
            signal.signal(number, signal.SIG_DFL if before is None else before)

    def check(self) -> None:
        """Go on, unless there was a signal.

        Raises:
            Cancelled: there was one.
        """
        if self.asked:
            raise Cancelled("cancelled")

    def _hear(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True
