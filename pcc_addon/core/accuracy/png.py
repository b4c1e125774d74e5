"""Pictures as PNG files, without a library: eight bits, sRGB."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np

from .files import write_aside


def png_of(picture: np.ndarray, exposure: float = 0.0) -> bytes:
    """The bytes of a PNG (ISO/IEC 15948) of a (h, w, 3) linear picture, first row on top.

    Values are encoded as sRGB says (IEC 61966-2-1); what is above white is white, what is no number is black.

    Args:
        exposure: stops by which it is brightened.
    """
    linear = np.clip(np.nan_to_num(picture.astype(np.float64) * 2.0**exposure, nan=0.0, posinf=1.0), 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return png_of_bytes(np.rint(encoded * 255.0).astype(np.uint8))


def png_of_bytes(pixels: np.ndarray) -> bytes:
    """The bytes of a PNG of (h, w, 3) uint8, encoded already.

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


def write_png(path: Path, picture: np.ndarray, exposure: float = 0.0) -> None:
    """Write a (h, w, 3) linear picture aside, then into place.

    Raises:
        PccError: it cannot be written.
    """
    write_aside(path, png_of(picture, exposure))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
