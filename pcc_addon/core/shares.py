"""Work that several processes share: each finds out by itself, from the same file, which part is its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .errors import PccError


@dataclass(frozen=True)
class Share:
    """The share of that number, from 1 on, of so many."""

    number: int
    of: int

    @classmethod
    def parse(cls, text: str) -> Share:
        """Read `2/8`.

        Raises:
            PccError: it is no such thing.
        """
        number, slash, of = text.partition("/")
        if not slash or not (number.isdecimal() and of.isdecimal()) or not 1 <= int(number) <= int(of):
            raise PccError(f"share '{text}' is none; give its number and how many there are, as 2/8")
        return cls(int(number), int(of))


def dealt(costs: Sequence[float], pieces: Sequence[int], share: Share) -> list[range]:
    """Which pieces of each item belong to a share: shares cost about the same, and together they are everything.

    Whole items where there are enough of them, the dearest first, each to the share that has least; else runs of them.

    Args:
        costs: of the items.
        pieces: how many each item consists of, which cost alike; at least 1.
        share: the one that is asked for.
    """
    if share.of <= len(costs):
        owners = _owners(costs, share.of)
        return [range(n if owner == share.number - 1 else 0) for n, owner in zip(pieces, owners, strict=True)]
    total = sum(costs) or 1.0
    found, done = [], 0.0
    for cost, count in zip(costs, pieces, strict=True):
        middles = [(done + cost * (k + 0.5) / count) / total for k in range(count)]
        mine = [k for k, middle in enumerate(middles) if int(middle * share.of) == share.number - 1]
        found.append(range(mine[0], mine[-1] + 1) if mine else range(0))
        done += cost
    return found


def _owners(costs: Sequence[float], count: int) -> list[int]:
    """For each item the share, from 0 on, that has it."""
    loads, owners = [(0.0, 0, k) for k in range(count)], [0] * len(costs)
    for index in sorted(range(len(costs)), key=lambda k: (-costs[k], k)):
        load, held, owner = min(loads)
        owners[index] = owner
        loads[owner] = (load + costs[index], held + 1, owner)
    return owners
