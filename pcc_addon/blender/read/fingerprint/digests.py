"""Digests of plain things, and how they are put together: nothing here knows Blender's data blocks."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

_SIZE = 20  # bytes
Read = tuple[str, ...]  # what a shader or a modifier reads beside its own: (what,) or (what, of which name)

# What `Found.reads` may hold, beside ("attribute", kind, name).
RANDOM, COLOR, INDEX, MATERIAL_INDEX = ("random",), ("colour",), ("index",), ("material index",)
FRAME = ("frame",)  # it may be another at each frame, and nobody can tell without rendering
EVALUATED = ("evaluated",)  # it may be another at each frame, and Blender's evaluated shape tells


@dataclass(frozen=True)
class Found:
    """What something shows, as a digest without names and orders that do not count.

    Attributes:
        digest: another one where it shows something else.
        reads: what it reads of whoever uses it.
        inputs: of a socket within a group, the identifiers of the group's inputs that reach it.
    """

    digest: bytes
    reads: frozenset[Read] = frozenset()
    inputs: frozenset[str] = frozenset()


NOTHING = Found(b"nothing")


def digest(*parts: bytes | str) -> bytes:
    """Of parts whose order counts."""
    plain = [part.encode() if isinstance(part, str) else part for part in parts]
    sizes = ",".join([str(len(part)) for part in plain])  # so that no other parts give the same bytes
    return hashlib.blake2b(b"".join((sizes.encode(), b":", *plain)), digest_size=_SIZE).digest()


def unordered(parts: Iterable[bytes]) -> bytes:
    """Of parts whose order does not count, but how often each is there."""
    return digest(*sorted(parts))


def numbers(values: np.ndarray) -> bytes:
    """Of an array of any shape."""
    values = np.ascontiguousarray(values)
    whole = hashlib.blake2b(f"{_name(values.dtype)} {values.shape}".encode(), digest_size=_SIZE)
    whole.update(values.reshape(-1).view(np.uint8))
    return whole.digest()


_name = cache(str)  # of a type of numbers: NumPy takes long for it


def plain(value: object) -> str:
    """A text for a number, a text, a set, or numbers in any nesting; negative zeros are zeros.

    Truths are numbers: custom properties come back as such from a file.
    """
    if isinstance(value, float):
        return repr(value + 0.0)
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, (set, frozenset)):
        return repr(sorted(value))
    if isinstance(value, (str, bytes, int)) or value is None:
        return repr(value)
    parts = [repr(part + 0.0) if type(part) is float else plain(part) for part in _parts(value)]  # mostly are floats
    return f"[{', '.join(parts)}]"


def _parts(value: object) -> Iterator[object]:
    if hasattr(value, "to_dict"):  # a custom property with parts of its own
        yield from sorted(value.to_dict().items())
    elif hasattr(value, "to_list"):
        yield from value.to_list()
    elif hasattr(value, "__len__"):
        yield from value
    else:
        yield type(value).__name__
