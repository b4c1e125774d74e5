"""A PNG file holds what was put in."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

from pcc_addon.core.accuracy.png import png_of_bytes


def read(data: bytes) -> np.ndarray:
    """An independent reader of unfiltered 8 bit RGB, which checks each chunk's sum."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, pixels, size, kinds = 8, b"", (0, 0), []
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body)
        kinds.append(kind)
        if kind == b"IHDR":
            size = struct.unpack(">II", body[:8])
            assert tuple(body[8:]) == (8, 2, 0, 0, 0)
        elif kind == b"IDAT":
            pixels += body
        at += 12 + length
    assert kinds[0] == b"IHDR" and kinds[-1] == b"IEND"
    rows = np.frombuffer(zlib.decompress(pixels), np.uint8).reshape(size[1], 1 + 3 * size[0])
    assert (rows[:, 0] == 0).all()
    return rows[:, 1:].reshape(size[1], size[0], 3)


@pytest.mark.parametrize("shape", [(1, 1), (3, 7), (40, 21)])
def test_what_is_written_is_read(shape: tuple[int, int]) -> None:
    picture = np.random.default_rng(1).integers(0, 256, (*shape, 3), np.uint8)
    assert np.array_equal(read(png_of_bytes(picture)), picture)


def test_a_view_of_a_picture_is_written_as_it_looks() -> None:
    picture = np.random.default_rng(1).integers(0, 256, (6, 4, 3), np.uint8)
    assert np.array_equal(read(png_of_bytes(picture[::-1])), picture[::-1])


@pytest.mark.parametrize("wrong", [np.zeros((2, 2, 3)), np.zeros((2, 2), np.uint8), np.zeros((0, 2, 3), np.uint8)])
def test_other_arrays_are_refused(wrong: np.ndarray) -> None:
    with pytest.raises(ValueError, match="uint8"):
        png_of_bytes(wrong)
