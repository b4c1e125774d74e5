"""Pictures as PNG files, without a library: eight bits, sRGB."""

from __future__ import annotations

import struct
import zlib

import numpy as np


def png_of_bytes(pixels: np.ndarray) -> bytes:
    """The bytes of a PNG (ISO/IEC 15948) of (h, w, 3) uint8, encoded already, first row on top.

    Raises:
        ValueError: the pixels are of another shape or type.
    """
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 3 or not pixels.size:
        raise ValueError(f"(h, w, 3) bytes of uint8 are needed, and not {pixels.shape} of {pixels.dtype}")
    height, width = pixels.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # a row begins with its filter: 0, none
    rows[:, 1:] = pixels.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    content = [(b"IHDR", header), (b"sRGB", b"\0"), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in content)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
