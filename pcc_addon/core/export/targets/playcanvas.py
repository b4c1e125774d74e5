"""PlayCanvas: right-handed, Y up; cubemaps are sampled with X turned round."""

from __future__ import annotations

from ..axes import Axes
from ..ladders import OWN_LEVELS, own
from ..languages import GLSL
from ..target import Picture, Target

TARGET = Target(
    key="playcanvas",
    title="PlayCanvas",
    axes=Axes("+X", "+Z", "-Y"),
    units=1.0,
    sampled=Axes("-X", "+Y", "+Z"),
    pictures=(Picture.DDS,),
    language=GLSL,
    roughness_of=own,  # its own levels are an atlas that it makes of a cubemap as it loads
    levels=OWN_LEVELS,
    beside=("parallax_probes_playcanvas.js",),
)
