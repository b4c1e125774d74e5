"""Files that somebody wrote to do harm, or that a disk spoilt: as text, as numbers, as pictures."""

from __future__ import annotations

import copy
import struct
from collections.abc import Iterator
from typing import Any

OUTSIDE = "../../victim.exr"

TEXTS: dict[str, str] = {
    "nothing": "",
    "blanks": " \n\t",
    "zeros": "\0" * 64,
    "a letter": "Dear Sir",
    "half an object": '{\n "format": "parallax-probe",\n "version": 2, "levels": [',
    "a list": "[]",
    "a number": "12",
    "no number": "NaN",
    "null": "null",
    "a lone surrogate": '{\n "format": "parallax-probe",\n "version": 2, "probe": "\\ud800"}',
    "deep lists": "[" * 200_000,
    "deep objects": '{"levels":' * 200_000,
    "a number of many digits": '{\n "format": "parallax-probe",\n "version": ' + "9" * 5000 + "}",
    "a later version": '{\n "format": "parallax-probe",\n "version": 999}',
    "a version that is none": '{\n "format": "parallax-probe",\n "version": 1e999}',
}

VALUES: tuple[Any, ...] = (
    None, True, -1, 0, 10**400, 2**31, 2**63, 1e308, float("nan"), float("inf"), float("-inf"), "", "\0", "x" * 10_000,
    OUTSIDE, "/etc/passwd", "C:\\Windows\\win.ini", "..", [], [[[[]]]], {}, {"a": {}}, [None] * 6, [1e400] * 16,
)  # fmt: skip


def spoilt(document: Any) -> Iterator[tuple[str, Any]]:
    """A document with each of its values replaced by each of `VALUES`, and with each left out; and which that is."""
    for path in _paths(document):
        for index, value in enumerate((*VALUES, ...)):
            changed = copy.deepcopy(document)
            at = changed
            for key in path[:-1]:
                at = at[key]
            if value is ...:
                del at[path[-1]]
            else:
                at[path[-1]] = value
            yield f"{'.'.join(map(str, path))} {'left out' if value is ... else f'value {index}'}", changed


def _paths(document: Any) -> Iterator[tuple[Any, ...]]:
    """Where each value stands; of lists the first item."""
    items = document.items() if isinstance(document, dict) else enumerate(document[:1])
    for key, value in items:
        yield (key,)
        if isinstance(value, dict | list):
            yield from ((key, *below) for below in _paths(value))


def exr(width: int, height: int) -> bytes:
    """The header of an EXR of any size, without pixels."""

    def attribute(name: str, kind: str, value: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    channels = b"".join(c + b"\0" + struct.pack("<iBBBBii", 2, 0, 0, 0, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    return (
        struct.pack("<ii", 20000630, 2)
        + attribute("channels", "chlist", channels)
        + attribute("compression", "compression", b"\0")
        + attribute("dataWindow", "box2i", window)
        + attribute("displayWindow", "box2i", window)
        + attribute("lineOrder", "lineOrder", b"\0")
        + attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0))
        + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0))
        + attribute("screenWindowWidth", "float", struct.pack("<f", 1.0))
        + b"\0"
    )


def radiance_hdr(width: int, height: int) -> bytes:
    """The header of a Radiance picture of any size, without pixels."""
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
