"""Files of a whole cubemap with its levels, in half precision, as engines read them.

Neither Blender nor a library that it bundles writes such files: its OpenImageIO reads DDS and knows no KTX2.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from .cubemaps import Level

_FOURCC_RGBA16F = 113  # D3DFMT_A16B16G16R16F: what most engines know, and longer than DXGI's number for the same
_VK_RGBA16F = 97  # VK_FORMAT_R16G16B16A16_SFLOAT
_TEXEL = 8  # bytes


def dds(levels: Sequence[Level]) -> bytes:
    """A DirectDraw Surface (Microsoft, "Programming Guide for DDS"): one face after the other, each with its levels."""
    width = levels[0].shape[1]
    flags = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000 | 0x20000  # caps, height, width, pitch, pixel format, mipmap count
    header = struct.pack("<7I44x", 124, flags, width, width, width * _TEXEL, 0, len(levels))
    header += struct.pack("<3I20x", 32, 0x4, _FOURCC_RGBA16F)
    header += struct.pack("<5I", 0x8 | 0x1000 | 0x400000, 0x200 | 0xFC00, 0, 0, 0)  # complex texture mipmap; all faces
    texels = [_half(level[face]) for face in range(6) for level in levels]
    return b"".join([b"DDS ", header, *texels])


def ktx2(levels: Sequence[Level], writer: str) -> bytes:
    """A KTX 2.0 file (Khronos): the smallest level first, each with its six faces; `writer` is who wrote it."""
    width, count = levels[0].shape[1], len(levels)
    descriptor = _rgba16f_descriptor()
    values = b"".join(_entry(key, value) for key, value in (("KTXorientation", "rd"), ("KTXwriter", writer)))
    at_descriptor = 80 + 24 * count
    at_values = at_descriptor + len(descriptor)
    start = _aligned(at_values + len(values))
    body, index = [b"\0" * (start - at_values - len(values))], []
    for level in reversed(levels):
        texels = _half(level)
        index.append(struct.pack("<3Q", start, len(texels), len(texels)))
        body.append(texels)
        start += len(texels)
    head = b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<9I", _VK_RGBA16F, 2, width, width, 0, 0, 6, count, 0)
    head += struct.pack("<4I2Q", at_descriptor, len(descriptor), at_values, len(values), 0, 0)
    return b"".join([head, *reversed(index), descriptor, values, *body])


def _half(texels: np.ndarray) -> bytes:
    opaque = np.ones((*texels.shape[:-1], 4), "<f2")
    opaque[..., :3] = np.minimum(texels, np.finfo(np.float16).max)
    return opaque.tobytes()


def _rgba16f_descriptor() -> bytes:
    """The data format descriptor (Khronos Data Format Specification 1.3): linear BT.709, four signed half floats."""
    samples = [
        struct.pack("<HBB4x2f", 16 * place, 15, 0xC0 | channel, -1.0, 1.0)
        for place, channel in enumerate((0, 1, 2, 15))
    ]
    block = struct.pack("<IHH", 0, 2, 24 + 16 * len(samples)) + struct.pack("<4B4x8B", 1, 1, 1, 0, _TEXEL, *[0] * 7)
    whole = b"".join([block, *samples])
    return struct.pack("<I", 4 + len(whole)) + whole


def _entry(key: str, value: str) -> bytes:
    pair = key.encode() + b"\0" + value.encode() + b"\0"
    return struct.pack("<I", len(pair)) + pair + b"\0" * (-len(pair) % 4)


def _aligned(place: int) -> int:
    return place + -place % _TEXEL
