"""The view of all directions: every lookup compared to the exact radiance, and timed.

Six quads are seen by an orthographic camera. Their point attribute is the direction to look up, interpolated linearly,
so that neighbouring pixels have the screen derivatives of a real picture; each pixel has one sample, at its centre.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Quaternion

from benchmarks.measure import relative_rmse, render
from benchmarks.picture_layouts.layouts import SEAM_REACH, GuardedEquirectangular, Layout, layouts_of
from benchmarks.picture_layouts.radiances import Radiance, fill, room, smooth, two_rows
from benchmarks.picture_layouts.shaders import Lookup, image_of, lookup_of
from pcc_addon.core.cubemap import FACES, face_directions
from pcc_addon.core.probe import Engine
from sample_blends.scenes import empty_scene

RESOLUTION = 128  # face width N; the equirectangular picture has 4N × 2N texels
QUAD = 256  # pixels across one quad
INTERIOR = 6.0  # texels: what counts as being away from every seam; in between lie pixels that share a derivative
INTERPOLATIONS = ("Linear", "Cubic", "Smart")
TIMING_SAMPLES = {Engine.CYCLES: 24, Engine.EEVEE: 4}
TIMING_ROUNDS = 5
# An arbitrary turn, so that no seam of a layout falls on an edge of a quad.
TURN = np.array(Quaternion((0.3, -0.5, 0.7, 0.4)).normalized().to_matrix())


@dataclass(frozen=True)
class Accuracy:
    """What one lookup makes of all directions in one engine.

    Attributes:
        room, smooth: relative RMSE (RMS error over RMS truth) of the room with hard edges and of the smooth radiance.
        seams: largest error of the smooth radiance (mean 1) within 2 texels of each kind of seam.
        interior: largest error of the smooth radiance at least 6 texels from every seam.
        shown: (2·QUAD, 3·QUAD, 3) what was rendered of the smooth radiance.
    """

    room: float
    smooth: float
    seams: dict[str, float]
    interior: float
    shown: np.ndarray


@dataclass(frozen=True)
class LayoutResult:
    """A layout in an engine, with Linear interpolation.

    Attributes:
        layout, engine: what was measured.
        nodes: how many turn the direction into a colour.
        accuracy: its errors.
        seconds: of processor time that a frame took, all threads, by round; rounds alternate between the layouts.
    """

    layout: Layout
    engine: Engine
    nodes: int
    accuracy: Accuracy
    seconds: tuple[float, ...]


@dataclass(frozen=True)
class InterpolationResult:
    """The add-on's lookup with one interpolation in one engine."""

    interpolation: str
    engine: Engine
    accuracy: Accuracy


def measure_layouts() -> list[LayoutResult]:
    """Every layout in every engine."""
    view = _View(layouts_of(RESOLUTION))
    results = []
    for engine in Engine:
        accuracies = [view.accuracy(lookup, engine) for lookup in view.lookups]
        seconds = view.frame_seconds(engine)
        for lookup, accuracy, taken in zip(view.lookups, accuracies, seconds, strict=True):
            results.append(LayoutResult(lookup.layout, engine, lookup.nodes, accuracy, taken))
    return results


def measure_interpolations() -> list[InterpolationResult]:
    """Every interpolation in every engine."""
    view = _View([GuardedEquirectangular(RESOLUTION)])
    return [
        InterpolationResult(name, engine, view.accuracy(view.lookups[0], engine, name))
        for engine in Engine
        for name in INTERPOLATIONS
    ]


def directions_seen() -> np.ndarray:
    """(2·QUAD, 3·QUAD, 3): the direction at the centre of each pixel."""
    return two_rows([face_directions(face, QUAD) @ TURN.T for face in FACES])


class _View:
    """The scene, with a lookup and pictures of both radiances for each layout."""

    def __init__(self, layouts: Sequence[Layout]) -> None:
        self._scene = _build_scene()
        self.lookups = [lookup_of(layout, _attribute) for layout in layouts]
        self._images = {
            (layout, radiance): image_of(fill(layout, radiance)) for layout in layouts for radiance in (room, smooth)
        }

    def accuracy(self, lookup: Lookup, engine: Engine, interpolation: str = "Linear") -> Accuracy:
        """Compare what is rendered of the two radiances to their exact values."""
        directions = directions_seen()
        truth = smooth(directions)
        self._sample_at_centres(True)
        self._show(lookup, room, interpolation)
        room_shown = render(self._scene, engine, 1).pixels
        self._show(lookup, smooth, interpolation)
        smooth_shown = render(self._scene, engine, 1).pixels
        error = np.abs(smooth_shown - truth).max(-1)
        seams = lookup.layout.seams(directions)
        return Accuracy(
            relative_rmse(room_shown, room(directions)),
            relative_rmse(smooth_shown, truth),
            {name: float(error[distance <= SEAM_REACH].max()) for name, distance in seams.items()},
            float(error[np.minimum.reduce(list(seams.values())) >= INTERIOR].max()),
            smooth_shown,
        )

    def frame_seconds(self, engine: Engine) -> list[tuple[float, ...]]:
        """For each lookup the processor seconds of its frames, alternating; the first round warms up."""
        self._sample_at_centres(False)
        rounds = []
        for _ in range(TIMING_ROUNDS + 1):
            rounds.append([])
            for lookup in self.lookups:
                self._show(lookup, room)
                begin = time.process_time()
                render(self._scene, engine, TIMING_SAMPLES[engine])
                rounds[-1].append(time.process_time() - begin)
        return list(zip(*rounds[1:], strict=True))

    def _show(self, lookup: Lookup, radiance: Radiance, interpolation: str = "Linear") -> None:
        self._scene.objects["Quads"].data.materials[0] = lookup.material
        lookup.show(self._images[lookup.layout, radiance], interpolation)

    def _sample_at_centres(self, only: bool) -> None:
        """Put all samples at the pixels' centres, or spread them as usual."""
        self._scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
        self._scene.cycles.filter_width = 0.01 if only else 1.5
        self._scene.render.filter_size = 0.0 if only else 1.5


def _build_scene() -> bpy.types.Scene:
    """The quads, in the arrangement of `directions_seen`, and the camera."""
    scene = empty_scene()
    points, quads, vectors = [], [], []
    for k, face in enumerate(FACES):
        centre = np.array([k // 2 + 0.5, k % 2 + 0.5])
        forward, right, up = (np.array(v, float) for v in (face.forward, face.right, face.up))
        quads.append(tuple(range(4 * k, 4 * k + 4)))
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            points.append((*(centre + 0.5 * np.array([a, b])), 0.0))
            vectors.append(TURN @ (forward + a * right + b * up))
    mesh = bpy.data.meshes.new("Quads")
    mesh.from_pydata(points, [], quads)
    attribute = mesh.attributes.new("Direction", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.array(vectors, np.float32).ravel())
    mesh.materials.append(None)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 3.0, (1.5, 1.0, 1.0)
    for item in (bpy.data.objects.new("Quads", mesh), camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = 3 * QUAD, 2 * QUAD
    return scene


def _attribute(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """The quads' direction."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = "Direction"
    return node.outputs["Vector"]
