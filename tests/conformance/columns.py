"""Cases of any kind as columns of arrays, and families of them that are the same every time."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import Any, Generic, TypeVar

import numpy as np

C = TypeVar("C", bound="Columns")


class Columns:
    """Base of frozen dataclasses whose fields are arrays of n cases, columns themselves, or the same for all cases."""

    def __len__(self) -> int:
        return next(len(column) for column in self._columns().values())

    def __getitem__(self: C, chosen: np.ndarray | slice) -> C:
        """Some of the cases."""
        return type(self)(**self._values() | {name: column[chosen] for name, column in self._columns().items()})

    @classmethod
    def joined(cls: type[C], parts: Sequence[C]) -> C:
        """The cases of all parts, one after the other."""
        columns: dict[str, Any] = {}
        for name, first in parts[0]._columns().items():
            each = [getattr(part, name) for part in parts]
            columns[name] = np.concatenate(each) if isinstance(first, np.ndarray) else type(first).joined(each)
        return cls(**parts[0]._values() | columns)

    def _values(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def _columns(self) -> dict[str, Any]:
        return {name: value for name, value in self._values().items() if isinstance(value, (np.ndarray, Columns))}


class Families(Generic[C]):
    """Functions that make hard cases of one subject, by the name of the kind.

    Each is given a random generator, how many cases are wanted, and what else the subject distinguishes.
    """

    def __init__(self, subject: str) -> None:
        self.subject = subject
        self._make: dict[str, Callable[..., C]] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """As docs/numerics.md lists them."""
        return tuple(self._make)

    def family(self, name: str) -> Callable[[Callable[..., C]], Callable[..., C]]:
        """Enter a function."""

        def enter(make: Callable[..., C]) -> Callable[..., C]:
            self._make[name] = make
            return make

        return enter

    def cases(self, name: str, count: int, *of: object) -> C:
        """`count` cases of a family, the same every time."""
        return self._make[name](np.random.default_rng(zlib.crc32(f"{self.subject} {name}".encode())), count, *of)

    def together(self, count: int, *of: object) -> tuple[C, dict[str, slice]]:
        """`count` cases of every family in one, and where each family's are."""
        parts = [self.cases(name, count, *of) for name in self.names]
        ends = np.cumsum([0, *(len(part) for part in parts)])
        where = {name: slice(ends[k], ends[k + 1]) for k, name in enumerate(self.names)}
        return type(parts[0]).joined(parts), where
