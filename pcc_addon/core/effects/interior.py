"""Interior mapping: a flat pane shows rooms behind it that are not there. Written once, as the reflection lookup is.

A pane is divided into cells, and behind each lies a room of its own. Three spaces: the object's own; the pane's, in
metres, whose x runs to the right as one sees the pane, y into the rooms and z upwards; and the unit room, [−1, 1]³ with
the pane on y = −1. There a point of the pane has y = −1 by construction and not by arithmetic, so nothing can flicker.

Source of the idea: van Dongen, *Interior Mapping*, 2008. The rooms here are boxes with pictures of all directions,
looked up by the reciprocal of the distance as in `lookup.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache

from ..expression import (
    Expr,
    Formula,
    Op,
    Operand,
    Section,
    Texel,
    absolute,
    clamp,
    combine,
    cross,
    dot,
    floor,
    greatest,
    lift,
    maximum,
    minimum,
    mix,
    multiply_add,
    normalize,
    operation,
    random,
    scalar,
    sign,
    vector,
)
from .fresnel import fresnel
from .lookup import read_picture

POSITION = vector("Position")  # object space
INCOMING = vector("Incoming")  # object space, to the eye, of any length
NORMAL = vector("Normal")  # object space, on the eye's side
UV = vector("UV")
UP = vector("Up")  # object space, of any length
OBJECT_SCALE = vector("Object Scale")  # metres that the object's units measure along its axes
OBJECT_RANDOM = scalar("Object Random")  # 0 … 1, of each object and instance
REAL_SIZE = scalar("Real Size")  # 1: sizes are metres whatever the object's scale; 0: they are scaled with it
WIDTH, HEIGHT, DEPTH = scalar("Width"), scalar("Height"), scalar("Depth")  # of a room, metres, above 0
OFFSET = vector("Offset")  # of the cells to the left and down, in cells
SEED, PER_OBJECT = scalar("Seed"), scalar("Per Object")
TURNS, MIRRORED, LIT = scalar("Turns"), scalar("Mirrored"), scalar("Lit")  # shares of the rooms
STRENGTH, DARK_STRENGTH = scalar("Strength"), scalar("Dark Strength")
TINT_A, TINT_B = vector("Tint A"), vector("Tint B")
MIDDLE_DEPTH, CURTAIN_DEPTH = scalar("Middle Depth"), scalar("Curtain Depth")  # shares of the room's depth
MIDDLE, CURTAINS = scalar("Middle"), scalar("Curtains")  # shares of the rooms
IOR = scalar("IOR")

# A point of the unit room nearer to a wall than this is on it: less than any two float32 numbers near 1 differ by.
ON_FACE = 1e-8

MIDDLE_PICTURE, CURTAIN_PICTURE = "Middle Picture", "Curtain Picture"
Vector = tuple[float, float, float]


class Cells(Enum):
    """What divides a pane into cells: lengths in object space, or the whole numbers of its UV map."""

    OBJECT = "object"
    UV = "uv"


@dataclass(frozen=True)
class RoomPicture:
    """A picture of all directions, and the box that it shows.

    Attributes:
        half_edges: three vectors from the box's centre to its faces' centres, in the picture's axes: to the right as
            one looks in through the window, away from the window, up. By default a cube with the picture's middle on
            its back wall, as for a picture of which nothing is known.
        capture: from the box's centre to where the picture was taken, in the picture's axes.
        rows: the picture's height.
    """

    half_edges: tuple[Vector, Vector, Vector] = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    capture: Vector = (0.0, 0.0, 0.0)
    rows: int = 1024


@dataclass(frozen=True)
class Interior:
    """What a window material computes.

    Attributes:
        rooms: the pictures that rooms are chosen from.
        cells: what divides its panes.
        middle, curtains: whether there are flat pictures of what stands in the rooms and of what hangs at the panes.
    """

    rooms: tuple[RoomPicture, ...]
    cells: Cells = Cells.OBJECT
    middle: bool = False
    curtains: bool = False


def pane() -> dict[str, Expr]:
    """A pane's own axes, from object space.

    Returns:
        "Place": the point along the pane's x and z axes, metres from the object's origin, as (x, z, 0); "Ray": from the
        eye on, in the pane's axes, y never negative; "Wall": a whole number that panes of different directions do not
        share.
    """
    scale = mix((1.0, 1.0, 1.0), OBJECT_SCALE, REAL_SIZE)
    normal = normalize(NORMAL / scale)
    flat = clamp((absolute(dot(normalize(UP), normal)) - 0.9995) * 1e6)  # a pane that lies: +Y is above
    across = normalize(cross(mix(UP, (0.0, 1.0, 0.0), flat), normal))
    aloft = cross(normal, across)
    point, eye = POSITION * scale, INCOMING * scale
    ray = combine(dot(eye, across) * -1.0, absolute(dot(eye, normal)), dot(eye, aloft) * -1.0)
    # Steps that no usual direction of a wall is near to.
    wall = dot(floor(multiply_add(NORMAL, 3.7, 0.41)), (31.0, 57.0, 91.0))
    return {"Place": combine(dot(point, across), dot(point, aloft), 0.0), "Ray": ray, "Wall": wall}


def cell(coordinates: Expr) -> dict[str, Expr]:
    """Where in which cell a point lies.

    Args:
        coordinates: (u, v, 0) in cells; their fractions are 0 and 1 at the sides of a cell.

    Returns:
        "Cell": the cell's two whole numbers, never −0; "Spot": the point in the unit room.
    """
    shifted = coordinates + OFFSET
    number = floor(shifted)
    spot = multiply_add(shifted - number, 2.0, -1.0)
    return {"Cell": number, "Spot": combine(spot.x, -1.0, spot.y)}


def inside(spot: Expr, ray: Expr, size: Expr) -> tuple[Expr, Expr]:
    """Where a ray from a pane meets the room behind it.

    Args:
        spot: in the unit room, y = −1.
        ray: in the pane's axes, of any length, y not negative.
        size: the room's width, depth and height, metres.

    Returns:
        The place on the room's walls, in the unit room, times the reciprocal of the ray's length up to there; and that
        reciprocal, which is finite on walls too (see `lookup.nearness`).
    """
    speed = ray / size
    near = greatest(absolute(speed) / maximum(1.0 - spot * sign(speed), ON_FACE))
    return multiply_add(spot, near, speed), near


def turned(place: Expr, quarters: Expr, mirror: Expr) -> Expr:
    """A place in the unit room that is mirrored left to right (mirror −1, else 1), then turned by quarters about z."""
    cosine, sine = absolute(quarters - 2.0) - 1.0, 1.0 - absolute(quarters - 1.0)
    x, y = place.x * mirror, place.y
    return combine(x * cosine - y * sine, x * sine + y * cosine, place.z)


def direction(place: Expr, near: Expr, half_edges: Sequence[Operand], capture: Operand) -> Expr:
    """The direction to look up in a room's picture, from `inside`'s results; the rest as in `RoomPicture`."""
    x, y, z = half_edges
    found = multiply_add(place.x, x, multiply_add(place.y, y, place.z * lift(z)))
    return found if capture == (0.0, 0.0, 0.0) else found - near * lift(capture)


def on_layer(spot: Expr, ray: Expr, size: Expr, depth: Expr) -> Expr:
    """Where a ray meets a plane parallel to the pane, as (u, v, 0) of a flat picture that fills the room's section.

    Depth is a share of the room's. What misses the room ends outside 0 … 1, and is finite.
    """
    speed = ray / size
    met = multiply_add(speed, depth * 2.0 / maximum(speed.y, 1e-6), spot)
    return multiply_add(combine(met.x, met.z, 0.0), 0.5, (0.5, 0.5, 0.0))


def chance(number: Expr, share: Expr) -> Expr:
    """1 for a share of all random numbers, else 0; for none where the share is 0 and for all where it is 1."""
    return maximum(sign(share * 1.0001 - number), 0.0)


@cache
def pane_formula() -> Formula:
    """`pane`."""
    return Formula("Interior Pane", pane())


@cache
def cell_formula() -> Formula:
    """`cell` of the input "Coordinates"."""
    return Formula("Interior Cell", cell(vector("Coordinates")))


@cache
def room_formula() -> Formula:
    """`inside`, then `turned`; inputs "Spot", "Ray", "Size", "Quarters" and "Mirror"."""
    place, near = inside(vector("Spot"), vector("Ray"), vector("Size"))
    return Formula("Interior Room", {"Place": turned(place, scalar("Quarters"), scalar("Mirror")), "Near": near})


def interior(record: Interior) -> Formula:
    """All of it: from a point of a pane in object space to the light of the room behind it.

    Returns:
        A formula with "Radiance", dimmed as glass dims it; "Cell", the cell's two whole numbers and one of its pane,
        object and seed; "Random", three numbers of the cell's own for users; "Is Lit", 0 or 1. It samples "Room 0" and
        so on, and "Middle Picture" and "Curtain Picture" where there are such.
    """
    found = pane_formula()()
    ray, size = found["Ray"], combine(WIDTH, DEPTH, HEIGHT)
    metres = found["Place"] / combine(WIDTH, HEIGHT, 1.0) + (0.5, 0.5, 0.0)
    cells = cell_formula()(Coordinates=metres if record.cells is Cells.OBJECT else UV)
    spot, number = cells["Spot"], cells["Cell"]
    # Multiples, as the last bits of an object's number may differ between renderers.
    of_object = floor(OBJECT_RANDOM * 8191.0) * PER_OBJECT
    key = Section("Variety", combine(number.x, number.y, SEED + found["Wall"] + of_object))
    first, second = random(key), _more(key, 0.5)
    mirror = multiply_add(chance(second.x, MIRRORED), -2.0, 1.0)
    quarters = minimum(floor(first.y * TURNS * 4.0), 3.0)
    lit = chance(first.z, LIT)
    room = room_formula()(Spot=spot, Ray=ray, Size=size, Quarters=quarters, Mirror=mirror)
    light = _chosen([_seen(k, r, room["Place"], room["Near"]) for k, r in enumerate(record.rooms)], first.x)
    shares = _more(key, 0.25)
    for wanted, picture, depth, share, number_of in (
        (record.middle, MIDDLE_PICTURE, MIDDLE_DEPTH, MIDDLE, shares.x),
        (record.curtains, CURTAIN_PICTURE, CURTAIN_DEPTH, CURTAINS, shares.y),
    ):
        if wanted:
            place = on_layer(spot, ray, size, depth)
            place = combine(multiply_add(place.x - 0.5, mirror, 0.5), place.y, 0.0)
            alpha = Texel(picture, place, 1) * chance(number_of, share)
            light = Section("Layers", mix(light, Texel(picture, place, 3), alpha))
    strength = mix(DARK_STRENGTH, STRENGTH, lit)
    left = 1.0 - fresnel(clamp(normalize(ray).y, 1e-12), IOR)
    light = Section("Light", light * mix(TINT_A, TINT_B, second.y) * (strength * left))
    return Formula("Interior", {"Radiance": light, "Cell": key, "Random": _more(key, 0.75), "Is Lit": lit})


def _more(key: Expr, between: float) -> Expr:
    """Further random numbers of a cell; a number between 0 and 1 for each three."""
    return random(operation(Op.ADD, key, (between, between, 0.0)))


def _seen(k: int, room: RoomPicture, place: Expr, near: Expr) -> Expr:
    return Section(
        "Pictures", read_picture(f"Room {k}", room.rows, direction(place, near, room.half_edges, room.capture))
    )


def _chosen(pictures: Sequence[Expr], number: Expr) -> Expr:
    """One of them, by a random number; each as likely."""
    if len(pictures) == 1:
        return pictures[0]
    index = minimum(floor(number * float(len(pictures))), float(len(pictures) - 1))
    shares = [maximum(1.0 - absolute(index - float(k)), 0.0) for k in range(len(pictures))]
    total: Expr = lift(0.0)
    for picture, share in zip(pictures, shares, strict=True):
        total = operation(Op.MULTIPLY_ADD, picture, share, total)
    return total
