"""A file of vectors: what it says about itself, and its records, a line each."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

Record = dict[str, Any]
ILL_POSED = 0.1  # radians; where single precision cannot say more, there is nothing to compare


@dataclass(frozen=True)
class VectorFile:
    """Vectors of one subject.

    Attributes:
        name: of the file, which is beside this one.
        about: what the records hold, in sentences.
        inputs: the fields that are float32 numbers, written exactly.
        sections: makes the records, by the name of the section; "cases" are the first.
    """

    name: str
    about: Sequence[str]
    inputs: tuple[str, ...]
    sections: Callable[[], dict[str, list[Record]]]

    @property
    def path(self) -> Path:
        return Path(__file__).with_name(self.name)

    def text(self) -> str:
        """What the file is to hold."""
        parts = [json.dumps({"about": list(self.about)}, indent=1)[:-2]]
        for name, records in self.sections().items():
            parts.append(f' "{name}": [\n  ' + ",\n  ".join(json.dumps(record) for record in records) + "\n ]")
        return ",\n".join(parts) + "\n}\n"

    def read(self, section: str = "cases") -> list[Record]:
        """The records that it holds."""
        records: list[Record] = json.loads(self.path.read_text(encoding="utf-8"))[section]
        return records


def columns(records: Sequence[Record]) -> dict[str, np.ndarray]:
    """Records of equal fields as arrays, by field; fields that are no arrays, such as lists of lists, are left out."""
    found = {}
    for name in records[0]:
        with contextlib.suppress(ValueError):
            found[name] = np.array([record[name] for record in records])
    return found


def first(bound: np.ndarray, count: int) -> np.ndarray:
    """The numbers of the first `count` cases that are not ill-posed."""
    return np.flatnonzero(bound < ILL_POSED)[:count]


def digits(values: Any, count: int = 15) -> Any:
    """Numbers, or lists of them, with so many digits."""
    return [digits(v, count) for v in values] if np.ndim(values) else float(f"{float(values):.{count}g}")


def tolerance(bound: Any) -> Any:
    """A bound, or a list of bounds, rounded up a little."""
    return [tolerance(v) for v in bound] if np.ndim(bound) else float(f"{1.01 * float(bound):.3g}")
