"""Makes ready what materials will call when they show a plan, a little at a time, so that showing it takes no time.

The formulas come from a thread, as fitting lobes takes part of a second and needs nothing of Blender. Their groups are
built by whoever calls `step`, since all that touches Blender must be done where it waits for it.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from threading import Thread

from ...core.expression import Formula
from ...core.formulas_shown import formulas_shown
from ...core.plan import Plan
from .. import unrecorded
from . import groups

AT_ONCE = 0.03
"""Seconds that a step may take, but for the last thing that it does."""


class Preparation:
    """Prepares for a plan. Call `step` until it returns False, and `start_over` before each undo and redo."""

    def __init__(self, plan: Plan) -> None:
        self._formulas: list[Formula] = []
        self._thread = Thread(target=self._find, args=(plan,), daemon=True)
        self._thread.start()
        self._next, self._work = 0, iter(())

    def step(self) -> bool:
        """Go on for a moment; False once all groups are there."""
        end = time.monotonic() + AT_ONCE
        with unrecorded.following():
            while time.monotonic() < end:
                more = self._thread.is_alive()  # asked first, so that the last formula is not missed
                if not self._goes_on():
                    return more
        return True

    def start_over(self) -> None:
        """Forget the group that is being built, of which an undo may leave anything, and what was built before it."""
        self._next, self._work = 0, iter(())

    def _goes_on(self) -> bool:
        """Do the next piece of work; False where there is none at present."""
        try:
            next(self._work)
        except StopIteration:
            if self._next == len(self._formulas):
                return False
            self._work: Iterator[None] = groups.preparing(self._formulas[self._next])
            self._next += 1
        except ReferenceError:  # somebody removed the group
            self._work = iter(())
        return True

    def _find(self, plan: Plan) -> None:
        for formula in formulas_shown(plan):
            self._formulas.append(formula)
