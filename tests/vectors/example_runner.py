"""How to run lookup.json against an implementation: replace `lookup` and `weight` by yours. Standard library only."""

import json
import math
from pathlib import Path


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def lookup(case):
    """The direction to look up, of any length, for one case."""
    point, eye, normal = case["position"], case["incoming"], case["normal"]
    bend = 2.0 * dot(eye, normal) / (dot(normal, normal) or 1.0)
    ray = [bend * n - e for n, e in zip(normal, eye, strict=True)]
    nearness = 0.0
    for face, half in zip(case["face_normals"], case["half_widths"], strict=True):
        speed, q = dot(face, ray), dot(face, [p - c for p, c in zip(point, case["centre"], strict=True)])
        nearness = max(nearness, abs(speed) / max(half - math.copysign(q, q * speed), 1e-12))
    return [(p - b) * nearness + r for p, b, r in zip(point, case["capture_point"], ray, strict=True)]


def stretched(case):
    """The same for a cubemap that was not captured in the box: along its axes, where the box is a cube."""
    exit = lookup(case | {"capture_point": case["centre"]})
    return [dot(face, exit) / half for face, half in zip(case["face_normals"], case["half_widths"], strict=True)]


def weight(case):
    """How much of the point the probe has, 0 to 1."""
    offset = [p - c for p, c in zip(case["position"], case["centre"], strict=True)]
    beyond = max(abs(dot(n, offset)) - h for n, h in zip(case["face_normals"], case["half_widths"], strict=True))
    share = min(max(1.0 - (beyond - case["padding"]) / case["falloff"], 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


def angle(a, b):
    """Radians between two vectors, exact for small angles too; half a turn for no direction at all."""
    cross = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
    return math.atan2(math.hypot(*cross), dot(a, b)) if any(a) else math.pi


cases = json.loads(Path(__file__).with_name("lookup.json").read_text(encoding="utf-8"))["cases"]
wrong = [case for case in cases if not angle(lookup(case), case["direction"]) <= case["tolerance"]]
wrong += [c for c in cases if not angle(stretched(c), c["stretched_direction"]) <= c["stretched_tolerance"]]
wrong += [case for case in cases if not abs(weight(case) - case["weight"]) <= case["weight_tolerance"]]
print(f"{len(cases)} cases, {len(wrong)} wrong", *sorted({case["family"] for case in wrong}), sep="\n")
raise SystemExit(bool(wrong))
