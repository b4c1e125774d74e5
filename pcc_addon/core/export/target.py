"""What an engine is to us: its axes, its lengths, how it samples cubemaps, and what it reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from .axes import Axes
from .languages import Language


class Picture(Enum):
    """The files that pictures may be in."""

    KTX2 = "ktx2"  # the cubemap with its levels
    DDS = "dds"  # the same
    FACES = "faces"  # six EXR files of the sharpest level, as they look from inside, the first row on top
    EQUIRECT_EXR = "exr"  # the capture as Blender has it
    EQUIRECT_HDR = "hdr"  # the same


PROBE = "PROBE"


@dataclass(frozen=True)
class Target:
    """An engine.

    Attributes:
        key: its name in commands.
        title: its name in words.
        axes: its world's axes in Blender's, as its own importers of glTF or FBX place what comes from Blender.
        units: its lengths in a metre.
        sampled: the axes of what its shaders give to a cubemap's sampler, in its world's.
        pictures: the files that it reads.
        language: of its shaders.
        roughness_of: the GGX roughness of a level of a cubemap of so many texels a face, as its own materials read it.
        levels: how many levels there are at most.
        beside: files that are copied beside the export, such as what loads it; once for each probe where their name has
            `PROBE` in it, which becomes the name of the probe's files there and in the text.
    """

    key: str
    title: str
    axes: Axes
    units: float
    sampled: Axes
    pictures: tuple[Picture, ...]
    language: Language
    roughness_of: Callable[[int, int], float]
    levels: int
    beside: tuple[str, ...] = ()

    @property
    def from_sampler(self) -> np.ndarray:
        """(3, 3): from a sampler's directions to those of Blender's world."""
        return (self.sampled.matrix @ self.axes.matrix).T

    def roughnesses(self, width: int) -> tuple[float, ...]:
        """Of the levels of a cubemap of `width` texels a face: ascending from 0, and as far as its lookup reads.

        Files have all levels down to a single texel, as some engines want; those after the last have its roughness.
        """
        found = [0.0]
        for level in range(1, min(self.levels, width.bit_length())):
            roughness = min(self.roughness_of(level, width), 1.0)
            if roughness > found[-1]:
                found.append(roughness)
        return tuple(found)
