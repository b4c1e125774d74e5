"""The families of hard cases, each named, seeded and made from nothing.

A family makes cases for one correction at a time: along the world's axes, turned about the vertical, or any way round.
Names are what docs/numerics.md lists.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core.effects.records import Correction
from tests.core.boxes import directions, unit

from .cases import Cases

CORRECTIONS = (Correction.ALIGNED_BOX, Correction.TURNED_BOX, Correction.ORIENTED_BOX)
_ALL, _ORIENTED = CORRECTIONS, (Correction.ORIENTED_BOX,)

Make = Callable[[np.random.Generator, int, Correction], Cases]


@dataclass(frozen=True)
class Family:
    """A kind of case.

    Attributes:
        name: what it is called in tables.
        make: makes n cases for a correction.
        corrections: for which there are such cases.
        finite: whether all inputs are finite numbers.
    """

    name: str
    make: Make
    corrections: tuple[Correction, ...] = _ALL
    finite: bool = True

    def cases(self, count: int, correction: Correction) -> Cases:
        """`count` cases, the same every time."""
        seed = zlib.crc32(f"{self.name} {correction.value}".encode())
        return self.make(np.random.default_rng(seed), count, correction)


FAMILIES: list[Family] = []


def family(name: str, corrections: tuple[Correction, ...] = _ALL, finite: bool = True) -> Callable[[Make], Make]:
    """Enter a function into `FAMILIES`."""

    def enter(make: Make) -> Make:
        FAMILIES.append(Family(name, make, corrections, finite))
        return make

    return enter


# Ingredients ---------------------------------------------------------------------------------------------------------


def single(values: object) -> np.ndarray:
    with np.errstate(over="ignore"):
        return np.asarray(values).astype(np.float32)


def log_uniform(rng: np.random.Generator, low: float, high: float, shape: tuple[int, ...]) -> np.ndarray:
    """Numbers whose logarithms are uniform."""
    return 10.0 ** rng.uniform(np.log10(low), np.log10(high), shape)


def signs(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return rng.choice([-1.0, 1.0], shape)


def room(
    rng: np.random.Generator,
    n: int,
    correction: Correction,
    half: np.ndarray | None = None,
    centre: np.ndarray | float = 10.0,
    normals: np.ndarray | None = None,
    reach: float = 0.98,
) -> Cases:
    """Random rooms, points within `reach` of their walls, and eyes that see a random normal from a random side.

    Args:
        half: (n, 3) half widths, metres; None: from half a metre to ten.
        centre: (n, 3), or how far from the origin rooms stand, metres.
        normals: (n, 3, 3) face normals by rows; None: as the correction allows.
    """
    half = log_uniform(rng, 0.5, 10.0, (n, 3)) if half is None else half
    centre = centre * directions(n, rng) if np.isscalar(centre) else centre
    mirror = unit(rng.normal(size=(n, 3)) * (1.0, 1.0, 0.0))
    if normals is None:
        normals = np.broadcast_to(np.eye(3), (n, 3, 3))
        if correction is Correction.ORIENTED_BOX:
            normals = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    cases = Cases(
        correction,
        position=np.zeros((n, 3), np.float32),
        incoming=single(directions(n, rng)),
        normal=single(directions(n, rng)),
        centre=single(centre),
        face_normals=single(normals),
        half_widths=single(half),
        turn_mirror=single(mirror),
        capture_point=np.zeros((n, 3), np.float32),
    )
    cases = replace(cases, capture_point=at(cases, rng.uniform(-0.5, 0.5, (n, 3))))
    return replace(cases, position=at(cases, rng.uniform(-reach, reach, (n, 3))))


def at(cases: Cases, local: np.ndarray) -> np.ndarray:
    """(n, 3) float32: the points whose coordinates along the face normals are `local` half widths."""
    planes = local * cases.half_widths.astype(np.float64)
    return single(cases.centre + np.linalg.solve(cases.exact_face_normals(), planes[..., None])[..., 0])


def looking(cases: Cases, ray: np.ndarray, rng: np.random.Generator) -> Cases:
    """The same, with eyes and normals such that the reflected ray is about `ray` (n, 3)."""
    incoming = single(directions(len(cases), rng))
    half_way = unit(unit(ray) + incoming)
    return replace(cases, incoming=incoming, normal=single(half_way))


def towards(cases: Cases, target: np.ndarray, rng: np.random.Generator) -> Cases:
    """The same, with reflected rays that run towards world-space points (n, 3)."""
    return looking(cases, target.astype(np.float64) - cases.position, rng)


def on_boundary(rng: np.random.Generator, n: int, axes: Iterable[int] = (1, 2, 3)) -> np.ndarray:
    """(n, 3) local points on faces, edges and corners: those with that many coordinates of ±1."""
    local = rng.uniform(-0.98, 0.98, (n, 3))
    order = np.argsort(rng.random((n, 3)), axis=-1)
    count = rng.choice(list(axes), n)
    return np.where(order < count[:, None], signs(rng, (n, 3)), local)


def nudged(values: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """float32 numbers moved by whole units in the last place."""
    return (values.view(np.int32) + np.where(values == 0, 0, steps).astype(np.int32)).view(np.float32)


def axis_normals(rng: np.random.Generator, n: int, correction: Correction) -> np.ndarray | None:
    """For boxes that may stand any way round: the world's axes in any order and of any sign."""
    if correction is not Correction.ORIENTED_BOX:
        return None
    return np.eye(3)[np.argsort(rng.random((n, 3)), axis=-1)] * signs(rng, (n, 3, 1))


# The families --------------------------------------------------------------------------------------------------------


@family("interior")
def interior(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    return room(rng, n, correction)


@family("axis-parallel, ±0", (Correction.ALIGNED_BOX, Correction.ORIENTED_BOX))
def axis_parallel(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """One or two components of the ray are zeros of either sign, exactly; some start on a wall."""
    cases = room(rng, n, correction, normals=axis_normals(rng, n, correction))
    cases = replace(cases, position=at(cases, np.where(rng.random((n, 1)) < 0.3, on_boundary(rng, n), 0.7)))
    axis = rng.integers(0, 3, n)
    keep = np.eye(3, dtype=bool)[axis] ^ (rng.random(n) < 0.5)[:, None]  # along an axis, or within a plane
    zero = signs(rng, (n, 3)) * 0.0
    flat = np.where(keep, directions(n, rng), zero)
    return replace(
        cases, incoming=single(np.where(keep, unit(flat), zero)), normal=single(np.where(keep, unit(flat), zero))
    )


@family("nearly parallel, 1e-38 … 1e-6", (Correction.ALIGNED_BOX, Correction.ORIENTED_BOX))
def nearly_parallel(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    cases = room(rng, n, correction, normals=axis_normals(rng, n, correction))
    axis = np.eye(3)[rng.integers(0, 3, n)]
    incoming = np.where(axis > 0, signs(rng, (n, 3)), signs(rng, (n, 3)) * log_uniform(rng, 1e-38, 1e-6, (n, 3)))
    return replace(cases, incoming=single(incoming), normal=single(axis))


@family("faces, edges, corners ±4 ulp")
def on_walls(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    cases = room(rng, n, correction)
    position = nudged(at(cases, on_boundary(rng, n)), rng.integers(-4, 5, (n, 3)))
    return replace(cases, position=position)


@family("along a wall")
def along_walls(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """Points on a wall whose rays stay within it, as far as float32 can say so."""
    cases = room(rng, n, correction)
    local = on_boundary(rng, n, (1,))
    wall = np.einsum("nj,nji->ni", (np.abs(local) == 1.0).astype(float), cases.exact_face_normals())
    return looking(replace(cases, position=at(cases, local)), np.cross(wall, directions(n, rng)), rng)


@family("through edges and corners")
def through_edges(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    cases = room(rng, n, correction)
    return towards(cases, at(cases, on_boundary(rng, n, (2, 3))), rng)


@family("hit next to the capture point")
def near_capture(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """The capture point stands 1e-7 to 1e-2 half widths before the wall, where the ray arrives."""
    cases = room(rng, n, correction)
    spot = on_boundary(rng, n, (1,))
    capture = at(cases, spot * (1.0 - log_uniform(rng, 1e-7, 1e-2, (n, 1))))
    return towards(replace(cases, capture_point=capture), at(cases, spot), rng)


@family("capture point on a wall")
def capture_on_wall(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    cases = room(rng, n, correction)
    return replace(cases, capture_point=at(cases, on_boundary(rng, n)))


@family("surface at the capture point")
def at_capture(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """The shaded point is the capture point, or a few ulp beside it."""
    cases = room(rng, n, correction)
    return replace(cases, capture_point=nudged(cases.position, rng.integers(-2, 3, (n, 3))))


@family("aspect 1e6")
def aspect(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    half = rng.permuted(np.broadcast_to([1e3, 1.0, 1e-3], (n, 3)), axis=1)
    return room(rng, n, correction, half)


@family("boxes of 0.1 mm")
def tiny(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    return room(rng, n, correction, log_uniform(rng, 0.5e-4, 2e-4, (n, 3)), centre=1e-3)


@family("boxes of 100 km")
def huge(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    return room(rng, n, correction, log_uniform(rng, 0.5e5, 2e5, (n, 3)))


def _far(metres: float) -> Make:
    def make(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
        return room(rng, n, correction, centre=metres)

    return make


for _metres in (1e3, 1e5, 1e6):
    family(f"{_metres:.0e} m from the origin".replace("+0", ""))(_far(_metres))


@family("mirrored and sheared", _ORIENTED)
def sheared(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """Face normals of boxes that parents shear or mirror; as flat as 1 : 20."""
    edges = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    edges = edges @ (np.eye(3) + np.triu(rng.uniform(-2.0, 2.0, (n, 3, 3)), 1)) * signs(rng, (n, 1, 3))
    normals = unit(np.linalg.inv(edges))
    return room(rng, n, correction, normals=normals)


@family("near gimbal lock", _ORIENTED)
def gimbal(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """Turned by Euler angles whose middle one is a quarter turn, give or take 1e-8 to 1e-3 radians."""
    first, last = rng.uniform(-np.pi, np.pi, (2, n))
    middle = signs(rng, (n,)) * np.pi / 2 + signs(rng, (n,)) * log_uniform(rng, 1e-8, 1e-3, (n,))
    return room(rng, n, correction, normals=_about(2, last) @ _about(1, middle) @ _about(0, first))


def _about(axis: int, angle: np.ndarray) -> np.ndarray:
    """(n, 3, 3) rotations about a coordinate axis."""
    turn = np.zeros((len(angle), 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[:, axis, axis] = 1.0
    turn[:, i, i] = turn[:, j, j] = np.cos(angle)
    turn[:, j, i] = np.sin(angle)
    turn[:, i, j] = -turn[:, j, i]
    return turn


@family("grazing incidence")
def grazing(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """The eye is 1e-8 to 1e-2 radians above a surface that lies on a wall."""
    cases = room(rng, n, correction)
    local = on_boundary(rng, n, (1,))
    inward = -np.einsum("nj,nji->ni", np.where(np.abs(local) == 1.0, local, 0.0), cases.exact_face_normals())
    within = unit(np.cross(inward, directions(n, rng)))
    incoming = unit(within + log_uniform(rng, 1e-8, 1e-2, (n, 1)) * inward)
    return replace(cases, position=at(cases, local), incoming=single(incoming), normal=single(inward))


@family("normal map below the surface")
def below_surface(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """A surface on a wall, its normal bent so far that the reflected ray runs into the wall."""
    cases = room(rng, n, correction)
    local = on_boundary(rng, n, (1,))
    outward = np.einsum("nj,nji->ni", np.where(np.abs(local) == 1.0, local, 0.0), cases.exact_face_normals())
    ray = directions(n, rng)
    ray *= np.sign((ray * outward).sum(-1, keepdims=True))
    return looking(replace(cases, position=at(cases, local)), ray, rng)


@family("normals not of length 1")
def long_normals(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    cases = room(rng, n, correction)
    return replace(cases, normal=single(cases.normal * log_uniform(rng, 1e-3, 1e3, (n, 1))))


@family("zero-length vectors")
def zero_length(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """A zero normal (the ray goes straight on), a zero view vector (there is no ray), or both."""
    cases = room(rng, n, correction)
    kind = rng.integers(0, 3, (n, 1))
    return replace(
        cases,
        normal=np.where(kind != 1, np.float32(0.0), cases.normal),
        incoming=np.where(kind != 0, np.float32(0.0), cases.incoming),
    )


@family("denormal numbers")
def denormal(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """Components of rays and points that float32 cannot hold with all digits, 1e-45 to 1e-38."""
    cases = room(rng, n, correction, centre=0.0)
    small = signs(rng, (3, n, 3)) * log_uniform(rng, 1e-45, 1e-38, (3, n, 3))
    keep = np.eye(3, dtype=bool)[rng.integers(0, 3, n)]
    return replace(
        cases,
        position=np.where(keep, cases.position, single(small[0])),
        incoming=np.where(keep, single(signs(rng, (n, 3))), single(small[1])),
        normal=np.where(keep, single(signs(rng, (n, 3))), single(small[2])),
    )


@family("just outside")
def just_outside(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """Beyond one to three walls by 1e-7 to 0.02 half widths: within what padding covers."""
    cases = room(rng, n, correction)
    local = on_boundary(rng, n)
    beyond = (np.abs(local) == 1.0) * log_uniform(rng, 1e-7, 0.02, (n, 1))
    return replace(cases, position=at(cases, local * (1.0 + beyond)))


@family("far outside")
def far_outside(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    cases = room(rng, n, correction)
    return replace(cases, position=at(cases, directions(n, rng) * log_uniform(rng, 2.0, 1e5, (n, 1))))


@family("NaN and infinite inputs", finite=False)
def not_finite(rng: np.random.Generator, n: int, correction: Correction) -> Cases:
    """One of position, view vector and normal has a component that is not a number or infinite."""
    cases = room(rng, n, correction)
    arrays = [cases.position.copy(), cases.incoming.copy(), cases.normal.copy()]
    which, component = rng.integers(0, 3, n), rng.integers(0, 3, n)
    bad = rng.choice(np.array([np.nan, np.inf, -np.inf], np.float32), n)
    for k, array in enumerate(arrays):
        hit = which == k
        array[hit, component[hit]] = bad[hit]
    return replace(cases, position=arrays[0], incoming=arrays[1], normal=arrays[2])
