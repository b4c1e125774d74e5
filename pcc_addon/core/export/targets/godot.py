"""Godot 4: right-handed, Y up; shaders sample cubemaps along the world's directions."""

from __future__ import annotations

from ..axes import AS_IT_IS, Axes
from ..ladders import OWN_LEVELS, own
from ..languages import GODOT
from ..target import Picture, Target

TARGET = Target(
    key="godot",
    title="Godot",
    axes=Axes("+X", "+Z", "-Y"),
    units=1.0,
    sampled=AS_IT_IS,
    pictures=(Picture.DDS,),
    language=GODOT,
    roughness_of=own,  # its own levels are made by its renderer, of its own probes and skies only
    levels=OWN_LEVELS,
    beside=("PROBE.gdshader",),
)
