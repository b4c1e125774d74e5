"""What the runners share: vectors of three numbers, and how a verdict is told. Standard library only."""

import json
import math
from pathlib import Path


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def scaled(a, factor):
    return [factor * x for x in a]


def plus(a, b):
    return [x + y for x, y in zip(a, b, strict=True)]


def unit(a):
    length = math.hypot(*a)
    return [x / length for x in a] if length else list(a)


def angle(a, b):
    """Radians between two vectors, exact for small angles too; half a turn for no direction at all."""
    cross = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
    return math.atan2(math.hypot(*cross), dot(a, b)) if any(a) else math.pi


def near(found, expected, tolerances):
    """Whether lists of numbers are the same to their tolerances."""
    return all(abs(f - e) <= t for f, e, t in zip(found, expected, tolerances, strict=True))


def read(name):
    """The sections of a file of vectors beside this one."""
    return json.loads(Path(__file__).with_name(name).read_text(encoding="utf-8"))


def tell(count, wrong):
    """Say how many cases are wrong and of which families; end with 1 if any is."""
    print(f"{count} cases, {len(wrong)} wrong", *sorted(set(wrong)), sep="\n")
    raise SystemExit(bool(wrong))
