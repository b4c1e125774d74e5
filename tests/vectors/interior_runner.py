"""How to run interior.json against an implementation: replace `lookup` and `random` by yours. Standard library only."""

import math
import struct

from checking import angle, near, read, tell


def lookup(case):
    """The direction to look up, of any length, for one case."""
    spot = [2.0 * (c - math.floor(c)) - 1.0 for c in case["place"]]
    spot.insert(1, -1.0)
    speed = [r / s for r, s in zip(case["ray"], case["size"], strict=True)]
    nearness = max(abs(v) / max(1.0 - math.copysign(o, o * v), 1e-8) for o, v in zip(spot, speed, strict=True) if v)
    x, y, z = (o * nearness + v for o, v in zip(spot, speed, strict=True))
    x *= case["mirror"]
    for _ in range(case["quarters"]):
        x, y = -y, x
    return [
        x * a + y * b + z * c - p * nearness for a, b, c, p in zip(*case["half_edges"], case["capture"], strict=True)
    ]


def random(key):
    """Three numbers of 0 to 1."""
    words = struct.unpack("<3I", struct.pack("<3f", *key))
    ones, final = 2**32 - 1, ((14, 11, 25), (16, 4, 14))

    def rotated(x, k):
        return (x << k | x >> (32 - k)) & ones

    def finished(a, b, c):
        for i, j, k in final:
            c = ((c ^ b) - rotated(b, i)) & ones
            a = ((a ^ c) - rotated(c, j)) & ones
            b = ((b ^ a) - rotated(a, k)) & ones
        return (((c ^ b) - rotated(b, 24)) & ones) / ones

    found = [finished(*((0xDEADBEEF + 25 + w) & ones for w in words))]
    for salt in (0x3F800000, 0x40000000):  # 1 and 2 as float32
        a, b, c = ((0xDEADBEEF + 29 + w) & ones for w in words)
        for i, j, k in ((4, 6, 8), (16, 19, 4)):
            a, c = (a - c & ones) ^ rotated(c, i), c + b & ones
            b, a = (b - a & ones) ^ rotated(a, j), a + c & ones
            c, b = (c - b & ones) ^ rotated(b, k), b + a & ones
        found.append(finished(a + salt & ones, b, c))
    return found


vectors = read("interior.json")
cases, keys = vectors["cases"], vectors["random"]
wrong = [case["family"] for case in cases if not angle(lookup(case), case["direction"]) <= case["tolerance"]]
wrong += ["random" for case in keys if not near(random(case["key"]), case["random"], [3e-7] * 3)]
tell(len(cases) + len(keys), wrong)
