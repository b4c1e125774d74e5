"""How to run shares.json against an implementation: replace `parts` by yours. Standard library only."""

import math

from checking import near, read, tell


def parts(case):
    """What each probe has of the point, and the own lobe at last; two are mixed at a time, as shaders do."""
    shown, coverage = [1.0], case["weight"][0]
    outside = [max(-depth, 0.0) for depth in case["depth"]]
    for k in range(1, len(outside)):
        depth, weight, fade = (case[name][k] for name in ("depth", "weight", "fade"))
        if case["apart"][k]:
            before = min(outside[j] for j in case["apart"][k])
            handed_over = min(before / (0.2 * fade), 1.0)
            covers = before**2 / ((before**2 + outside[k] ** 2) or 1.0) * handed_over * weight
        else:
            inside = min(max(1.0 + depth / fade, 0.0), 1.0)
            covers = min(weight, inside * inside * (3.0 - 2.0 * inside))
        coverage = covers + coverage * (1.0 - covers)
        share = covers / coverage if coverage else 0.0
        shown = [part * (1.0 - share) for part in shown] + [share]
    coverage *= 1.0 - case["diffuse"]
    return [part * coverage for part in shown] + [1.0 - coverage]


cases, steps = (read("shares.json")[name] for name in ("cases", "steps"))
found = [parts(case) for case in cases]
wrong = []
for case, shares in zip(cases, found, strict=True):
    whole = abs(math.fsum(shares) - 1.0) <= 4 * 2.0**-24 * len(case["depth"])
    wrong += [] if whole and near(shares, case["parts"], case["tolerances"]) else [case["family"]]
for step in steps:
    rounding = max(cases[step["second"]]["tolerances"]) + max(cases[step["first"]]["tolerances"])
    change = [abs(a - b) for a, b in zip(found[step["first"]], found[step["second"]], strict=True)]
    wrong += [] if max(change) <= step["most"] + rounding else ["steps"]
tell(len(cases) + len(steps), wrong)
