"""Changes that no test can notice, because they change nothing that anybody could see."""

from __future__ import annotations

_GROWN = (
    "probe.box.axes * (1.0 + margin / probe.box.half_widths) for probe, margin in zip(probes, margins, strict=True)"
)
_NEAR = "near = ((lows <= high) & (highs >= low)).all(1).nonzero()[0].tolist()"
_MEAN = "return float(inside), float((distances / probe.box.half_widths).max(-1).mean())"
_SHARED_DEPTH = "box = Correction.ORIENTED_BOX if effects.correction is Correction.NONE else effects.correction"
_NONE_LEFT = "return replace(shading, reflectance=single, left=shading.left * 0.0)"
_CRITICAL = "return np.where(g2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)"
_GRAZING = 'cosine = Section("View angle", clamp(dot(NORMAL, INCOMING), 1e-12))'

EQUIVALENT: dict[tuple[str, str, str, str], str] = {
    ("core/belonging.py", _NEAR, "highs >= low", "highs > low"): "a coarse test before an exact one",
    ("core/belonging.py", _MEAN, "-1", "1"): "the last axis of two",
    ("core/belonging.py", _GROWN, "strict=True", ""): "both are as long",
    ("core/belonging.py", _GROWN, "True", "False"): "both are as long",
    (
        "core/effects/lookup.py", _SHARED_DEPTH,
        "Correction.ORIENTED_BOX if effects.correction is Correction.NONE else effects.correction",
        "effects.correction",
    ): "the same nodes under another title",
    ("core/effects/glossy.py", _NONE_LEFT, "shading.left * 0.0", "shading.left / 0.0"): "nodes divide by 0 to 0",
    ("core/effects/fresnel.py", _CRITICAL, "g2 > 0.0", "g2 >= 0.0"): "at the critical angle both are 1",
    ("core/effects/surface.py", _GRAZING, "1e-12", "1.5e-12"): "as good as 0",
}  # fmt: skip
"""Why, by module, source line without its indentation, what was replaced, and by what."""
