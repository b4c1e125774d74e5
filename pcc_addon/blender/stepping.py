"""Long work as one object: operators and the shell drive it a step at a time, show how far it is, and may stop it."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import ExitStack
from typing import TypeVar

from . import judging

R = TypeVar("R")
Steps = Generator[None, None, R]
"""Work that may be left for a moment at each yield, and what comes of it."""


def at_once(steps: Steps[R]) -> R:
    """All steps, one after the other."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


class SteppedJob:
    """A base of such jobs. Call `step` until it returns False, or `cancel`; what is worked on is changed in between.

    Who derives from it says what to do in `_run`, which yields between two pieces of work, and what has to be as before
    however the work ends on `_stack`.

    Attributes:
        progress: 0 … 1.
        message: what is being done.
    """

    def __init__(self) -> None:
        """A job that has not begun."""
        self.progress, self.message = 0.0, "Preparing"
        self._stack, self._begun = ExitStack(), False
        self._work = self._run()

    def _run(self) -> Iterator[object]:
        raise NotImplementedError

    def _went_on(self, told: object) -> None:
        """A piece of work is done, which yielded this."""

    def _ended(self) -> None:
        """All work is done, and all is as it was before."""

    def step(self) -> bool:
        """Do the next piece of work; False once all is done and what was changed for it is as before.

        Raises:
            Cancelled: the user stopped a render.
            Exception: whatever else went wrong. In every case what was changed is as before first.
        """
        try:
            if not self._begun:  # what is looked at meanwhile is what is worked on
                self._begun = True
                self._stack.enter_context(judging.corrected())
            self._went_on(next(self._work))
        except StopIteration:
            self._stack.close()
            self._ended()
            self.progress, self.message = 1.0, "Done"
            return False
        except BaseException:
            self._stack.close()
            raise
        return True

    def finish(self) -> None:
        """Do all steps at once; raises as `step` does."""
        while self.step():
            pass

    def cancel(self) -> None:
        """Stop; what was changed for the work is as before, what is finished stays."""
        self._work.close()
        self._stack.close()
        self.message = "Cancelled"
