"""Changes that no test can notice, because they change nothing that anybody could see."""

from __future__ import annotations

_GROWN = (
    "probe.box.axes * (1.0 + margin / probe.box.half_widths) for probe, margin in zip(probes, margins, strict=True)"
)
_NEAR = "near = ((lows <= high) & (highs >= low)).all(1).nonzero()[0].tolist()"
_MEAN = "return float(inside), float((distances / probe.box.half_widths).max(-1).mean())"

EQUIVALENT: dict[tuple[str, str, str, str], str] = {
    ("core/belonging.py", _NEAR, "highs >= low", "highs > low"): "a coarse test before an exact one",
    ("core/belonging.py", _MEAN, "-1", "1"): "the last axis of two",
    ("core/belonging.py", _GROWN, "strict=True", ""): "both are as long",
    ("core/belonging.py", _GROWN, "True", "False"): "both are as long",
}
"""Why, by module, source line without its indentation, what was replaced, and by what."""
