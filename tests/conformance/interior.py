"""Interior mapping against exact geometry: families of hard cases, planes met one by one, the bound of its rounding."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core.effects import interior as formula
from pcc_addon.core.expression import Expr, scalar, vector
from tests.core.boxes import directions, unit

from .bound import distance_from_zero
from .columns import Columns, Families
from .families import log_uniform, nudged, signs, single
from .reference import angle
from .rounding import ROUNDOFF, SMALLEST


@dataclass(frozen=True)
class Panes(Columns):
    """n rays that enter rooms through a pane; all arrays are float32.

    Attributes:
        place: (n, 3) the point of the pane in cells, (u, v, 0).
        ray: (n, 3) from the eye on, in the pane's axes, y not negative.
        size: (n, 3) the room's width, depth and height, metres.
        half_edges: (n, 3, 3) of the picture's box, a row for each.
        capture: (n, 3) from the box's centre.
        quarters, mirror: (n,) how the room is turned; −1 where it is mirrored, else 1.
    """

    place: np.ndarray
    ray: np.ndarray
    size: np.ndarray
    half_edges: np.ndarray
    capture: np.ndarray
    quarters: np.ndarray
    mirror: np.ndarray

    def inputs(self) -> dict[str, np.ndarray]:
        """By the names of `expression`'s inputs."""
        edges = {f"Half Edge {axis}": self.half_edges[:, k] for k, axis in enumerate("XYZ")}
        names = {"Coordinates": self.place, "Ray": self.ray, "Size": self.size, "Capture": self.capture}
        return {**names, **edges, "Quarters": self.quarters, "Mirror": self.mirror, "Offset": np.zeros(3, np.float32)}


def expression() -> Expr:
    """The direction to look up, from the point of the pane in cells."""
    spot = formula.cell(vector("Coordinates"))["Spot"]
    place, near = formula.inside(spot, vector("Ray"), vector("Size"))
    place = formula.turned(place, scalar("Quarters"), scalar("Mirror"))
    edges = [vector(f"Half Edge {axis}") for axis in "XYZ"]
    return formula.direction(place, near, edges, vector("Capture"))


@dataclass(frozen=True)
class Exact:
    """What the float32 inputs mean, in float64.

    Attributes:
        spot: (n, 3) in the unit room.
        speed: (n, 3) the ray in rooms, half of what it is in the unit room.
        to_picture: (n, 3, 3) from the unit room to the picture's axes.
        direction: (n, 3) unit, from the capture point to where the ray meets the room.
    """

    spot: np.ndarray
    speed: np.ndarray
    to_picture: np.ndarray
    direction: np.ndarray


def exact(panes: Panes) -> Exact:
    """Meet every wall but the pane that the ray approaches, in metres; take the first; turn the room by a matrix."""
    place, ray, size, edges, capture = (
        getattr(panes, n).astype(np.float64) for n in ("place", "ray", "size", "half_edges", "capture")
    )
    share = place[:, :2] - np.floor(place[:, :2])
    spot = np.stack([2.0 * share[:, 0] - 1.0, np.full(len(panes), -1.0), 2.0 * share[:, 1] - 1.0], -1)
    half, origin = size / 2.0, spot * size / 2.0
    distance = np.full(len(panes), np.inf)
    for axis, side in itertools.product(range(3), (-1.0, 1.0)):
        towards, gap = side * ray[:, axis], half[:, axis] - side * origin[:, axis]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            distance = np.minimum(distance, np.where(towards > 0.0, np.maximum(gap, 0.0) / towards, np.inf))
    hit = (origin + distance[:, None] * ray) / half
    turn = np.pi / 2.0 * panes.quarters.astype(np.float64)
    zero, one = np.zeros(len(panes)), np.ones(len(panes))
    rotation = np.array([[np.cos(turn), -np.sin(turn), zero], [np.sin(turn), np.cos(turn), zero], [zero, zero, one]])
    moved = np.round(np.moveaxis(rotation, -1, 0))
    moved[:, :, 0] *= panes.mirror[:, None]
    to_picture = np.einsum("nki,nkj->nij", edges, moved)
    with np.errstate(invalid="ignore"):
        direction = unit(np.einsum("nij,nj->ni", to_picture, hit) - capture)
    return Exact(spot, ray / size, to_picture, direction)


def direction_bound(panes: Panes, truth: Exact) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and the exact direction; at most π.

    As in `bound.py`: errors of the spot and of the speed let the reciprocal distance lie in an interval, whose ends
    give a segment of directions; what is rounded afterwards is added.
    """
    spot, speed, capture = truth.spot, truth.speed, panes.capture.astype(np.float64)
    d_speed = ROUNDOFF * np.abs(speed) + SMALLEST  # one division
    d_spot = 3.0 * ROUNDOFF  # the fraction, and twice it less 1
    ahead = 1.0 - spot * np.sign(speed)
    d_ahead = np.where(spot == -1.0, 0.0, d_spot) + ROUNDOFF * ahead
    d_ahead[:, 1] = 0.0  # the pane: 2 exactly
    unsure = np.abs(speed) <= d_speed
    nearest = np.where(unsure, 1.0 - np.abs(spot), ahead)
    nearest[:, 1] = 2.0
    floor = formula.ON_FACE
    least = (np.maximum(np.abs(speed) - d_speed, 0.0) / np.maximum(ahead + d_ahead, floor)).max(-1)
    most = ((np.abs(speed) + d_speed) / np.maximum(nearest - d_ahead, floor)).max(-1)
    ends = [_directed(truth, capture, u) for u in (least * (1 - 2 * ROUNDOFF), most * (1 + 2 * ROUNDOFF))]
    swept = np.maximum(*(angle(end, truth.direction) for end in ends))
    shortest = np.maximum(distance_from_zero(*ends), 1e-300)
    # The place: the spot's error, a product and a sum; then three products and sums, the capture point's and the last.
    place = np.abs(spot * most[:, None] + speed)
    d_place = most[:, None] * (d_spot + ROUNDOFF) + d_speed + ROUNDOFF * place
    edges = np.linalg.norm(truth.to_picture, axis=1)
    lost = (edges * (d_place + 4.0 * ROUNDOFF * place)).sum(-1)
    lost += ROUNDOFF * (3.0 * most * np.linalg.norm(capture, axis=-1) + 2.0 * np.linalg.norm(ends[1], axis=-1))
    relative = lost / shortest + SMALLEST / shortest
    return np.minimum(swept + np.where(relative < 1.0, np.arcsin(np.minimum(relative, 1.0)), np.pi), np.pi)


def _directed(truth: Exact, capture: np.ndarray, near: np.ndarray) -> np.ndarray:
    place = truth.spot * near[:, None] + truth.speed
    return np.einsum("nij,nj->ni", truth.to_picture, place) - capture * near[:, None]


# The families --------------------------------------------------------------------------------------------------------

FAMILIES: Families[Panes] = Families("interior")
family, cases, together = FAMILIES.family, FAMILIES.cases, FAMILIES.together


@family("windows")
def windows(rng: np.random.Generator, n: int) -> Panes:
    """Rooms of 1 to 20 m, their pictures of turned boxes, seen from everywhere outside."""
    ray = directions(n, rng)
    ray[:, 1] = np.abs(ray[:, 1])
    half = log_uniform(rng, 0.5, 10.0, (n, 3))
    edges = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0] * half[:, :, None]
    place = np.concatenate([rng.uniform(-30.0, 30.0, (n, 2)), np.zeros((n, 1))], 1)
    return Panes(
        place=single(place),
        ray=single(ray),
        size=single(log_uniform(rng, 1.0, 20.0, (n, 3))),
        half_edges=single(edges),
        capture=single(np.einsum("nk,nki->ni", rng.uniform(-0.5, 0.5, (n, 3)), edges)),
        quarters=single(rng.integers(0, 4, n)),
        mirror=single(signs(rng, (n,))),
    )


@family("sides and corners of cells ±4 ulp")
def borders(rng: np.random.Generator, n: int) -> Panes:
    panes = windows(rng, n)
    place = np.round(panes.place) + np.where(rng.random((n, 3)) < 0.5, 0.0, rng.random((n, 3)).round(1))
    return replace(panes, place=nudged(single(place * (1, 1, 0)), rng.integers(-4, 5, (n, 3))))


@family("just left of the first cell")
def before_zero(rng: np.random.Generator, n: int) -> Panes:
    """Coordinates of −10⁻³⁷ … −10⁻³, whose fractions round to 1; smaller ones may be flushed to 0, the first cell."""
    return replace(windows(rng, n), place=single(-log_uniform(rng, 1e-37, 1e-3, (n, 3)) * (1, 1, 0)))


@family("the millionth cell")
def far_cells(rng: np.random.Generator, n: int) -> Panes:
    return replace(windows(rng, n), place=single(signs(rng, (n, 3)) * log_uniform(rng, 1e4, 1e6, (n, 3)) * (1, 1, 0)))


@family("grazing views, 1e-38 … 1e-3 and 0")
def grazing(rng: np.random.Generator, n: int) -> Panes:
    panes = windows(rng, n)
    ray = unit(panes.ray * (1.0, 0.0, 1.0))
    ray[:, 1] = np.where(rng.random(n) < 0.2, 0.0, log_uniform(rng, 1e-38, 1e-3, (n,)))
    return replace(panes, ray=single(ray))


@family("grazing views at the sides of cells")
def grazing_borders(rng: np.random.Generator, n: int) -> Panes:
    return replace(borders(rng, n), ray=grazing(rng, n).ray)


@family("straight ahead, ±0")
def straight(rng: np.random.Generator, n: int) -> Panes:
    ray = np.stack([signs(rng, (n,)) * 0.0, np.ones(n), signs(rng, (n,)) * 0.0], -1)
    return replace(windows(rng, n), ray=single(ray))


@family("within a coordinate plane")
def within_planes(rng: np.random.Generator, n: int) -> Panes:
    panes = windows(rng, n)
    dropped = np.eye(3)[rng.choice([0, 2], n)]
    return replace(panes, ray=single(unit(panes.ray * (1.0 - dropped))))


@family("into edges and corners")
def into_corners(rng: np.random.Generator, n: int) -> Panes:
    panes = windows(rng, n)
    spot = exact(panes).spot
    corner = np.stack(
        [signs(rng, (n,)), np.where(rng.random(n) < 0.5, 1.0, rng.uniform(-0.9, 1.0, n)), signs(rng, (n,))], -1
    )
    free = rng.random((n, 3)) < 0.3
    corner = np.where(free & (np.arange(3) != 1), rng.uniform(-1.0, 1.0, (n, 3)), corner)
    return replace(panes, ray=single(unit((corner - spot) * panes.size)))


@family("rooms of aspect 1e6")
def aspect(rng: np.random.Generator, n: int) -> Panes:
    return replace(windows(rng, n), size=single(rng.permuted(np.broadcast_to([1e3, 1.0, 1e-3], (n, 3)), axis=1)))


@family("rooms of 0.1 mm and of 100 km")
def sizes(rng: np.random.Generator, n: int) -> Panes:
    scale = rng.choice([1e-4, 1e5], (n, 1))
    return replace(windows(rng, n), size=single(scale * rng.uniform(0.5, 2.0, (n, 3))))


@family("capture point on a wall")
def capture_on_wall(rng: np.random.Generator, n: int) -> Panes:
    panes = windows(rng, n)
    local = np.where(np.eye(3)[rng.integers(0, 3, n)] > 0, signs(rng, (n, 3)), rng.uniform(-1.0, 1.0, (n, 3)))
    return replace(panes, capture=single(np.einsum("nk,nki->ni", local, panes.half_edges.astype(np.float64))))


@family("capture point at the pane")
def capture_at_pane(rng: np.random.Generator, n: int) -> Panes:
    """Where the eye stands as well: seen from it, interior mapping shows the picture as it is."""
    panes = windows(rng, n)
    truth = exact(panes)
    return replace(panes, capture=single(np.einsum("nij,nj->ni", truth.to_picture, truth.spot)))


@family("denormal rays")
def denormal(rng: np.random.Generator, n: int) -> Panes:
    panes = windows(rng, n)
    small = np.where(rng.random((n, 3)) < 0.5, log_uniform(rng, 1e-45, 1e-38, (n, 3)), panes.ray)
    small[:, 1] = np.where((small < 1e-38).all(-1), 1.0, small[:, 1])
    return replace(panes, ray=single(small))
