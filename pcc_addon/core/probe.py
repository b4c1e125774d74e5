"""A probe as plain data: its box, its capture point and the settings of its bake."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from .effects import Correction, LookupEffects, Outside
from .errors import ProbeError

MINIMUM_RESOLUTION, MAXIMUM_RESOLUTION = 16, 4096
_FLATTEST = 1e-9  # smallest accepted ratio of a box's volume to that of a box with the same edge lengths
_ULP = float(np.finfo(np.float32).eps)
_INFINITE = float(np.finfo(np.float32).max)  # Blender turns an infinity that a script sets into this


class Engine(str, Enum):
    """Which renderer takes the six pictures."""

    CYCLES = "CYCLES"
    EEVEE = "EEVEE"


@dataclass(frozen=True)
class Box:
    """A proxy box: the image of [−1, 1]³ under a 4×4 matrix; a parallelepiped where a parent shears it.

    Attributes:
        matrix: 16 floats, row by row, box to world, metres.
    """

    matrix: tuple[float, ...]

    @classmethod
    def from_matrix(cls, name: str, matrix: np.ndarray) -> Box:
        """The box of a probe called `name` with a (4, 4) object-to-world matrix.

        Raises:
            ProbeError: the matrix is not finite, or the box has no volume.
        """
        m = np.asarray(matrix, np.float64)
        if not (np.abs(m) < _INFINITE).all():
            raise ProbeError(f"probe '{name}': its transform is not finite; reset its location, rotation and scale")
        lengths = np.linalg.norm(m[:3, :3], axis=0)
        if not (lengths > 0).all():
            axes = ", ".join(axis for axis, length in zip("XYZ", lengths, strict=True) if not length > 0)
            raise ProbeError(f"probe '{name}': its box has zero size along {axes}; give it a scale other than 0")
        if abs(np.linalg.det(m[:3, :3] / lengths)) < _FLATTEST:
            raise ProbeError(f"probe '{name}': its parents flatten its box; remove their shear or zero scale")
        return cls(tuple(float(v) for v in m.ravel()))

    @property
    def axes(self) -> np.ndarray:
        """(3, 3) float64, columns: half edges in world space, metres."""
        return np.array(self.matrix).reshape(4, 4)[:3, :3]

    @property
    def centre(self) -> np.ndarray:
        """(3,) float64, world space, metres."""
        return np.array(self.matrix).reshape(4, 4)[:3, 3]

    @property
    def half_extents(self) -> np.ndarray:
        """(3,) float64, metres, along the box's own axes."""
        return np.linalg.norm(self.axes, axis=0)

    @property
    def rows(self) -> np.ndarray:
        """(3, 3) float64, rows of the inverse: box coordinates are rows @ (world − centre)."""
        return np.linalg.inv(self.axes)

    @property
    def is_aligned(self) -> bool:
        """Whether the box's axes are the world's axes, in order and of either sign."""
        axes = self.axes
        return bool((axes == np.diag(np.diag(axes))).all())


@dataclass(frozen=True)
class ProbeSpec:
    """All that a bake and its shaders need to know of a probe.

    Attributes:
        name: the object's name.
        box: the proxy box.
        capture_offset: of the capture point from the box's centre, metres along the box's own axes.
        resolution: face width, pixels.
        samples: per pixel.
        engine: which renderer takes the pictures.
        denoise: whether Cycles pictures are denoised.
        clip_start, clip_end: near and far plane of the capture's cameras, metres.
        padding: how far outside the box a surface still counts as inside, metres.
        falloff: over which distance beyond that the reflection fades, metres.
        outside: what a surface beyond the falloff shows.
        corrected: False for the classic, uncorrected lookup.
        hidden: names of objects that the capture leaves out.
    """

    name: str
    box: Box
    capture_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    resolution: int = 512
    samples: int = 64
    engine: Engine = Engine.CYCLES
    denoise: bool = True
    clip_start: float = 0.01
    clip_end: float = 1000.0
    padding: float = 0.01
    falloff: float = 0.25
    outside: Outside = Outside.UNCORRECTED
    corrected: bool = True
    hidden: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        if not MINIMUM_RESOLUTION <= self.resolution <= MAXIMUM_RESOLUTION:
            raise ProbeError(
                f"probe '{self.name}': face resolution {self.resolution} is not between {MINIMUM_RESOLUTION} "
                f"and {MAXIMUM_RESOLUTION} pixels"
            )
        if self.samples < 1:
            raise ProbeError(f"probe '{self.name}': {self.samples} samples; take at least 1")
        if not 0.0 < self.clip_start < self.clip_end:
            raise ProbeError(
                f"probe '{self.name}': clip start {self.clip_start:g} m must be above 0 and below "
                f"clip end {self.clip_end:g} m"
            )
        if not np.isfinite(self.capture_offset).all():
            raise ProbeError(f"probe '{self.name}': its capture offset is not finite; reset it")

    @property
    def capture_point(self) -> np.ndarray:
        """(3,) float64, world space, metres: where the cameras stand."""
        unit_axes = self.box.axes / self.box.half_extents
        return self.box.centre + unit_axes @ np.array(self.capture_offset)

    def effects(self, all_inside: bool) -> LookupEffects:
        """The lookup effects that the probe calls for; `all_inside`: no surface that shows it leaves its box."""
        if not self.corrected:
            return LookupEffects(Correction.NONE, None)
        correction = Correction.ALIGNED_BOX if self.box.is_aligned else Correction.ORIENTED_BOX
        return LookupEffects(correction, None if all_inside else self.outside)

    @property
    def influence_padding(self) -> float:
        """The padding, widened by what float32 positions this far from the origin cannot tell apart, metres."""
        reach = float(np.abs(self.box.centre).max() + np.linalg.norm(self.box.half_extents))
        return self.padding + 4.0 * _ULP * reach

    def contains(self, corners: np.ndarray) -> bool:
        """Whether world-space points (n, 3), and all between them, lie within the box and its padding."""
        coordinates = np.abs((corners - self.box.centre) @ self.box.rows.T)
        return bool((coordinates <= 1.0 + self.influence_padding / self.box.half_extents).all())

    def overlaps(self, corners: np.ndarray) -> bool:
        """Whether a convex cloud of world-space points (n, 3) may reach into the influence volume.

        Tests separation along the box's face normals only, so it errs towards True.
        """
        coordinates = (corners - self.box.centre) @ self.box.rows.T
        limit = 1.0 + (self.influence_padding + self.falloff) / self.box.half_extents
        return bool((coordinates.max(0) >= -limit).all() and (coordinates.min(0) <= limit).all())
