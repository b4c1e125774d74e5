"""A probe as plain data: its box, its capture point and the settings of its bake."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property

import numpy as np

from .decisions import Effect, Forced
from .effects.records import Correction, Outside
from .errors import ProbeError
from .influence import Influence

MINIMUM_RESOLUTION, MAXIMUM_RESOLUTION = 16, 4096
MOST_SAMPLES = 2**24  # what Cycles takes
_FLATTEST = 1e-5  # smallest accepted ratio of a box's volume to that of a box with its edges; float32 ends near 1e-7
STEEPEST_FALLOFF = 1e-9  # metres: an edge
_ULP = float(np.finfo(np.float32).eps)
_UPRIGHT = 4.0 * _ULP  # how far, in radians, a box that counts as turned about the vertical may lean
_INFINITE = float(np.finfo(np.float32).max)  # Blender turns an infinity that a script sets into this


def _shared(array: np.ndarray) -> np.ndarray:
    """An array that is computed once and read by all."""
    array.flags.writeable = False
    return array


class Engine(str, Enum):
    """Which renderer takes the six pictures."""

    CYCLES = "CYCLES"
    EEVEE = "EEVEE"


class Source(str, Enum):
    """Where a probe's pictures come from."""

    BAKE = "BAKE"  # six renders from the capture point
    IMAGE = "IMAGE"  # a cubemap that the user gives, stretched to the box
    WORLD = "WORLD"  # the scene's world alone, stretched to the box

    @property
    def stretched(self) -> bool:
        """Whether the pictures were not captured in the box, so that they are stretched to it."""
        return self is not Source.BAKE


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

    @cached_property
    def axes(self) -> np.ndarray:
        """(3, 3) float64, columns: half edges in world space, metres."""
        return _shared(np.array(self.matrix).reshape(4, 4)[:3, :3])

    @cached_property
    def centre(self) -> np.ndarray:
        """(3,) float64, world space, metres."""
        return _shared(np.array(self.matrix).reshape(4, 4)[:3, 3])

    @cached_property
    def half_extents(self) -> np.ndarray:
        """(3,) float64, metres, along the box's own axes."""
        return _shared(np.linalg.norm(self.axes, axis=0))

    @cached_property
    def face_normals(self) -> np.ndarray:
        """(3, 3) float64, rows: unit normals of the faces that local X, Y and Z meet."""
        rows = np.linalg.inv(self.axes)
        return _shared(rows / np.linalg.norm(rows, axis=1, keepdims=True))

    @cached_property
    def half_widths(self) -> np.ndarray:
        """(3,) float64, metres, from the centre to each pair of faces; the half extents unless a parent shears."""
        return _shared(1.0 / np.linalg.norm(np.linalg.inv(self.axes), axis=1))

    @property
    def turn_mirror(self) -> np.ndarray:
        """(3,) float64, unit, horizontal: the mirror that takes a box turned about the vertical to the world's axes."""
        half_turn = math.atan2(self.axes[1, 0], self.axes[0, 0]) / 2.0
        return np.array([-math.sin(half_turn), math.cos(half_turn), 0.0])

    @property
    def correction(self) -> Correction:
        """The cheapest correction that fits the box."""
        axes = self.axes
        if (axes == np.diag(np.diag(axes))).all():
            return Correction.ALIGNED_BOX
        mirror = self.turn_mirror
        straight = axes - 2.0 * np.outer(mirror, mirror @ axes)
        rest = np.abs(straight - np.diag(np.diag(straight))) / self.half_extents
        return Correction.TURNED_BOX if (rest <= _UPRIGHT).all() else Correction.ORIENTED_BOX

    @property
    def own_axes_correction(self) -> Correction:
        """The cheapest correction that tells the directions of the box's own axes apart, not only its faces."""
        along_x = self.turn_mirror[1] == 1.0
        upright = self.axes[2, 2] > 0.0 and np.linalg.det(self.axes) > 0.0
        if not upright or self.correction is Correction.ORIENTED_BOX:
            return Correction.ORIENTED_BOX
        return self.correction if along_x else Correction.TURNED_BOX

    def along_own_axes(self, correction: Correction) -> np.ndarray:
        """(3,) of −1 and 1: whether what `lookup.along_face_normals` gives grows along the own axes or against."""
        if correction is Correction.ORIENTED_BOX:
            return np.ones(3)
        mirror = self.turn_mirror if correction is Correction.TURNED_BOX else np.zeros(3)
        return np.sign(np.diag(self.axes - 2.0 * np.outer(mirror, mirror @ self.axes)))

    def coordinates(self, points: np.ndarray) -> np.ndarray:
        """World-space points (n, 3) as metres from the centre along the face normals, (n, 3)."""
        return (points - self.centre) @ self.face_normals.T


@dataclass(frozen=True)
class ProbeSpec:
    """All that a bake and its shaders need to know of a probe.

    Attributes:
        name: the object's name.
        box: the proxy box.
        capture_offset: of the capture point from the box's centre, or from what it follows, metres along the box's own
            axes.
        resolution: face width, pixels.
        samples: per pixel.
        engine: which renderer takes the pictures.
        denoise: whether Cycles pictures are denoised.
        adaptive: the noise at which Cycles stops sampling a pixel; 0: it takes all samples everywhere.
        clip_start, clip_end: near and far plane of the capture's cameras, metres.
        padding: how far outside the box a surface still counts as inside, metres.
        falloff: over which distance beyond that the reflection fades, metres.
        outside: what a surface beyond the falloff shows.
        corrected: False for the classic, uncorrected lookup.
        relief: whether rays are followed through what was captured before the box's walls.
        relief_steps, relief_refinements: as `LookupEffects.steps` and `refinements`.
        half_float: whether pictures are kept in half precision.
        hidden: names of objects that the capture leaves out.
        animated: whether animation, constraints or parents may move it while nobody looks.
        source: where its pictures come from.
        picture: the file of an image, or one of its six; empty where none is chosen.
        influence: where, how much and by whom it is shown.
        followed: the origin of the object that the capture point follows, world space, metres; None: the box's centre.
        contact_hardening: whether rough surfaces show the sharper what is nearer to them.
        forced: effects that are on or off whatever the scene calls for.
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
    outside: Outside = Outside.OWN
    corrected: bool = True
    relief: bool = False
    relief_steps: int = 12
    relief_refinements: int = 4
    half_float: bool = False
    adaptive: float = 0.0
    hidden: tuple[str, ...] = field(default=())
    animated: bool = False
    source: Source = Source.BAKE
    picture: str = ""
    influence: Influence = field(default=Influence())
    followed: tuple[float, float, float] | None = None
    contact_hardening: bool = False
    forced: Forced = field(default=Forced())

    def __post_init__(self) -> None:
        if not MINIMUM_RESOLUTION <= self.resolution <= MAXIMUM_RESOLUTION:
            raise ProbeError(
                f"probe '{self.name}': face resolution {self.resolution} is not between {MINIMUM_RESOLUTION} "
                f"and {MAXIMUM_RESOLUTION} pixels"
            )
        if self.samples < 1:
            raise ProbeError(f"probe '{self.name}': {self.samples} samples; take at least 1")
        if not 0.0 <= self.adaptive <= 1.0:
            raise ProbeError(f"probe '{self.name}': noise threshold {self.adaptive:g} is not between 0 and 1")
        if not 0.0 < self.clip_start < self.clip_end:
            raise ProbeError(
                f"probe '{self.name}': clip start {self.clip_start:g} m must be above 0 and below "
                f"clip end {self.clip_end:g} m"
            )
        if self.followed is not None and not (np.abs(self.followed) < _INFINITE).all():
            raise ProbeError(f"probe '{self.name}': the object that it follows is nowhere finite; reset its location")
        if not np.isfinite(self.capture_offset).all():
            raise ProbeError(f"probe '{self.name}': its capture offset is not finite; reset it")
        for name, length in (("padding", self.padding), ("falloff", self.falloff)):
            if not 0.0 <= length < _INFINITE:
                raise ProbeError(f"probe '{self.name}': {name} {length:g} m must be finite and not below 0")
        self.influence.check(self.name, self.box.half_widths)

    @property
    def capture_point(self) -> np.ndarray:
        """(3,) float64, world space, metres: where the cameras stand; the box's centre for pictures from elsewhere."""
        if self.source.stretched:
            return self.box.centre
        unit_axes = self.box.axes / self.box.half_extents
        origin = self.box.centre if self.followed is None else np.array(self.followed)
        return origin + unit_axes @ np.array(self.capture_offset)

    @property
    def captures_distance(self) -> bool:
        """Whether its bake has a picture of how near things are."""
        wanted = (self.relief or Effect.RELIEF in self.forced.on) and Effect.RELIEF not in self.forced.off
        return wanted and self.corrected and not self.source.stretched

    @property
    def boundary(self) -> float:
        """How far float32 positions of surfaces that lie on the box may be from it, metres."""
        return 16.0 * _ULP * self._reach

    @property
    def influence_padding(self) -> float:
        """The padding, widened by what float32 positions this far from the origin cannot tell apart, metres."""
        return self.padding + 4.0 * _ULP * self._reach

    @cached_property
    def _reach(self) -> float:
        """The largest coordinate in or around the box, metres."""
        return float(np.abs(self.box.centre).max() + np.linalg.norm(self.box.half_extents))

    @cached_property
    def face_falloffs(self) -> np.ndarray:
        """(2, 3) metres, never 0: how far it fades beyond the faces at the low and at the high ends of the own axes."""
        return _shared(np.maximum(self.influence.falloffs(self.falloff), STEEPEST_FALLOFF))

    @cached_property
    def influence_falloff(self) -> float:
        """The longest of them, metres: shaders divide by it."""
        return float(self.face_falloffs.max())

    @cached_property
    def influence_reach(self) -> np.ndarray:
        """(2, 3) metres: how far the influence box, with the padding, reaches beyond the low and the high faces."""
        return _shared(np.array([self.influence.low, self.influence.high]) + self.influence_padding)

    @property
    def influence_corners(self) -> np.ndarray:
        """(8, 3) world space, metres: the corners of the influence box, without padding."""
        low, high = -self.box.half_widths - self.influence.low, self.box.half_widths + self.influence.high
        metres = np.where(np.array(list(np.ndindex(2, 2, 2))) == 1, high, low)
        return self.box.centre + metres @ np.linalg.inv(self.box.face_normals).T

    @property
    def has_different_faces(self) -> bool:
        """Whether the influence is more than the box with one padding and one falloff."""
        falloffs = self.face_falloffs
        return any(self.influence.low + self.influence.high) or bool((falloffs != falloffs[0, 0]).any())

    def shown_faces(self, correction: Correction) -> dict[str, np.ndarray]:
        """(3,) each: the inputs of a lookup with this correction that say how the faces differ."""
        order = np.where(self.box.along_own_axes(correction) > 0.0, [[0], [1]], [[1], [0]])
        reach, steep = self.influence_reach, self.influence_falloff / self.face_falloffs
        low, high = ((order[end], np.arange(3)) for end in (0, 1))
        return {
            "Reach Low": reach[low],
            "Reach High": reach[high],
            "Steepness Low": steep[low],
            "Steepness High": steep[high],
        }

    def contains(self, corners: np.ndarray) -> bool:
        """Whether world-space points (n, 3), and all between them, lie within the influence box and its padding."""
        return bool(self.within_influence(corners).all())

    def within_influence(self, points: np.ndarray) -> np.ndarray:
        """(…) bool: which world-space points (…, 3) lie within the influence box and its padding."""
        low, high = self.box.half_widths + self.influence_reach
        coordinates = self.box.coordinates(points)
        return ((coordinates >= -low) & (coordinates <= high)).all(-1)

    def keeps_clear_of(self, corners: np.ndarray) -> bool:
        """Whether world-space points (n, 3), and all between them, lie inside the box and apart from its walls."""
        reach = self.box.half_widths - 2.0 * self.boundary
        return bool((np.abs(self.box.coordinates(corners)) < reach).all())

    def holds(self, corners: np.ndarray) -> bool:
        """Whether world-space points (n, 3), and all between them, lie inside the box or on its walls."""
        reach = self.box.half_widths + 2.0 * self.boundary
        return bool((np.abs(self.box.coordinates(corners)) <= reach).all())

    @property
    def fading_reach(self) -> np.ndarray:
        """(2, 3) metres: how far the influence reaches beyond the low and the high faces until it has faded."""
        return self.influence_reach + self.influence.falloffs(self.falloff)

    def overlaps(self, corners: np.ndarray) -> bool:
        """Whether a convex cloud of world-space points (n, 3) may reach into the influence volume.

        Tests separation along the box's face normals only, so it errs towards True.
        """
        return self._reaches(corners, self.fading_reach)

    def nears(self, corners: np.ndarray, distance: float) -> bool:
        """Whether such a cloud may come nearer to the influence box than a distance in metres; errs towards True.

        Below 0: whether it may reach as deep into the box.
        """
        return self._reaches(corners, np.array([self.influence.low, self.influence.high]) + distance)

    def _reaches(self, corners: np.ndarray, reach: np.ndarray) -> bool:
        coordinates = self.box.coordinates(corners)
        low, high = self.box.half_widths + reach
        return bool((coordinates.max(0) >= -low).all() and (coordinates.min(0) <= high).all())
