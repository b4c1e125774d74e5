"""Unity: left-handed, Y up, as FBX and glTF from Blender come in."""

from __future__ import annotations

import math

from ..axes import AS_IT_IS, Axes
from ..languages import UNITY
from ..target import Picture, Target

_STEPS = 6  # UNITY_SPECCUBE_LOD_STEPS


def _roughness(level: int, width: int) -> float:
    """Its materials read level 6 · r · (1.7 − 0.7 r): `PerceptualRoughnessToMipmapLevel` of its pipelines."""
    return (1.7 - math.sqrt(max(1.7**2 - 2.8 * level / _STEPS, 0.0))) / 1.4


TARGET = Target(
    key="unity",
    title="Unity",
    axes=Axes("-X", "+Z", "-Y"),
    units=1.0,
    sampled=AS_IT_IS,
    pictures=(Picture.DDS,),
    language=UNITY,
    roughness_of=_roughness,
    levels=_STEPS + 1,
    beside=("ParallaxProbesImporter.cs", "PROBE.shader"),
)
