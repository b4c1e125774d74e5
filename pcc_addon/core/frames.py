"""Frames of an animation: which are asked for, and how several are said."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from .errors import PccError

FIRST_FRAME, LAST_FRAME = -1048574, 1048574  # those that Blender has
STILL = "still"  # what is said instead of frames for one picture of the current frame
_RANGE = re.compile(r"(-?\d+)-(-?\d+)(?::(\d+))?")


@dataclass(frozen=True)
class FrameRange:
    """The frames from `first` to `last`, every `step`th of them."""

    first: int
    last: int
    step: int = 1

    def __post_init__(self) -> None:
        if self.last < self.first:
            raise PccError(f"frames {self.text}: the last comes before the first; ask for {self.last}-{self.first}")
        if self.step < 1:
            raise PccError(f"frames {self.text}: a step of {self.step} leads nowhere; take at least 1")
        if not FIRST_FRAME <= self.first <= self.last <= LAST_FRAME:
            raise PccError(f"frames {self.text}: Blender's frames go from {FIRST_FRAME} to {LAST_FRAME}; stay within")

    @classmethod
    def parse(cls, text: str) -> FrameRange:
        """The frames that "A-B" or "A-B:STEP" names.

        Raises:
            PccError: it names none; says why and what to write.
        """
        found = _RANGE.fullmatch(text.strip())
        if found is None:
            raise PccError(f"frames '{text}': write FIRST-LAST or FIRST-LAST:STEP in whole frames, such as 1-250:2")
        return cls(int(found[1]), int(found[2]), int(found[3] or 1))

    @property
    def frames(self) -> range:
        """All of them, ascending."""
        return range(self.first, self.last + 1, self.step)

    @property
    def text(self) -> str:
        """As `parse` reads it."""
        return f"{self.first}-{self.last}" + (f":{self.step}" if self.step != 1 else "")


def parse_frames(text: str | None) -> FrameRange | None | str:
    """What a user asks for: some frames, `STILL`, or (None or no text) as each probe was last baked.

    Raises:
        PccError: as `FrameRange.parse`.
    """
    if text is None or not text.strip():
        return None
    return STILL if text.strip().lower() == STILL else FrameRange.parse(text)


def spans(frames: Iterable[int]) -> str:
    """Ascending frames in words: "1-3, 7, 12-20:2"."""
    found: list[list[int]] = [[]]
    for frame in frames:
        run = found[-1]
        if len(run) > 1 and frame - run[-1] != run[1] - run[0]:
            lonely = len(run) == 2 and run[1] - run[0] > 1
            run = [run.pop()] if lonely else []  # two that are apart are none; the second may begin one
            found.append(run)
        run.append(frame)
    return ", ".join(part for run in found if run for part in _said(run))


def _said(run: list[int]) -> list[str]:
    """Frames that are equally far apart; two that are no neighbours are said alone."""
    step = run[1] - run[0] if len(run) > 1 else 1
    if len(run) == 1 or (len(run) == 2 and step > 1):
        return [str(frame) for frame in run]
    return [FrameRange(run[0], run[-1], step).text]
