"""How many faults were tried, and how many of them survived."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

_tried: Counter[str] = Counter()
_survived: Counter[str] = Counter()


@contextmanager
def fault(kind: str) -> Iterator[None]:
    """One fault and all that must hold after it; where something does not, it counts as tried alone."""
    _tried[kind] += 1
    yield
    _survived[kind] += 1


def add(kind: str, tried: int, survived: int) -> None:
    """Faults that another process tried."""
    _tried[kind] += tried
    _survived[kind] += survived


def lines() -> list[str]:
    """A line for each kind, and their sum; none where nothing was tried."""
    if not _tried:
        return []
    told = [f"{kind}: {_survived[kind]} of {count} survived" for kind, count in sorted(_tried.items())]
    return [*told, f"together: {_survived.total()} of {_tried.total()} faults survived"]
