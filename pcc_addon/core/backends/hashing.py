"""Random numbers by the bits of three floats, as Blender's White Noise node gives them in 3D.

Source: the mixing steps of Bob Jenkins' lookup3 (2006, public domain), which Blender's renderers hash with.
"""

from __future__ import annotations

import numpy as np

_START = 0xDEADBEEF + 13  # and four times the number of words


def random(key: np.ndarray) -> np.ndarray:
    """Three numbers of 0 … 1 (…, 3) for keys (…, 3); the key's bits in single precision count."""
    with np.errstate(over="ignore"):
        x, y, z = (np.array(part, np.float32).view(np.uint32) for part in np.moveaxis(key, -1, 0))
        found = [_of_three(x, y, z), *(_of_four(x, y, z, np.float32(salt)) for salt in (1.0, 2.0))]
        shares = [word.astype(np.float32) / np.float32(0xFFFFFFFF) for word in found]
    return np.stack(shares, -1).astype(key.dtype)


def _of_three(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    start = np.uint32((_START + 12) & 0xFFFFFFFF)
    return _final(start + x, start + y, start + z)


def _of_four(x: np.ndarray, y: np.ndarray, z: np.ndarray, salt: np.float32) -> np.ndarray:
    start = np.uint32((_START + 16) & 0xFFFFFFFF)
    a, b, c = start + x, start + y, start + z
    for turns in ((4, 6, 8), (16, 19, 4)):
        a, c = (a - c) ^ _rotated(c, turns[0]), c + b
        b, a = (b - a) ^ _rotated(a, turns[1]), a + c
        c, b = (c - b) ^ _rotated(b, turns[2]), b + a
    return _final(a + salt.view(np.uint32), b, c)


def _final(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    for turns in ((14, 11, 25), (16, 4, 14)):
        c = (c ^ b) - _rotated(b, turns[0])
        a = (a ^ c) - _rotated(c, turns[1])
        b = (b ^ a) - _rotated(a, turns[2])
    return (c ^ b) - _rotated(b, 24)


def _rotated(x: np.ndarray, k: int) -> np.ndarray:
    return (x << np.uint32(k)) | (x >> np.uint32(32 - k))
