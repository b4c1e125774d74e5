"""A picture as the bytes of a PNG file, by the standard library alone."""

from __future__ import annotations

import struct
import zlib

import numpy as np

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOUR = 2  # red, green and blue, without a palette


def png(picture: np.ndarray) -> bytes:
    """The file of a picture (h, w, 3) uint8 in sRGB, row 0 at the top (PNG, third edition, W3C 2025).

    Raises:
        ValueError: it has another shape or type, or no pixel.
    """
    if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape[2] != 3 or not picture.size:
        raise ValueError(f"a PNG is made of (h, w, 3) uint8, not of {picture.shape} {picture.dtype}")
    height, width = picture.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # a row begins with its filter: none
    rows[:, 1:] = picture.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, _COLOUR, 0, 0, 0)
    parts = (_chunk(b"IHDR", header), _chunk(b"sRGB", b"\0"), _chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)))
    return _SIGNATURE + b"".join(parts) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
