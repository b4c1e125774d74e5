"""Small scenes as plain data, drawn at random and the same in every run: probes, rooms, things, paints, a camera."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

Triple = tuple[float, float, float]
OPEN, GLOWS = -2, -1
"""What a wall may be instead of the number of a paint: not there, or a lamp."""
NONE, ANY = -2, -1
"""What a paint may show instead of the probe of a room: none, or whichever it is in."""


class Kind(Enum):
    """What a paint is."""

    DIELECTRIC = "dielectric"
    METAL = "metal"
    MIXED = "metal in part"
    SPOTTED = "metal in spots"
    TINTED = "dielectric with a specular tint"
    TINTED_METAL = "metal with an edge tint"
    COATED = "under a coat"
    GLASS = "Glass BSDF"
    CLEAR = "transmission in part"
    FILM = "under a thin film"
    METAL_FILM = "metal under a thin film"
    BRUSHED = "anisotropic"
    GLOSSY = "Glossy BSDF"
    METALLIC = "Metallic BSDF"


class Shape(Enum):
    BOX = "box"
    BALL = "ball"
    PLANE = "plane"


class Stand(Enum):
    """Where a thing is, by one of its room's walls."""

    MIDDLE = "between the walls"
    TOUCHING = "touching the wall from inside"
    THROUGH = "through the wall"
    IN_PADDING = "up to the padding's end"
    BEYOND = "beyond the wall"


@dataclass(frozen=True)
class Paint:
    """A material: its roughness varies by a texture where `varied`; its normals are bumpy where `bumpy`."""

    kind: Kind
    roughness: float
    varied: bool
    bumpy: bool
    color: Triple


@dataclass(frozen=True)
class Room:
    """A probe's box with walls.

    Attributes:
        centre: world space, metres.
        half: half extents, metres.
        turn: Euler angles, radians.
        shear: turn about Z of a parent that is half as long along its X; 0: no parent.
        walls: at −X, −Y, −Z, +X, +Y, +Z: the number of a paint, `GLOWS` or `OPEN`.
        capture: offset of the capture point, of the half extents.
        padding, falloff, normal_fade: metres.
        low, high: influence beyond the faces, metres; `falloff_high` of the high faces where it differs.
        weight, priority, outside, hardening, corrected: the probe's settings.
        moves: whether the probe is animated.
        excludes: whether the first thing must not show it.
    """

    centre: Triple
    half: Triple
    turn: Triple
    shear: float
    walls: tuple[int, ...]
    capture: Triple
    padding: float
    falloff: float
    normal_fade: float
    low: Triple
    high: Triple
    falloff_high: Triple | None
    weight: float
    priority: int
    outside: str
    hardening: bool
    corrected: bool
    moves: bool
    excludes: bool

    @property
    def parent(self) -> np.ndarray:
        """(4, 4): that of the parent."""
        return _turned((0.0, 0.0, self.shear)) @ np.diag([0.5, 1.0, 1.0, 1.0]) if self.shear else np.eye(4)

    @property
    def local(self) -> np.ndarray:
        """(4, 4): from [−1, 1]³ to the box in the parent's space, where the room is as large as it says."""
        matrix = _turned(self.turn) @ np.diag([*self.half, 1.0])
        matrix[:3, 3] = np.linalg.solve(self.parent, [*self.centre, 1.0])[:3]
        return matrix

    @property
    def matrix(self) -> np.ndarray:
        """(4, 4): from [−1, 1]³ to the box in world space."""
        return self.parent @ self.local

    def world(self, place: Triple) -> np.ndarray:
        """(3,) world space, metres: a place given in half extents from the centre."""
        return (self.matrix @ [*place, 1.0])[:3]


@dataclass(frozen=True)
class Thing:
    """An object in or at a room.

    Attributes:
        shape, paint, room: which.
        size: metres, half.
        stand, axis, side: where: by the wall at that end of that axis of its room.
        aside: place along the two other axes, of the half extents.
        turn: Euler angles, radians, beside its room's.
        moves: whether it is animated.
    """

    shape: Shape
    paint: int
    room: int
    size: float
    stand: Stand
    axis: int
    side: int
    aside: tuple[float, float]
    turn: Triple
    moves: bool


@dataclass(frozen=True)
class View:
    """The camera: in half extents of a room, looking at a place in another one.

    Attributes:
        room, place: where it is; a component above 1 is outside.
        target_room, target: what it looks at.
        parallel: whether its rays are.
        moves: whether it is animated.
    """

    room: int
    place: Triple
    target_room: int
    target: Triple
    parallel: bool
    moves: bool


@dataclass(frozen=True)
class Drawn:
    """One scene.

    Attributes:
        paints, rooms, things, view: what is there.
        roughness_limit, samples, resolution: its settings.
        chosen: by paint the room whose probe alone it shows, `ANY` or `NONE`.
        excluded: by thing whether it shows no probe.
    """

    paints: tuple[Paint, ...]
    rooms: tuple[Room, ...]
    things: tuple[Thing, ...]
    view: View
    roughness_limit: float
    samples: int
    resolution: int
    chosen: tuple[int, ...]
    excluded: tuple[bool, ...]

    @property
    def moves(self) -> bool:
        """Whether anything is animated."""
        return self.view.moves or any(one.moves for one in (*self.rooms, *self.things))


def _turned(angles: Triple) -> np.ndarray:
    """(4, 4): a rotation by Euler angles XYZ."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles), np.sin(angles)
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    matrix = np.eye(4)
    matrix[:3, :3] = z @ y @ x
    return matrix


def _rarely(probable: int = 6) -> st.SearchStrategy[bool]:
    return st.integers(0, probable - 1).map(lambda k: k == probable - 1)


def _steps(low: float, high: float, count: int) -> st.SearchStrategy[float]:
    """One of some values in equal steps, short to write down."""
    return st.integers(0, count).map(lambda k: round(low + (high - low) * k / count, 4))


_COLORS = st.sampled_from([(0.8, 0.8, 0.8), (1.0, 1.0, 1.0), (0.9, 0.5, 0.2), (0.1, 0.4, 0.9), (1.0, 0.0, 0.0)])
_ROUGHNESSES = st.sampled_from([0.0, 0.0, 0.0, 0.05, 0.1, 0.2, 0.3, 0.44, 0.55, 0.8])
_ANGLES = _steps(-3.0, 3.0, 12)


@st.composite
def paints(draw: st.DrawFn) -> Paint:
    return Paint(draw(st.sampled_from(Kind)), draw(_ROUGHNESSES), draw(_rarely(5)), draw(_rarely(5)), draw(_COLORS))


@st.composite
def _turns(draw: st.DrawFn) -> Triple:
    how = draw(st.sampled_from(["aligned", "aligned", "about Z", "free"]))
    if how == "aligned":
        return (0.0, 0.0, 0.0)
    return (0.0, 0.0, draw(_ANGLES)) if how == "about Z" else (draw(_ANGLES), draw(_ANGLES), draw(_ANGLES))


def _triples(low: float, high: float, count: int) -> st.SearchStrategy[Triple]:
    return st.tuples(*[_steps(low, high, count)] * 3)


@st.composite
def _rooms(draw: st.DrawFn, number: int, paints: int) -> Room:
    apart = draw(st.sampled_from([4.4, 3.0, 9.0]))  # a thin wall between, overlapping, far apart
    afar = draw(st.sampled_from([(0.0, 0.0, 0.0)] * 3 + [(300.0, -120.0, 40.0)])) if number == 0 else (0.0,) * 3
    centre = tuple(round(a + number * apart * (k == 0), 3) for k, a in enumerate(afar))
    wall = st.sampled_from([GLOWS, GLOWS, GLOWS, *range(paints)])
    walls = [draw(wall) for _ in range(6)]
    if draw(_rarely(3)):
        walls[draw(st.integers(0, 5))] = OPEN
    per_face = draw(_rarely(5))
    return Room(
        centre=centre,
        half=draw(st.sampled_from([(2.0, 1.5, 1.0), (2.0, 2.0, 1.25), (1.6, 3.0, 1.5)])),
        turn=draw(_turns()),
        shear=draw(st.sampled_from([0.0, 0.0, 0.0, 0.5])),
        walls=tuple(walls),
        capture=draw(_triples(-0.3, 0.3, 2)) if draw(_rarely(3)) else (0.0, 0.0, 0.0),
        padding=draw(st.sampled_from([0.01, 0.0, 0.2])),
        falloff=draw(st.sampled_from([0.25, 0.05, 1.0, 0.0])),
        normal_fade=draw(st.sampled_from([0.0, 0.0, 0.0, 0.5])),
        low=draw(_triples(-0.3, 0.3, 2)) if per_face else (0.0, 0.0, 0.0),
        high=draw(_triples(-0.3, 0.3, 2)) if per_face else (0.0, 0.0, 0.0),
        falloff_high=draw(_triples(0.1, 0.5, 2)) if per_face and draw(st.booleans()) else None,
        weight=draw(st.sampled_from([1.0, 1.0, 1.0, 0.6])),
        priority=draw(st.integers(0, 1)),
        outside=draw(st.sampled_from(["OWN", "OWN", "UNCORRECTED", "BLACK"])),
        hardening=draw(_rarely(5)),
        corrected=not draw(_rarely(8)),
        moves=draw(_rarely(10)),
        excludes=draw(_rarely(10)),
    )


@st.composite
def _things(draw: st.DrawFn, rooms: int, paints: int) -> Thing:
    return Thing(
        shape=draw(st.sampled_from(Shape)),
        paint=draw(st.integers(0, paints - 1)),
        room=draw(st.integers(0, rooms - 1)),
        size=draw(st.sampled_from([0.3, 0.5, 0.7])),
        stand=draw(st.sampled_from([Stand.MIDDLE, Stand.MIDDLE, *Stand])),
        axis=draw(st.integers(0, 2)),
        side=draw(st.sampled_from([-1, 1])),
        aside=(draw(_steps(-0.5, 0.5, 4)), draw(_steps(-0.5, 0.5, 4))),
        turn=draw(_turns()),
        moves=draw(_rarely(10)),
    )


@st.composite
def scenes(draw: st.DrawFn) -> Drawn:
    known = draw(st.lists(paints(), min_size=1, max_size=3))
    rooms = [draw(_rooms(k, len(known))) for k in range(draw(st.sampled_from([1, 1, 2, 2, 3])))]
    # All stand about the first.
    rooms = [rooms[0], *(_moved(room, rooms[0].centre) for room in rooms[1:])]
    things = draw(st.lists(_things(len(rooms), len(known)), min_size=1, max_size=4))
    which = st.integers(0, len(rooms) - 1)
    inside = not draw(_rarely(3))
    place = draw(_triples(-0.7, 0.7, 4)) if inside else draw(_triples(-2.5, 2.5, 4))
    view = View(draw(which), place, draw(which), draw(_triples(-0.5, 0.5, 4)), draw(_rarely(10)), draw(_rarely(10)))
    limit = draw(st.sampled_from([0.6, 0.6, 0.35, 1.0]))
    samples, resolution = draw(st.integers(1, 4)), draw(st.sampled_from([16, 24, 32]))
    chosen = tuple(draw(st.sampled_from([ANY, ANY, ANY, ANY, NONE, *range(len(rooms))])) for _ in known)
    excluded = tuple(draw(_rarely()) for _ in things)
    return Drawn(tuple(known), tuple(rooms), tuple(things), view, limit, samples, resolution, chosen, excluded)


def _moved(room: Room, place: Triple) -> Room:
    return Room(**{**room.__dict__, "centre": tuple(round(a + b, 3) for a, b in zip(room.centre, place, strict=True))})


def drawn(number: int) -> Drawn:
    """The scene of a number: the second that Hypothesis draws from this seed, as the first is the simplest of all."""
    found: list[Drawn] = []

    @seed(number)
    @settings(_TWO)
    @given(scenes())
    def draw(scene: Drawn) -> None:
        found.append(scene)

    draw()
    return found[-1]


_TWO = settings(
    max_examples=2, database=None, phases=[Phase.generate], deadline=None, suppress_health_check=list(HealthCheck)
)
