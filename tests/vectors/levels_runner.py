"""How to run levels.json against an implementation: replace `radiance` by yours. Standard library only."""

from bisect import bisect_right

from checking import near, plus, read, scaled, tell


def radiance(case):
    """Mixed from the two levels that the roughness lies between."""
    rungs, levels = case["rungs"], case["levels"]
    roughness = min(max(case["roughness"] * case["spread"], rungs[0]), rungs[-1])
    k = min(bisect_right(rungs, roughness), len(rungs) - 1)
    share = (roughness - rungs[k - 1]) / (rungs[k] - rungs[k - 1])
    return plus(scaled(levels[k - 1], 1.0 - share), scaled(levels[k], share))


cases = read("levels.json")["cases"]
tell(len(cases), [c["family"] for c in cases if not near(radiance(c), c["radiance"], c["tolerances"])])
