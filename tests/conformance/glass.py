"""What is seen through glass and water, looked up in a probe: families of hard cases, geometry, the bound of rounding.

The geometry shares nothing with the shader's formula: rays are bent by their parts along and across the normal, and
leave a solid where a line leaves an ellipsoid, by the quadratic equation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects
from pcc_addon.core.effects.transmission import Interface, seen_through
from pcc_addon.core.expression import Formula
from tests.core.boxes import directions

from . import reference
from . import rounding as r
from .bound import Off, direction_bound
from .cases import Cases
from .columns import Columns, Families
from .digits import Numbers, float64, inner, root, unit
from .families import at, axis_normals, log_uniform, nudged, on_boundary, room, signs, single
from .rounding import Rounded

INTERFACES = (Interface.PANE, Interface.ONCE, Interface.SOLID)


@dataclass(frozen=True)
class Glass(Columns):
    """n surfaces of transmitting things in boxes; all arrays are float32.

    Attributes:
        interface: how often they bend light.
        cases: the boxes, points, views and normals; the normals are of length 1 to rounding, on the eye's side.
        ior: (n,) index of refraction, from 1 on.
        backfacing: (n,) 1 where the inner side is seen, else 0; counts where light is bent once.
        dimensions: (n, 3) of the thing along its own axes, metres; counts for solids, as do its axes.
        axes: (n, 3, 3) unit, a row for each.
    """

    interface: Interface
    cases: Cases
    ior: np.ndarray
    backfacing: np.ndarray
    dimensions: np.ndarray
    axes: np.ndarray

    def inputs(self) -> dict[str, np.ndarray]:
        """By the names of the formula's inputs."""
        return {
            **self.cases.inputs(),
            "IOR": self.ior,
            "Backfacing": self.backfacing,
            "Dimensions": self.dimensions,
            **{f"Axis {axis}": self.axes[:, k] for k, axis in enumerate("XYZ")},
        }


def refracted_lookup(interface: Interface, correction: Correction) -> Formula:
    """From the surface to the direction to look up; the index of refraction is an input."""
    ray = seen_through(interface, None).outputs
    start = formula.POSITION + ray["Offset"] if "Offset" in ray else formula.POSITION
    found = formula.lookup(LookupEffects(correction, None), ray["Direction"], start)
    return Formula(f"Seen through, {interface.words}, {correction.words}", {"Direction": found["Direction"]})


@dataclass(frozen=True)
class Exact:
    """What the float32 inputs mean.

    Attributes:
        ray: (n, 3) the direction in which the view goes on behind, unit.
        offset: (n, 3) from the surface to where it does, metres.
        passes: (n,) whether light comes that way; else all of it is mirrored, at the surface where light is bent once,
            or inside a solid, whose ray is then the mirrored one.
        lookup: where that ray meets the box.
    """

    ray: np.ndarray
    offset: np.ndarray
    passes: np.ndarray
    lookup: reference.Exact


def exact(glass: Glass, numbers: Numbers = float64) -> Exact:
    """Snell's law by parts along and across; the chord of an ellipsoid by the quadratic equation."""
    view, normal = (unit(numbers(v)) for v in (glass.cases.incoming, glass.cases.normal))
    index = numbers(glass.ior)[:, None]
    offset, passes = view * 0, np.ones(len(glass), bool)
    if glass.interface is Interface.PANE:
        ray = -numbers(glass.cases.incoming)
    elif glass.interface is Interface.ONCE:
        bent, passes = _snell(-view, normal, np.where(glass.backfacing[:, None] > 0, 1 / index, index))
        ray = np.where(passes[:, None], bent, -view)
    else:
        into, _ = _snell(-view, normal, index)
        half, axes = numbers(glass.dimensions) / 2, numbers(glass.axes)
        place = half * unit(half * _along(axes, normal))  # where the ellipsoid has this normal
        way = _along(axes, into)
        a, b = ((way / half) ** 2).sum(-1), 2 * (place * way / half**2).sum(-1)
        length = (-b / a)[:, None]  # the other root is 0: the place itself
        far = (place + length * way) / half**2
        outward = unit((axes * far[:, :, None]).sum(1))
        out, passes = _snell(into, -outward, 1 / index)
        ray = np.where(passes[:, None], out, into - 2 * inner(into, outward) * outward)
        offset = length * into
    return Exact(ray, offset, passes, reference.exact(glass.cases, numbers, ray=ray, offset=offset))


def _snell(ray: np.ndarray, normal: np.ndarray, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The bent ray, and whether there is one; the index is that of what is behind over that of what is before."""
    along = inner(ray, normal)
    across = (ray - along * normal) / index
    rest = 1 - inner(across, across)
    return across - root(rest) * normal, rest[:, 0] > 0


def _along(axes: np.ndarray, v: np.ndarray) -> np.ndarray:
    return (axes * v[:, None, :]).sum(-1)


# The bound -----------------------------------------------------------------------------------------------------------


def bound(glass: Glass, truth: Exact) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and the exact direction; at most π."""
    ray, offset, _ = _rounded(glass)
    off = Off(*(np.linalg.norm(part.off(value), axis=-1) for part, value in ((ray, truth.ray), (offset, truth.offset))))
    return direction_bound(glass.cases, truth.lookup, off)


def decided(glass: Glass) -> np.ndarray:
    """(n,) whether it is not for rounding to say where light comes through."""
    passes = _rounded(glass)[2]
    return passes.low == passes.high


def _rounded(glass: Glass) -> tuple[Rounded, Rounded, Rounded]:
    """The ray, its offset and whether light passes, as float32 may find them; operation by operation, in intervals."""
    nowhere, one = Rounded.given(np.zeros((len(glass), 3))), Rounded.given(np.ones(len(glass)))
    if glass.interface is Interface.PANE:
        return Rounded.given(-glass.cases.incoming), nowhere, one
    view, normal = (r.of_length_one(v) for v in (glass.cases.incoming, glass.cases.normal))
    index = Rounded.given(glass.ior)
    if glass.interface is Interface.ONCE:
        bent, passes = _refracted(-view, normal, r.mix(index, one / index, Rounded.given(glass.backfacing)))
        return r.mix(-view, bent, r.scalar(passes)), nowhere, passes
    into, _ = _refracted(-view, normal, index)
    half, axes = glass.dimensions.astype(np.float64) / 2.0, Rounded.given(glass.axes)

    def along_axes(v: Rounded) -> Rounded:
        return r.dot(axes, v[:, None, :])

    place = r.normalize(along_axes(normal) * half)
    way = along_axes(into) / half
    length = r.dot(place, way) * -2.0 / r.dot(way, way)
    # On the unit sphere: whatever is rounded, the far end is no farther away.
    far = (way * r.scalar(length) + place).within(-1.0 - 2.0**-10, 1.0 + 2.0**-10) / half
    outward = r.normalize(r.dot(Rounded.given(glass.axes.transpose(0, 2, 1)), far[:, None, :]))
    bent, passes = _refracted(into, -outward, one / index)
    return r.mix(r.reflect(into, outward), bent, r.scalar(passes)), into * r.scalar(length), passes


def _refracted(ray: Rounded, normal: Rounded, index: Rounded) -> tuple[Rounded, Rounded]:
    ratio = Rounded.given(np.ones(len(index.low))) / index
    cosine = (-r.dot(ray, normal)).within(0.0, 1.0)
    squared = -(ratio * ratio * (-(cosine * cosine) + 1.0)) + 1.0
    bent = normal * r.scalar(ratio * cosine - r.sqrt(squared)) + ray * r.scalar(ratio)
    return bent, r.positive(squared)


# The families --------------------------------------------------------------------------------------------------------

FAMILIES: Families[Glass] = Families("glass")
family = FAMILIES.family


def _seen(cases: Cases, incoming: np.ndarray, normal: np.ndarray) -> Cases:
    """Normals turned to the eye."""
    normal = single(normal * np.where(inner(incoming, normal) < 0.0, -1.0, 1.0))
    return replace(cases, incoming=single(incoming), normal=normal)


def _tilted(rng: np.random.Generator, normal: np.ndarray, sine: np.ndarray) -> np.ndarray:
    """(n, 3) views whose angles from the normals have these sines (n,)."""
    across = unit(np.cross(normal, directions(len(normal), rng)))
    sine = sine[:, None]
    return unit(sine * across + np.sqrt(1.0 - sine**2) * normal)


@family("anywhere")
def anywhere(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    cases = room(rng, n, correction)
    return Glass(
        interface,
        _seen(cases, cases.incoming, cases.normal),
        ior=single(rng.uniform(1.0, 2.4, n)),
        backfacing=single(rng.integers(0, 2, n)),
        dimensions=single(log_uniform(rng, 0.01, 2.0, (n, 1)) * log_uniform(rng, 0.5, 2.0, (n, 3))),
        axes=single(np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]),
    )


@family("going in at grazing angles, 1e-8 … 1e-2")
def grazing(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    normal = directions(n, rng)
    incoming = _tilted(rng, normal, np.cos(log_uniform(rng, 1e-8, 1e-2, (n,))))
    return replace(glass, cases=_seen(glass.cases, incoming, normal), backfacing=np.zeros(n, np.float32))


@family("head-on, ±1e-7")
def head_on(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    normal = directions(n, rng)
    incoming = unit(normal + rng.uniform(-1e-7, 1e-7, (n, 3)))
    return replace(glass, cases=_seen(glass.cases, incoming, normal))


@family("along the axes, ±0")
def along_axes(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    """Boxes, normals, views and solids along the world's axes: zeros of either sign everywhere."""
    glass = anywhere(rng, n, correction, interface)
    box = axis_normals(rng, n, correction)
    cases = room(rng, n, correction, normals=box)
    axis = np.eye(3)[rng.integers(0, 3, n)] * signs(rng, (n, 1))
    zeros = signs(rng, (n, 3)) * 0.0
    facing = np.where(axis != 0.0, axis, zeros)
    axes = np.eye(3)[np.argsort(rng.random((n, 3)), axis=-1)] * signs(rng, (n, 3, 1))
    return replace(glass, cases=_seen(cases, facing, facing), axes=single(axes))


@family("coming out near the critical angle, 1e-7 … 1e-2")
def critical(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    ior = single(rng.uniform(1.05, 2.4, n))
    normal = directions(n, rng)
    # In double precision, as that of single precision depends on the processor, and published vectors must not.
    angle = np.arcsin(1.0 / ior.astype(np.float64)) + signs(rng, (n,)) * log_uniform(rng, 1e-7, 1e-2, (n,))
    cases = _seen(glass.cases, _tilted(rng, normal, np.sin(angle)), normal)
    return replace(glass, cases=cases, ior=ior, backfacing=np.ones(n, np.float32))


@family("beyond the critical angle")
def beyond_critical(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    """All is mirrored, where light is bent once; in solids that long and flat ones do."""
    glass = anywhere(rng, n, correction, interface)
    ior = single(rng.uniform(1.1, 2.4, n))
    normal = directions(n, rng)
    sine = 1.0 / ior + (1.0 - 1.0 / ior) * rng.uniform(0.01, 1.0, n)
    cases = _seen(glass.cases, _tilted(rng, normal, np.minimum(sine, 1.0)), normal)
    return replace(glass, cases=cases, ior=ior, backfacing=np.ones(n, np.float32))


@family("IOR 1 and next to it")
def no_step(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    ior = np.where(rng.random(n) < 0.3, 1.0, 1.0 + log_uniform(rng, 1e-7, 1e-2, (n,)))
    return replace(glass, ior=single(ior))


@family("IOR 2.4, the inner side at small angles")
def diamond(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    normal = directions(n, rng)
    cases = _seen(glass.cases, _tilted(rng, normal, rng.uniform(0.0, 0.41, n)), normal)
    return replace(glass, cases=cases, ior=single(np.full(n, 2.4)), backfacing=np.ones(n, np.float32))


@family("on walls, edges, corners ±4 ulp")
def on_walls(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    position = nudged(at(glass.cases, on_boundary(rng, n)), rng.integers(-4, 5, (n, 3)))
    return replace(glass, cases=replace(glass.cases, position=position))


@family("windows in walls, seen from inside")
def windows(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    """The surface lies on a wall and the view goes out through it."""
    glass = anywhere(rng, n, correction, interface)
    local = on_boundary(rng, n, (1,))
    inward = -np.einsum("nj,nji->ni", np.where(np.abs(local) == 1.0, local, 0.0), glass.cases.exact_face_normals())
    incoming = directions(n, rng)
    incoming *= np.where(inner(incoming, inward) < 0.0, -1.0, 1.0)
    return replace(glass, cases=_seen(replace(glass.cases, position=at(glass.cases, local)), incoming, inward))


@family("solids 1 : 300, long or flat")
def uneven(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    shape = np.where(rng.random((n, 3)) < 0.5, 1.0, log_uniform(rng, 1 / 300, 1.0, (n, 3)))
    return replace(glass, dimensions=single(shape))


@family("balls")
def balls(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    """What came in comes out, at grazing angles as well."""
    glass = anywhere(rng, n, correction, interface)
    dimensions = np.broadcast_to(log_uniform(rng, 1e-3, 10.0, (n, 1)), (n, 3))
    return replace(glass, dimensions=single(dimensions))


@family("solids that reach through walls")
def through_walls(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    cases = replace(glass.cases, position=at(glass.cases, 0.95 * on_boundary(rng, n)))
    return replace(glass, cases=cases, dimensions=single(cases.half_widths * rng.uniform(0.3, 1.0, (n, 3))))


@family("1e5 m from the origin")
def far_away(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    cases = room(rng, n, correction, centre=1e5)
    return replace(glass, cases=_seen(cases, cases.incoming, cases.normal))


@family("boxes and solids of 0.1 mm")
def tiny(rng: np.random.Generator, n: int, correction: Correction, interface: Interface) -> Glass:
    glass = anywhere(rng, n, correction, interface)
    cases = room(rng, n, correction, log_uniform(rng, 0.5e-4, 2e-4, (n, 3)), centre=1e-3)
    small = single(log_uniform(rng, 1e-5, 1e-4, (n, 3)))
    return replace(glass, cases=_seen(cases, cases.incoming, cases.normal), dimensions=small)
