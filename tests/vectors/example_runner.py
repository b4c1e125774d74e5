"""How to run lookup.json against an implementation: replace `lookup` and the others by yours. Standard library only."""

import math

from checking import angle, dot, plus, read, scaled, tell


def reflected(case):
    """The reflected ray."""
    eye, normal = case["incoming"], case["normal"]
    bend = 2.0 * dot(eye, normal) / (dot(normal, normal) or 1.0)
    return plus(scaled(normal, bend), scaled(eye, -1.0))


def towards_exit(case, start, ray):
    """From the capture point to where a ray leaves the box, over the ray's length."""
    nearness = 0.0
    for face, half in zip(case["face_normals"], case["half_widths"], strict=True):
        speed, q = dot(face, ray), dot(face, plus(start, scaled(case["centre"], -1.0)))
        nearness = max(nearness, abs(speed) / max(half - math.copysign(q, q * speed), 1e-12))
    return plus(scaled(plus(start, scaled(case["capture_point"], -1.0)), nearness), ray)


def lookup(case):
    """The direction to look up, of any length, for one case."""
    return towards_exit(case, case["position"], reflected(case))


def stretched(case):
    """The same for a cubemap that was not captured in the box: along its axes, where the box is a cube."""
    exit = lookup(case | {"capture_point": case["centre"]})
    return [dot(face, exit) / half for face, half in zip(case["face_normals"], case["half_widths"], strict=True)]


def spread(case):
    """What the roughness is multiplied by where contacts are hardened."""
    return min(max(1.0 / math.sqrt(max(math.hypot(*lookup(case)), 1e-6)), 0.35), 1.5)


def weight(case):
    """How much of the point the probe has, 0 to 1."""
    offset = plus(case["position"], scaled(case["centre"], -1.0))
    beyond = max(abs(dot(n, offset)) - h for n, h in zip(case["face_normals"], case["half_widths"], strict=True))
    share = min(max(1.0 - (beyond - case["padding"]) / case["falloff"], 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


def right(case):
    return (
        angle(lookup(case), case["direction"]) <= case["tolerance"]
        and angle(stretched(case), case["stretched_direction"]) <= case["stretched_tolerance"]
        and abs(spread(case) - case["spread"]) <= case["spread_tolerance"]
        and abs(weight(case) - case["weight"]) <= case["weight_tolerance"]
    )


if __name__ == "__main__":
    cases = read("lookup.json")["cases"]
    tell(len(cases), [case["family"] for case in cases if not right(case)])
