"""What is there: a scene as plain data, read once, from which everything is decided.

A value that is the same all over a surface is a number or a tuple of numbers; one that varies (a texture, an attribute,
an animated value) is None.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .decisions import Forced
from .probe import ProbeSpec, Source

Value = float | tuple[float, ...] | None


@dataclass(frozen=True)
class SurfaceReading:
    """One BSDF of a material.

    Attributes:
        path: names of the group nodes that lead to it from the material's tree, then its own node's.
        kind: its node's type, such as "ShaderNodeBsdfPrincipled".
        inputs: its inputs by name, each constant or None where it varies.
        distribution: of its microfacets, such as "MULTI_GGX"; empty where it has none.
        fresnel: its choice of a Fresnel curve, such as "F82"; empty where it has none.
        films_on_metal: whether its renderer shows thin films over metals too.
        films_on_both: whether its renderer has room for films over a metal and over a dielectric in one surface.
    """

    path: tuple[str, ...]
    kind: str
    inputs: tuple[tuple[str, Value], ...]
    distribution: str = ""
    fresnel: str = ""
    films_on_metal: bool = True
    films_on_both: bool = True

    @cached_property
    def _values(self) -> dict[str, Value]:
        return dict(reversed(self.inputs))  # of equal names the first counts

    def has(self, name: str) -> bool:
        return name in self._values

    def value(self, name: str) -> Value:
        """The input's constant value, or None where it varies.

        Raises:
            KeyError: there is no such input.
        """
        return self._values[name]

    def scalar(self, name: str) -> float | None:
        """`value` of an input that is one number."""
        value = self.value(name)
        return float(value) if isinstance(value, (int, float)) else None

    def color(self, name: str) -> tuple[float, float, float] | None:
        """`value` of an input that is a colour, without alpha."""
        value = self.value(name)
        return (value[0], value[1], value[2]) if isinstance(value, tuple) else None


@dataclass(frozen=True)
class MaterialReading:
    """One material.

    Attributes:
        name: unique in the file (with its library).
        surfaces: the BSDFs that reach an output in force, each once.
        obstacles: why the material as a whole must be left as it is, in words that follow its name; empty: nothing.
        textures: how many image textures the user's own nodes read (EEVEE has 32 samplers for a material).
        emits: whether it is a light of its own.
        slab: whether its user says that what passes through it leaves in parallel, as through a pane.
        bends_normals: whether perturbed normals are bent where they would mirror the view into the surface.
        shown: names of the probe groups that it shows now.
        forced: effects that are on or off whatever it calls for.
        allowed: names of the only probes that its user lets it show; None: all, empty: none.
    """

    name: str
    surfaces: tuple[SurfaceReading, ...] = ()
    obstacles: tuple[str, ...] = ()
    textures: int = 0
    emits: bool = False
    slab: bool = False
    bends_normals: bool = True
    shown: tuple[str, ...] = ()
    forced: Forced = field(default=Forced())
    allowed: frozenset[str] | None = None


@dataclass(frozen=True, eq=False)
class PlacementReading:
    """One appearance of an object (or instance) in the scene.

    Attributes:
        object: the object's name.
        materials: names of those that it shows, those that modifiers and geometry nodes assign included.
        corners: (8, 3) float64, world space, metres: the bounding box along its own axes, in the order of
            `numpy.ndindex(2, 2, 2)`.
        fixed: whether its materials cannot be exchanged for copies: it is linked, or others than its slots give them.
        excluded: whether its user lets it show no probe.
    """

    object: str
    materials: tuple[str, ...]
    corners: np.ndarray
    fixed: bool = False
    excluded: bool = False


@dataclass(frozen=True)
class WallReading:
    """What a material covers of one placement, where light passes through it.

    Attributes:
        material: its name.
        area: square metres.
        thinness: how thick its walls are on the whole, over the middle side of its bounds along the placement's axes:
            about 1/3 for a ball or a cube, far less for panes, bottles and bulbs.
        is_open: whether it has an edge where it ends, so that it is a surface and no body.
    """

    material: str
    area: float
    thinness: float
    is_open: bool

    @classmethod
    def of(cls, material: str, triangles: np.ndarray) -> WallReading:
        """From triangles (n, 3, 3), metres, n > 0. A closed shell of thickness t has the volume t/2 times its area."""
        points = triangles.reshape(-1, 3)
        middle = float(np.sort(np.ptp(points, 0))[1])
        a, b, c = np.moveaxis(triangles - points.mean(0), 1, 0)
        areas = 0.5 * np.cross(b - a, c - a)  # as vectors, which add up to 0 over a closed surface
        area = float(np.linalg.norm(areas, axis=-1).sum())
        volume = abs(float((a * np.cross(b, c)).sum())) / 6.0
        if area <= 0.0 or middle <= 0.0:
            return cls(material, area, 0.0, True)
        return cls(material, area, 2.0 * volume / area / middle, float(np.linalg.norm(areas.sum(0))) > _GAP * area)


_GAP = 0.01  # of its area, by which a surface may fail to close


@dataclass(frozen=True, eq=False)
class FacetReading:
    """What a material covers of an object whose polygons are flat, lie in few directions and stay where they are.

    A side of them that faces one way counts once; both sides of each polygon do, as normals face the eye.

    Attributes:
        object, material: their names.
        normals: (n, 3) float64, world space, unit.
        offsets: (n,) float64, metres: the least of P·normal over all points P of polygons with that normal or its
            opposite.
    """

    object: str
    material: str
    normals: np.ndarray
    offsets: np.ndarray

    @classmethod
    def of(cls, object_name: str, material: str, normals: np.ndarray, points: Sequence[np.ndarray]) -> FacetReading:
        """From unit normals (n, 3), none the opposite of another, and the points (k, 3) of each; world space."""
        heights = [at @ normal for normal, at in zip(normals, points, strict=True)]
        offsets = [height.min() for height in heights] + [-height.max() for height in heights]
        return cls(object_name, material, np.concatenate([normals, -normals]), np.array(offsets, np.float64))


@dataclass(frozen=True)
class ProbeReading:
    """One probe.

    Attributes:
        name: the object's.
        spec: its settings, or None where they are faulty.
        fault: what is wrong with it, a sentence that names it; empty: nothing.
        captured_at: where its pictures were taken, world space, metres; None before its first bake.
        source: where its pictures came from.
        by_hand: whether shaders made by hand read it.
        in_windows: whether windows show its room.
        over_frames: whether it has pictures for frames, at which others may show it than now.
        departure: `Sidecar.departs_from` its box.
        advice: what a measurement of costs recommends instead of it, a sentence; empty: nothing.
        copy_of: the name of the probe that it was copied from, whose pictures it shows; empty: it has its own or none.
    """

    name: str
    spec: ProbeSpec | None
    fault: str = ""
    captured_at: tuple[float, float, float] | None = None
    source: Source = Source.BAKE
    by_hand: bool = False
    in_windows: bool = False
    over_frames: bool = False
    departure: float | None = None
    advice: str = ""
    copy_of: str = ""

    @property
    def read_anyhow(self) -> bool:
        """Whether more reads it than materials as they are now."""
        return self.by_hand or self.in_windows or self.over_frames


@dataclass(frozen=True)
class CameraReading:
    """One camera.

    Attributes:
        name: the object's.
        place: where all of its rays start, world space, metres; None where animation may move it, or where they start
            at several places, as those of an orthographic one do.
    """

    name: str
    place: tuple[float, float, float] | None


@dataclass(frozen=True)
class SceneReading:
    """One scene, as a render of one view layer shows it.

    Attributes:
        name: the scene's.
        probes, materials, placements: by name; placements in the order of the render.
        roughness_limit: rougher surfaces keep their own lobe.
        cameras: those that render: the scene's own and those that markers choose.
        walls: of what light passes through.
        facets: of objects with a sharp material, where that is flat; others are not known to be.
        animated: names of objects and materials that animation, drivers or constraints may change.
    """

    name: str
    probes: tuple[ProbeReading, ...] = ()
    materials: tuple[MaterialReading, ...] = ()
    placements: tuple[PlacementReading, ...] = ()
    roughness_limit: float = 0.6
    cameras: tuple[CameraReading, ...] = ()
    walls: tuple[WallReading, ...] = ()
    facets: tuple[FacetReading, ...] = ()
    animated: frozenset[str] = field(default=frozenset())

    @property
    def specs(self) -> dict[str, ProbeSpec]:
        """The settings of all probes that are not faulty, by name."""
        return {probe.name: probe.spec for probe in self.probes if probe.spec is not None}

    @property
    def borrowing(self) -> frozenset[str]:
        """Names of probes that show what was captured for another one; stretched pictures are as good in any box."""
        return frozenset(probe.name for probe in self.probes if probe.copy_of and not probe.source.stretched)
