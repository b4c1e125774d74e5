"""Which pictures an animated probe needs: one for each thing that it sees, however many frames show it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Moment:
    """A frame of the scene as a probe sees it.

    Attributes:
        frame: from it on, until the next moment, what it saw then is shown.
        content_hash: of all that its picture depends on then; equal ones have equal pictures.
        number: which of the probe's pictures is shown.
        capture_point: where that picture was taken, world space, metres.
    """

    frame: int
    content_hash: str
    number: int
    capture_point: Point


@dataclass(frozen=True)
class SequencePlan:
    """What a sequence needs.

    Attributes:
        moments: one for each frame, ascending.
        hashes: what each picture shows, by its number.
        frames: at which frame each picture can be taken: the first that shows it.
        missing: the numbers of the pictures that must be rendered.
    """

    moments: tuple[Moment, ...]
    hashes: tuple[str, ...]
    frames: tuple[int, ...]
    missing: tuple[int, ...]


def plan_sequence(
    frames: Sequence[int], hashes: Sequence[str], points: Sequence[Point], known: Collection[str] = frozenset()
) -> SequencePlan:
    """Decide which frames share a picture, and which pictures must be rendered.

    A frame at which a probe sees what it saw at an earlier one shows that one's picture, whatever lies between.

    Args:
        frames: ascending.
        hashes: of what the probe sees, one for each frame.
        points: where its capture point is, one for each frame.
        known: hashes whose pictures are there already.
    """
    numbers: dict[str, int] = {}
    first: list[int] = []
    moments: list[Moment] = []
    for frame, content_hash in zip(frames, hashes, strict=True):
        if content_hash not in numbers:
            numbers[content_hash] = len(first)
            first.append(len(moments))
        number = numbers[content_hash]
        moments.append(Moment(frame, content_hash, number, points[first[number]]))
    shown = tuple(numbers)
    missing = tuple(number for number, content_hash in enumerate(shown) if content_hash not in known)
    return SequencePlan(tuple(moments), shown, tuple(frames[k] for k in first), missing)


def changed_frames(moments: Sequence[Moment], hashes: Sequence[str]) -> tuple[int, ...]:
    """The frames of a sequence at which the probe sees something else now; `hashes`: what it sees, one for each."""
    return tuple(m.frame for m, content_hash in zip(moments, hashes, strict=True) if m.content_hash != content_hash)


@dataclass(frozen=True)
class Change:
    """A frame from which on a sequence shows another picture, taken at another point."""

    frame: int
    number: int
    capture_point: Point


def changes(moments: Sequence[Moment]) -> tuple[Change, ...]:
    """The frames at which a sequence goes over to another picture; the first of them always."""
    found: list[Change] = []
    for moment in moments:
        if not found or found[-1].number != moment.number:
            found.append(Change(moment.frame, moment.number, moment.capture_point))
    return tuple(found)
