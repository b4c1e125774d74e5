"""Unreal Engine: left-handed, Z up, centimetres; cubemaps are sampled along the world's directions."""

from __future__ import annotations

from ..axes import AS_IT_IS, Axes
from ..languages import UNREAL
from ..target import Picture, Target


def _roughness(level: int, width: int) -> float:
    """Its materials read 1.2 · log₂ r levels beyond that of 2 × 2 texels.

    Source: `ComputeReflectionCaptureMipFromRoughness` in its shaders.
    """
    levels_to_one_texel = width.bit_length()
    return 2.0 ** ((level + 2 - levels_to_one_texel) / 1.2)


TARGET = Target(
    key="unreal",
    title="Unreal Engine",
    axes=Axes("+X", "-Y", "+Z"),
    units=100.0,
    sampled=AS_IT_IS,
    pictures=(Picture.DDS,),
    language=UNREAL,
    roughness_of=_roughness,
    levels=13,
)
