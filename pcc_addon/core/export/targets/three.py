"""three.js: right-handed, Y up; a cubemap that is no render target is seen with X turned round."""

from __future__ import annotations

from ..axes import Axes
from ..ladders import OWN_LEVELS, own
from ..languages import GLSL
from ..target import Picture, Target

TARGET = Target(
    key="three",
    title="three.js",
    axes=Axes("+X", "+Z", "-Y"),
    units=1.0,
    sampled=Axes("-X", "+Y", "+Z"),
    pictures=(Picture.KTX2, Picture.EQUIRECT_HDR),
    language=GLSL,
    roughness_of=own,  # its own levels are an atlas that it makes of the equirectangular picture as it loads
    levels=OWN_LEVELS,
    beside=("parallax_probes_three.js",),
)
