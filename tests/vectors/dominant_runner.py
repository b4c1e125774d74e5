"""How to run dominant.json against an implementation: replace `direction` by yours. Standard library only."""

import math

from checking import angle, dot, plus, read, scaled, tell, unit

GRID = 40  # facets a side


def direction(case):
    """Halfway between the mirrored view and the mean of what facets mirror to the eye, drawn by their number."""
    view, normal = unit(case["incoming"]), unit(case["normal"])
    cosine, alpha = min(dot(view, normal), 1.0), case["roughness"] ** 2
    mirrored = plus(scaled(normal, 2.0 * cosine), scaled(view, -1.0))
    if not alpha:
        return mirrored
    sine, mean = math.sqrt(1.0 - cosine * cosine), [0.0, 0.0]
    for i in range(GRID):
        share = (i + 0.5) / GRID
        steep = math.sqrt(1.0 + (alpha * alpha - 1.0) * (1.0 - share * share))
        up, weight = share / steep, steep
        for j in range(GRID):
            aside = math.sqrt(1.0 - up * up) * math.cos(math.pi * (j + 0.5) / GRID)
            on_facet = sine * aside + cosine * up
            x, z = 2.0 * on_facet * aside - sine, 2.0 * on_facet * up - cosine
            if on_facet > 0.0 and z > 0.0:
                masking = 1.0 / (1.0 + hidden(cosine, alpha) + hidden(z, alpha))
                light = weight * masking * on_facet * fresnel(on_facet, case["ior"])
                mean = [mean[0] + light * x, mean[1] + light * z]
    # in the plane of normal and view: the mean of two unit vectors is halfway by the angle
    across = unit(plus(mirrored, scaled(normal, -cosine)))
    return plus(mirrored, unit(plus(scaled(across, -mean[0]), scaled(normal, mean[1]))))


def hidden(cosine, alpha):
    return 0.5 * (math.sqrt(1.0 + alpha * alpha * (1.0 / cosine**2 - 1.0)) - 1.0)


def fresnel(cosine, ior):
    if ior is None:
        return 1.0
    inside = math.sqrt(1.0 - (1.0 - cosine * cosine) / ior**2)
    across, along = (cosine - ior * inside) / (cosine + ior * inside), (inside - ior * cosine) / (inside + ior * cosine)
    return 0.5 * (across**2 + along**2)


cases = read("dominant.json")["cases"]
wrong = [f"{c['facets']}: {c['family']}" for c in cases if not angle(direction(c), c["direction"]) <= c["tolerance"]]
tell(len(cases), wrong)
