"""Babylon.js: left-handed, Y up, as its glTF loader turns what it loads."""

from __future__ import annotations

import math

from ..axes import AS_IT_IS, Axes
from ..languages import GLSL
from ..target import Picture, Target


def _roughness(level: int, width: int) -> float:
    """Its materials read level 0.8 · log₂(alpha · width): `getLodFromAlphaG`, and `lodGenerationScale` of 0.8."""
    return math.sqrt(2.0 ** (level / 0.8) / width)


TARGET = Target(
    key="babylon",
    title="Babylon.js",
    axes=Axes("-X", "+Z", "-Y"),
    units=1.0,
    sampled=AS_IT_IS,
    pictures=(Picture.DDS,),
    language=GLSL,
    roughness_of=_roughness,
    levels=13,
    beside=("parallax_probes_babylon.js",),
)
