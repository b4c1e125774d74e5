"""Pictures that are known exactly, and how closely a render has to follow them.

The capture is a smooth function of the points of the box's walls, so float64 knows what any ray that leaves any surface
must show; the walls are met here without the product's formula. A render may differ from that by what it cannot know:
how a picture of finite resolution goes on between its texels, and the roundings of float32. Both are bounded.
Flicker between frames, speckle between pixels and lines across seams are then one question: whether the difference of
two lookups is that of the exact ones, but for as much as the bounds allow over so small a step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

from benchmarks.measure import render
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.store.levels import store
from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACES, face_directions
from pcc_addon.core.effects.records import Outside
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, emissive
from tests.blender.helpers import pretend_bake, small_probe
from tests.eevee import without_shadows

HALF = np.array([3.0, 2.0, 1.25])
CAPTURE = (0.4, -0.3, 0.2)  # from the centre, metres along the box's axes
DARKEST, BRIGHTEST = 0.25, 0.75  # radiance
STEP = 1e-4  # metres that the eye moves between two frames
ALONG = (0.8, 0.6, 0.0)  # whereto, along the box's axes
WIDTH, HEIGHT = 64, 36
FACE = 128  # texels; the picture that shaders read is 4 × 2 faces large

_ULP = float(np.finfo(np.float32).eps)
_HALF_ULP = 2.0**-11  # spacing of half floats below 1
_ROW, _COLUMN = 2 * FACE, 4 * FACE
_WAVES = np.array([[0.9, -0.5, 0.4], [0.3, 0.8, -0.7], [-0.6, 0.5, 0.9]])  # radians a metre
TORN = 0.1  # radiance; neighbours that differ by more lie on two sides of an edge of the exact picture


def radiance(points: np.ndarray) -> np.ndarray:
    """(..., 3) what a point of the walls shows; metres from the centre along the box's axes."""
    return 0.5 + 0.25 * np.sin(points @ _WAVES.T + np.array([0.0, 2.0, 4.0]))


def exit_distance(points: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """(..., 1) metres to the first wall ahead; 0 from a point that lies on or beyond a wall that it looks out of."""
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = (np.copysign(HALF, rays) - points) / rays
    return np.where(rays == 0.0, np.inf, np.maximum(distances, 0.0)).min(-1, keepdims=True)


@dataclass(frozen=True)
class Seen:
    """What one frame shows and should show: arrays (h, w, …), float64.

    Attributes:
        points: of the surface, metres from the centre along the box's axes; what the renderer says.
        rays: unit, the reflected ones, along the box's axes.
        covered: where the surface is.
        found, exact: radiance.
        texels: (column, row) of the exact lookup.
        weight: (h, w, 1) what the lookup is multiplied by.
        filling: how far the picture may be from the exact radiance there.
        rounding: how far the roundings of numbers may take the radiance.
        aiming: how far a ray through another spot of the pixel's filter may take it; 0 where the ray is known.
    """

    points: np.ndarray
    rays: np.ndarray
    covered: np.ndarray
    found: np.ndarray
    exact: np.ndarray
    texels: np.ndarray
    weight: np.ndarray
    filling: np.ndarray
    rounding: np.ndarray
    aiming: np.ndarray

    def __getitem__(self, index: object) -> Seen:
        return Seen(**{field.name: getattr(self, field.name)[index] for field in fields(self)})

    @property
    def allowed(self) -> np.ndarray:
        """How far what is found may be from what is exact."""
        return self.filling + self.rounding + self.aiming


def allowed_change(a: Seen, b: Seen) -> np.ndarray:
    """By how much the change from `a` to `b` may differ from the exact one.

    What a picture adds between its texels has a slope: per texel, at most twice its bound. A fade takes it away.
    """
    slope = 2.0 * np.maximum(a.filling, b.filling) * _texels_apart(a.texels, b.texels)
    faded = np.abs(a.weight - b.weight) * np.maximum(a.filling, b.filling)
    return np.minimum(slope, a.filling + b.filling) + faded + a.rounding + b.rounding


class Stage:
    """A probe with an exact capture, and the camera that looks at what stands in its box."""

    def __init__(self, location: Sequence[float], rotation: Sequence[float], **settings: object) -> None:
        self.scene = bpy.context.scene
        without_shadows(self.scene)
        self.place = Matrix.Translation(location) @ Euler(rotation).to_matrix().to_4x4()
        probe = small_probe("Stage", location, tuple(HALF), rotation, CAPTURE)
        for name, value in settings.items():
            setattr(probe.pcc_probe, name, value)
        bpy.context.view_layer.update()
        self._probe = probe.pcc_probe
        matrix = np.array(probe.matrix_world, np.float64)
        self._axes, self._centre = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0), matrix[:3, 3]
        self._size = float(np.linalg.norm(HALF))
        self._reach = float(np.abs(self._centre).max()) + self._size
        pretend_bake(probe)
        record = bake_record(probe)
        self._capture = self._along_axes(np.array(record.capture_point, np.float32) - self._centre)
        faces = [self._captured(face_directions(face, FACE, 2)).astype(np.float32) for face in FACES]
        store(probe, record, {0.0: equirect.from_faces(faces, 2)}, None)
        self._filling, self._slope = self._bounds()
        self.scene.cycles.pixel_filter_type, self.scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
        self.scene.render.filter_size = 0.01
        self.scene.render.dither_intensity = 0.0

    def look(self, eye: Sequence[float], target: Sequence[float], lens: float) -> None:
        """Place the camera; metres from the centre along the box's axes."""
        add_camera(self.place @ Vector(eye), self.place @ Vector(target), lens, WIDTH, HEIGHT)

    def film(
        self,
        engine: Engine,
        along: Sequence[float] = ALONG,
        frames: int = 6,
        normal: Callable[[bpy.types.NodeTree], bpy.types.NodeSocket] | None = None,
    ) -> list[Seen]:
        """Let the surfaces show the probe, and move the eye.

        Args:
            engine: which renderer shows the surfaces; where they are, Cycles says.
            along: unit vector of the eye's steps, along the box's axes.
            frames: how many pictures.
            normal: makes the normal in the nodes of a material, where it is not the mesh's own.
        """
        bpy.ops.pcc.inject()
        sensors = [_sensor(_geometry("Position")), _sensor(_geometry("Incoming"))]
        sensors.append(_sensor(normal or _geometry("Normal")))
        start, step = self.scene.camera.matrix_world.copy(), self.place.to_3x3() @ Vector(along) * STEP
        film = []
        for k in range(frames):
            self.scene.camera.matrix_world = Matrix.Translation(step * k) @ start
            sensed = [self._render(Engine.CYCLES, sensor) for sensor in sensors]
            film.append(self._seen(self._render(engine), *sensed, engine))
        self.scene.camera.matrix_world = start
        return film

    def _render(self, engine: Engine, override: bpy.types.Material | None = None) -> np.ndarray:
        layer = self.scene.view_layers[0]
        layer.material_override = override
        pixels = render(self.scene, engine, samples=1).pixels
        layer.material_override = None
        return pixels.astype(np.float64)

    def _along_axes(self, vectors: np.ndarray) -> np.ndarray:
        return vectors @ self._axes

    def _captured(self, directions: np.ndarray) -> np.ndarray:
        """(..., 3) radiance that arrives at the capture point from world-space directions."""
        rays = self._along_axes(directions)
        return radiance(self._capture + exit_distance(self._capture, rays) * rays)

    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """(h, w, 3) how far a lookup near each texel may be from the exact radiance, and the slope there, per texel.

        Between texels a line is off by at most half the largest second difference around, kinks included. That counts
        once for the bilinear lookup and once for the faces that the picture is made of, whose texels are up to 4/π as
        wide. Nearer to a pole than half a texel there is nothing but the outermost row; as much of the other pole is
        mixed in as Cycles cannot tell the elevation, which it takes from an arc cosine.
        """
        exact = self._captured(equirect.directions(_COLUMN, _ROW))
        over_poles = [np.roll(row, _COLUMN // 2, 1) for row in (exact[:1], exact[-1:])]
        column = np.concatenate([over_poles[0], exact, over_poles[1]])
        bends = np.abs(np.roll(exact, 1, 1) + np.roll(exact, -1, 1) - 2.0 * exact)
        bends += np.abs(column[:-2] + column[2:] - 2.0 * exact)
        filling = 0.5 * (1.0 + (4.0 / np.pi) ** 2) * _greatest_around(bends, 2)
        mixed = _rows_lost(0.5) * np.abs(exact[0] - exact[-1]).max()
        filling[[0, -1]] += np.ptp(exact[[0, -1]], axis=1, keepdims=True) + mixed
        slope = np.abs(np.roll(exact, 1, 1) - exact) + np.abs(column[1:-1] - column[:-2])
        return filling, _greatest_around(slope, 1)

    def _lookup(self, points: np.ndarray, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The exact radiance, the world-space direction from the capture point that it is found in, and its weight."""
        to_wall = points + exit_distance(points, rays) * rays - self._capture
        # Within the roundings of positions nobody can tell inside from outside: they count as inside.
        beyond = (np.abs(points) - HALF).max(-1, keepdims=True) - self._probe.padding - 4.0 * _ULP * self._reach
        if self._probe.falloff > 0.0:
            fade = np.clip(1.0 - beyond / self._probe.falloff, 0.0, 1.0)
            weight = fade**2 * (3.0 - 2.0 * fade)
        else:
            weight = (beyond <= 0.0).astype(np.float64)
        if self._probe.outside == Outside.BLACK.value:
            directions = to_wall @ self._axes.T
        else:
            unit = to_wall / np.linalg.norm(to_wall, axis=-1, keepdims=True)
            directions, weight = (rays + weight * (unit - rays)) @ self._axes.T, np.ones_like(weight)
        return weight * self._captured(directions), directions, weight

    def _seen(
        self, found: np.ndarray, position: np.ndarray, incoming: np.ndarray, normal: np.ndarray, engine: Engine
    ) -> Seen:
        covered = np.linalg.norm(normal, axis=-1) > 0.5
        aside = ~covered[..., None] * np.array([0.0, 0.0, 1.0])  # where nothing is, any numbers will do
        normals = self._along_axes(normal + aside)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        points, back = self._along_axes(position - self._centre), self._along_axes(incoming + aside)
        rays = 2.0 * (back * normals).sum(-1, keepdims=True) * normals - back
        exact, directions, weight = self._lookup(points, rays)
        # Four roundings of a position within the box; EEVEE places surfaces in the world by roundings of its own.
        apart = 2.0 * _ULP * (self._size if engine is Engine.CYCLES else self._reach)
        turned = 4.0 * _ULP if engine is Engine.CYCLES else apart
        texels = _texels(directions)
        nearest = np.minimum(texels[..., 1].astype(int), _ROW - 1), texels[..., 0].astype(int) % _COLUMN
        filling = self._filling[nearest]
        rounding = np.zeros_like(exact)
        for shift in np.concatenate([np.eye(3), -np.eye(3)]):
            for moved in ((points + apart * shift, rays), (points, rays + turned * shift)):
                beside, directions, _ = self._lookup(*moved)
                slope = 2.0 * filling * np.minimum(_texels_apart(texels, _texels(directions)), 1.0)
                rounding = np.maximum(rounding, np.abs(beside - exact) + slope)
        from_pole = np.minimum(texels[..., 1:], _ROW - texels[..., 1:])
        rounding += (4.0 * _ULP * _COLUMN + _rows_lost(from_pole)) * self._slope[nearest]
        rounding += 4.0 * _ULP  # of radiances
        aiming = np.zeros_like(exact)
        if engine is Engine.EEVEE:
            rounding += 2.0 * _HALF_ULP + self._slope[nearest] / 256.0  # texel, picture; graphics cards' 8-bit weights
            spread = _greatest_around(exact, 1) + _greatest_around(-exact, 1)
            aiming = np.where(spread > TORN, spread, 0.02 * spread)  # two rays, each up to 0.01 pixels aside
        return Seen(points, rays, covered, found, exact, texels, weight, filling, rounding, aiming)


def _texels(directions: np.ndarray) -> np.ndarray:
    """(h, w, 2) column and row of world-space directions in the picture."""
    u, v = equirect.coordinates(directions)
    return np.stack([u * _COLUMN, v * _ROW], -1)


def _texels_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(h, w, 1) columns and rows between two lookups, the shorter way round."""
    apart = np.abs(b - a)
    return np.minimum(apart[..., :1], _COLUMN - apart[..., :1]) + apart[..., 1:]


def _rows_lost(from_pole: np.ndarray | float) -> np.ndarray | float:
    """Rows of the picture by which an arc cosine in float32 misses an elevation so many rows from a pole."""
    return _ULP / np.sin(np.maximum(from_pole, 0.5) * np.pi / _ROW) * _ROW / np.pi


def _greatest_around(values: np.ndarray, reach: int) -> np.ndarray:
    """(h, w, 3) the greatest value up to `reach` cells away; around the left and right edge, not over the others."""
    rows = np.pad(values, ((reach, reach), (0, 0), (0, 0)), mode="edge")
    high = np.max([rows[k : k + len(values)] for k in range(2 * reach + 1)], axis=0)
    return np.max([np.roll(high, k, axis=1) for k in range(-reach, reach + 1)], axis=0)


def _geometry(output: str) -> Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]:
    return lambda tree: tree.nodes.new("ShaderNodeNewGeometry").outputs[output]


def _sensor(value: Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]) -> bpy.types.Material:
    """A material that emits a value of its nodes."""
    material, emission = emissive("Sensor")
    material.node_tree.links.new(value(material.node_tree), emission.inputs["Color"])
    return material
