"""Nobody in particular: Blender's own world, and every kind of file."""

from __future__ import annotations

from ..axes import AS_IT_IS, Axes
from ..ladders import OWN_LEVELS, own
from ..languages import GLSL
from ..target import Picture, Target

TARGET = Target(
    key="generic",
    title="any engine",
    axes=AS_IT_IS,
    units=1.0,
    sampled=Axes("+X", "+Z", "+Y"),  # so that faces look right from inside: as `layouts.py` reads them
    pictures=tuple(Picture),
    language=GLSL,
    roughness_of=own,
    levels=OWN_LEVELS,
)
