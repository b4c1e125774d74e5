"""How to run refracted.json against an implementation: replace `seen_through` by yours. Standard library only."""

import math

from checking import angle, dot, plus, read, scaled, tell, unit
from example_runner import towards_exit


def bent(ray, normal, index):
    """The bent ray and whether there is one; the normal is on the side that the ray comes from."""
    cosine = max(-dot(ray, normal), 0.0)
    rest = 1.0 - (1.0 - cosine * cosine) / (index * index)
    direction = plus(scaled(ray, 1.0 / index), scaled(normal, cosine / index - math.sqrt(max(rest, 0.0))))
    return direction, rest > 0.0


def seen_through(case):
    """The ray behind the surface, from where beside it, and whether light passes."""
    straight, normal, index = scaled(case["incoming"], -1.0), unit(case["normal"]), case["ior"]
    if case["interface"] == "thin pane":
        return straight, [0.0, 0.0, 0.0], True
    straight = unit(straight)
    if case["interface"] == "one interface":
        direction, passes = bent(straight, normal, 1.0 / index if case["backfacing"] else index)
        return direction if passes else straight, [0.0, 0.0, 0.0], passes
    inside, _ = bent(straight, normal, index)
    half, axes = scaled(case["dimensions"], 0.5), case["axes"]
    near = unit([h * dot(axis, normal) for h, axis in zip(half, axes, strict=True)])
    way = [dot(axis, inside) / h for h, axis in zip(half, axes, strict=True)]
    length = -2.0 * dot(near, way) / dot(way, way)
    far = [(n + length * w) / h for n, w, h in zip(near, way, half, strict=True)]
    leaving = unit([-dot([axis[k] for axis in axes], far) for k in range(3)])
    direction, passes = bent(inside, leaving, 1.0 / index)
    mirrored = plus(inside, scaled(leaving, -2.0 * dot(inside, leaving)))
    return direction if passes else mirrored, scaled(inside, length), passes


def right(case):
    ray, offset, passes = seen_through(case)
    found = towards_exit(case, plus(case["position"], offset), ray)
    return case["passes"] in (None, passes) and angle(found, case["direction"]) <= case["tolerance"]


if __name__ == "__main__":
    cases = read("refracted.json")["cases"]
    tell(len(cases), [f"{case['interface']}: {case['family']}" for case in cases if not right(case)])
