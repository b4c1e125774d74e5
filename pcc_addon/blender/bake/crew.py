"""A bake that several processes share: each does its part, and leaves whole bakes and faces in one folder."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from ...core.errors import Cancelled
from ...core.shares import Share
from ...core.workplace import workplace
from ..second_blender import SecondBlender

_ENDED, _CANCELLED = (0, 1), 130  # exit codes: with failures that were told, or without; stopped by somebody
_ATTEMPTS = 2  # of a share whose process ends too soon


class Crew:
    """Processes that bake the probes of a saved file. Call `step` until it returns False, or `cancel`.

    None of them writes into the file, nor a file that another writes.

    Attributes:
        progress: 0 … 1.
        message: what one of them does.
        given_up: by the name of a probe why it has no bake: whoever baked it ended again and again.
    """

    def __init__(self, stack: ExitStack, blend: Path, arguments: Sequence[str], count: int) -> None:
        """Begin.

        Args:
            stack: what removes all that they leave.
            blend: the file.
            arguments: of the shell's `bake`, but for the share.
            count: of processes.

        Raises:
            PccError: no Blender can be started.
        """
        self.progress, self.message = 0.0, "Starting Blender"
        self.given_up: dict[str, str] = {}
        self._members = [_Member(stack, blend, arguments, Share(k + 1, count)) for k in range(count)]
        stack.callback(self.cancel)

    def step(self, patience: float = 0.05) -> bool:
        """Take the news, waiting for at most so many seconds for that of each; False once all have ended.

        Raises:
            Cancelled: somebody stopped one of them.
            PccError: no further Blender can be started.
        """
        at_work = False
        for member in self._members:
            at_work |= member.step(patience)
            if member.why:
                self.given_up[member.at] = f"probe '{member.at}': {member.why}"
                member.why = ""
        self.progress = sum(member.progress for member in self._members) / len(self._members)
        self.message = next((m.message for m in self._members if m.message and m.progress < 1.0), self.message)
        return at_work

    def cancel(self) -> None:
        """Stop all; what they have made by then stays."""
        for member in self._members:
            member.stop()


class _Member:
    """One process and its share; `why` it was given up, at the probe called `at`."""

    def __init__(self, stack: ExitStack, blend: Path, arguments: Sequence[str], share: Share) -> None:
        self.progress, self.message, self.at, self.why = 0.0, "", "", ""
        self._place, self._blend = workplace(stack), blend
        self._arguments = [*arguments, f"--share={share.number}/{share.of}"]
        self._left = _ATTEMPTS
        self._begin()

    def _begin(self) -> None:
        self._left -= 1
        self._blender: SecondBlender | None = SecondBlender(self._blend, "bake", self._arguments, self._place)

    def step(self, patience: float) -> bool:
        """Whether it is still at work."""
        if self._blender is None:
            return False
        for event in self._blender.news(patience):
            if event.get("event") == "progress":
                self.progress, self.message, self.at = event["progress"], event["message"], event["probe"] or self.at
        code = self._blender.code
        if code is None:
            return True
        if code == _CANCELLED:
            raise Cancelled("a process of the bake was stopped")
        words, self._blender = self._blender.last_words, None
        if code not in _ENDED and self._left:
            self._begin()
            return True
        if code not in _ENDED and self.at:
            self.why = (
                f"the process that baked it ended twice ({words or f'code {code}'}); bake it by itself, with fewer "
                "pixels where memory is short"
            )
        self.progress = 1.0
        return False

    def stop(self) -> None:
        if self._blender is not None:
            self._blender.stop()
            self._blender = None
