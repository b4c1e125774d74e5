"""In which layout should the shader read a probe's picture? Measures three, in both engines, and writes the answer.

    python3 dev.py run benchmarks/picture_layouts.py

writes docs/picture_layouts.md and docs/images/picture_layouts.png. All layouts get the same number of texels, each
the exact mean of a known radiance over its area, so that what is measured is the layout and its lookup alone.

Two views: "all directions", six quads seen by an orthographic camera, whose point attribute is the direction to look
up (interpolated linearly, so that neighbouring pixels have the screen derivatives of a real picture), one sample at
each pixel's centre; and the floor of the emissive sample room, box-corrected, against the path-traced mirror.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from pcc_addon.blender import compat, node_builder, pictures  # noqa: E402
from pcc_addon.blender.capture import OVERSCAN  # noqa: E402
from pcc_addon.core import equirect, formula  # noqa: E402
from pcc_addon.core.cubemap import FACES, face_directions  # noqa: E402
from pcc_addon.core.effects import LookupEffects  # noqa: E402
from pcc_addon.core.expression import (  # noqa: E402
    Expr,
    absolute,
    combine,
    dot,
    greatest,
    lift,
    maximum,
    minimum,
    multiply_add,
    sign,
    sqrt,
    vector,
)
from pcc_addon.core.probe import Box, Engine  # noqa: E402
from sample_blends import scenes  # noqa: E402

PAGE = ROOT / "docs" / "picture_layouts.md"
FIGURE = ROOT / "docs" / "images" / "picture_layouts.png"
COMMAND = "python3 dev.py run benchmarks/picture_layouts.py"

GUTTER = 4  # texels of real picture beyond each edge of the atlas's faces and of the octahedral square
SEAM_REACH = 2.0  # texels: what counts as being at a seam
INTERIOR = 6.0  # texels: what counts as being away from every seam; in between lie pixels that share a derivative
OVERSAMPLING = 4  # points across a texel, and across a pixel of a capture, whose mean is its value
QUAD = 256  # pixels across one quad of the view of all directions
ALL_DIRECTIONS_RESOLUTION = 128  # face width N; the equirectangular picture has 4N × 2N texels
FLOOR_RESOLUTION = 512
TIMING_SAMPLES = {Engine.CYCLES: 24, Engine.EEVEE: 4}
TIMING_ROUNDS = 5
FLOOR_SAMPLES = 16
INTERPOLATIONS = ("Linear", "Cubic", "Smart")
DIRECTION = vector("Direction")
# An arbitrary turn, so that no seam of a layout falls on an edge of a quad.
TURN = np.array(Quaternion((0.3, -0.5, 0.7, 0.4)).normalized().to_matrix())

Radiance = Callable[[np.ndarray], np.ndarray]  # world directions (..., 3), any length, to (..., 3) float32


class Layout(Protocol):
    """Where a picture keeps which direction."""

    label: str
    node_type: str

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, texels."""

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        """(rows, oversampling · width, 3): directions through a grid of points, `oversampling` across a texel."""

    def coordinates(self, direction: Expr) -> Expr | None:
        """The texture coordinates (u, v, any) of a direction; None where the texture node finds them itself."""

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        """Distances (...) from directions (..., 3) to each kind of place where the layout is cut, in texels."""


@dataclass(frozen=True)
class Equirectangular:
    """The add-on's layout: 4N × 2N, read by the Environment Texture node."""

    resolution: int
    label: str = "equirectangular"
    node_type: str = "ShaderNodeTexEnvironment"

    @property
    def size(self) -> tuple[int, int]:
        return 4 * self.resolution, 2 * self.resolution

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        width, height = self.size
        return equirect.directions(oversampling * width, oversampling * height, rows)

    def coordinates(self, direction: Expr) -> Expr | None:
        return None

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        u, v = equirect.coordinates(directions)
        width, height = self.size
        pole = np.minimum(v, 1.0 - v) * height
        meridian = np.minimum(u, 1.0 - u) * width
        return {"−X meridian": np.where(pole > SEAM_REACH, meridian, np.inf), "poles": pole}


@dataclass(frozen=True)
class GuardedEquirectangular(Equirectangular):
    """The same picture, looked up no nearer to a pole than the centres of its first and last rows.

    Cycles repeats an environment texture across the poles: nearer to one it mixes in the row of the other.
    """

    label: str = "equirectangular, poles guarded"

    def coordinates(self, direction: Expr) -> Expr:
        """The direction (not u, v), its elevation clamped."""
        steepest = 1.0 / np.tan(np.pi / (2.0 * self.size[1]))
        aside = lift((1e-15, 0.0, 0.0)) + direction  # straight up and down have an azimuth too
        across = aside * (steepest, steepest, 0.0)
        limit = sqrt(dot(across, across))
        return combine(aside.x, aside.y, minimum(maximum(aside.z, limit * -1.0), limit))


@dataclass(frozen=True)
class Atlas:
    """Faces with gutters: a column for each axis, its positive face below its negative one."""

    face: int
    label: str = "3×2 face atlas"
    node_type: str = "ShaderNodeTexImage"

    @property
    def cell(self) -> int:
        """Width of a face with its gutters, texels."""
        return self.face + 2 * GUTTER

    @property
    def size(self) -> tuple[int, int]:
        return 3 * self.cell, 2 * self.cell

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        k = oversampling
        axis = (np.arange(-k * GUTTER, k * (self.face + GUTTER)) + 0.5) * (2.0 / (k * self.face)) - 1.0
        cell_row, points = np.divmod(np.arange(2 * len(axis))[rows], len(axis))
        lines = []
        for row in range(2):
            b = axis[points[cell_row == row], None, None]
            frames = [[np.array(v, float) for v in (f.forward, f.right, f.up)] for f in FACES[row::2]]
            lines.append(np.concatenate([forward + axis[:, None] * right + b * up for forward, right, up in frames], 1))
        return np.concatenate(lines)

    def coordinates(self, direction: Expr) -> Expr:
        size = absolute(direction)
        depth = greatest(size)
        longest = 1.0 - sign(depth - size)  # 1 for the longest components; of equal ones the first counts
        on_x = longest.x
        on_y = longest.y * (1.0 - on_x)
        on_z = 1.0 - on_x - on_y
        side = sign(dot(direction, combine(on_x, on_y, on_z)))
        right = combine(multiply_add(side, on_y, on_z), (0.0 - side) * on_x, 0.0)
        up = combine(0.0, (0.0 - side) * on_z, 1.0 - on_z)
        reach = self.face / self.cell / 2.0  # of a face's half width, in cells
        column = multiply_add(on_z, 2.0, on_y)
        u = multiply_add(dot(direction, right) / depth, reach / 3.0, multiply_add(column, 1.0 / 3.0, 1.0 / 6.0))
        v = multiply_add(dot(direction, up) / depth, reach / 2.0, multiply_add(side, -0.25, 0.5))
        return combine(u, v, 0.0)

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        ordered = np.sort(np.abs(directions), -1)
        return {"face edges": (1.0 - ordered[..., 1] / ordered[..., 2]) * (0.5 * self.face)}


@dataclass(frozen=True)
class Octahedral:
    """The sphere unfolded to a square by way of the octahedron; −Z is at its corners. Source: Engelhardt and
    Dachsbacher, "Octahedron Environment Maps", 2008."""

    inner: int
    label: str = "octahedral"
    node_type: str = "ShaderNodeTexImage"

    @property
    def size(self) -> tuple[int, int]:
        return self.inner + 2 * GUTTER, self.inner + 2 * GUTTER

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        k = oversampling
        axis = (np.arange(-k * GUTTER, k * (self.inner + GUTTER)) + 0.5) * (2.0 / (k * self.inner)) - 1.0
        x, y = np.meshgrid(axis, axis[rows])
        beyond_x, beyond_y = np.abs(x) > 1.0, np.abs(y) > 1.0  # past an edge the square goes on half turned
        x, y = np.where(beyond_x, np.sign(x) * 2.0 - x, x), np.where(beyond_x, -y, y)
        x, y = np.where(beyond_y, -x, x), np.where(beyond_y, np.sign(y) * 2.0 - y, y)
        z = 1.0 - np.abs(x) - np.abs(y)
        fold = np.maximum(-z, 0.0)
        return np.stack([x - np.sign(x) * fold, y - np.sign(y) * fold, z], -1)

    def coordinates(self, direction: Expr) -> Expr:
        unit = direction / dot(absolute(direction), (1.0, 1.0, 1.0))
        fold = maximum(unit.z * -1.0, 0.0)
        side = sign(multiply_add(sign(unit), 2.0, 1.0))  # never 0
        square = multiply_add(side, fold, unit)
        return multiply_add(square, 0.5 * self.inner / self.size[0], 0.5)

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        """The square's edges are the half planes x = 0 and y = 0 below z = 0."""
        unit = directions / np.abs(directions).sum(-1, keepdims=True)
        fold = np.maximum(-unit[..., 2:], 0.0)
        square = np.abs(unit[..., :2]) + fold
        return {"square's edges": (1.0 - square.max(-1)) * (0.5 * self.inner)}


def layouts_of(resolution: int) -> tuple[Layout, ...]:
    """The layouts with as near to 8·N² texels as they come."""
    texels = 8 * resolution**2
    return (
        Equirectangular(resolution),
        GuardedEquirectangular(resolution),
        Atlas(round((texels / 6) ** 0.5) - 2 * GUTTER),
        Octahedral(round(texels**0.5) - 2 * GUTTER),
    )


# What the pictures show --------------------------------------------------------------------------------------------


def smooth(directions: np.ndarray) -> np.ndarray:
    """A radiance without edges: a wave for each channel, 0.5 … 1.5."""
    unit = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    waves = np.array([[6.0, 1.0, -2.0], [-1.0, 5.0, 3.0], [2.0, -3.0, 5.0]])
    return (1.0 + 0.5 * np.sin(unit @ waves.T + np.array([0.3, 1.1, 2.0]))).astype(np.float32)


def room(directions: np.ndarray) -> np.ndarray:
    """The emissive room seen from its centre: squares with hard edges. Its mirror floor is shown as dark as possible,
    with squares too."""
    place = scenes.EMISSIVE_ROOM
    half = np.array(place.half_extents)
    local = np.asarray(directions, np.float64) @ np.array(place.matrix.to_3x3())
    distance = half / np.maximum(np.abs(local), 1e-12)
    axis = distance.argmin(-1)
    hit = local * np.take_along_axis(distance, axis[..., None], -1)
    positive = np.take_along_axis(local, axis[..., None], -1)[..., 0] > 0
    result = np.empty(hit.shape, np.float32)
    for k, (name, right, up) in enumerate(_wall_frames()):
        here = (axis == k // 2) & (positive == (k % 2 == 0))
        bright, dark = scenes.EMISSIVE_COLORS.get(name, ((0.5, 0.5, 0.5), (0.1, 0.1, 0.1)))
        squares = sum(np.floor(hit[here] @ across + np.abs(across @ half)).astype(int) for across in (right, up))
        result[here] = np.where(squares[:, None] % 2 == 1, np.float32(bright), np.float32(dark))
    return result


def _wall_frames() -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Name, right and up of the walls +X −X +Y −Y +Z −Z, as `scenes.add_wall` lays their UVs."""
    frames = []
    for k in range(6):
        normal = np.zeros(3)
        normal[k // 2] = -1.0 if k % 2 == 0 else 1.0
        up = np.array([0.0, 0.0, 1.0]) if k // 2 != 2 else np.array([0.0, 1.0, 0.0])
        frames.append(("+-"[k % 2] + "XYZ"[k // 2], np.cross(up, normal), up))
    return frames


def fill(layout: Layout, radiance: Radiance, rows_at_once: int = 32) -> np.ndarray:
    """The picture (height, width, 3) float32 whose texels hold the mean of `radiance` over their area."""
    width, height = layout.size
    k = OVERSAMPLING
    blocks = []
    for start in range(0, height, rows_at_once):
        stop = min(start + rows_at_once, height)
        values = radiance(layout.directions(k, slice(k * start, k * stop)))
        blocks.append(values.reshape(stop - start, k, width, k, 3).mean((1, 3), dtype=np.float64))
    return np.concatenate(blocks).astype(np.float32)


# Rendering -----------------------------------------------------------------------------------------------------------


def image_of(picture: np.ndarray) -> bpy.types.Image:
    """A data image of (height, width, 3) in full float precision."""
    height, width = picture.shape[:2]
    image = bpy.data.images.new("picture", width, height, float_buffer=True, is_data=True)
    image.use_half_precision = False
    image.alpha_mode = "NONE"
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = picture
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


@dataclass(frozen=True)
class Lookup:
    """A material that shows a picture along a direction.

    Attributes:
        layout: how the picture is read.
        material: emits what the lookup finds.
        texture: its texture node.
        nodes: how many nodes turn the direction into a colour, the texture node included.
    """

    layout: Layout
    material: bpy.types.Material
    texture: bpy.types.Node
    nodes: int

    def show(self, image: bpy.types.Image, interpolation: str = "Linear") -> None:
        self.texture.image = image
        self.texture.interpolation = interpolation


def lookup_of(layout: Layout, find_direction: Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]) -> Lookup:
    """Build the material; `find_direction` adds the nodes that give the direction."""
    material = bpy.data.materials.new(layout.label)
    if material.node_tree is None:
        material.use_nodes = True
    material.cycles.emission_sampling = "NONE"
    tree = material.node_tree
    nodes, links = tree.nodes, tree.links
    nodes.clear()
    texture, emission, output = (
        nodes.new(kind) for kind in (layout.node_type, "ShaderNodeEmission", "ShaderNodeOutputMaterial")
    )
    direction = find_direction(tree)
    coordinates = layout.coordinates(DIRECTION)
    count = 1
    if coordinates is not None:
        if layout.node_type == "ShaderNodeTexImage":
            texture.extension = "EXTEND"
        find = group_node(tree, layout.label, {"Coordinates": coordinates})
        count += sum(not node.bl_idname.startswith("NodeGroup") for node in find.node_tree.nodes)
        links.new(direction, find.inputs["Direction"])
        direction = find.outputs["Coordinates"]
    links.new(direction, texture.inputs["Vector"])
    links.new(texture.outputs["Color"], emission.inputs["Color"])
    links.new(emission.outputs[0], output.inputs["Surface"])
    return Lookup(layout, material, texture, count)


def group_node(tree: bpy.types.NodeTree, name: str, outputs: dict[str, Expr]) -> bpy.types.Node:
    """A new group that computes `outputs`, used once in `tree`."""
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    node_builder.emit(group, outputs)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    return node


class Camera:
    """Renders the current scene to arrays."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "render.exr"
        self.scene = bpy.context.scene
        self.scene.render.dither_intensity = 0.0
        compat.set_float_exr(self.scene.render.image_settings)

    def use(self, engine: Engine, samples: int, at_centres: bool) -> None:
        """Choose engine and samples; `at_centres`: all samples at the pixels' centres."""
        scene = self.scene
        scene.render.engine = compat.engine_id(engine)
        scene.cycles.samples = scene.eevee.taa_render_samples = samples
        scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
        scene.cycles.filter_width = 0.01 if at_centres else 1.5
        scene.render.filter_size = 0.0 if at_centres else 1.5

    def seconds(self) -> float:
        """Render and forget; how long it took."""
        start = time.perf_counter()
        bpy.ops.render.render()
        return time.perf_counter() - start

    def picture(self) -> np.ndarray:
        """Render: (height, width, 3) float32, row 0 at the bottom."""
        bpy.ops.render.render()
        bpy.data.images["Render Result"].save_render(str(self._path), scene=self.scene)
        return pictures.read_file(self._path)


def all_directions() -> np.ndarray:
    """(2·QUAD, 3·QUAD, 3): the direction at the centre of each pixel of the view of all directions."""
    cells = [face_directions(face, QUAD) @ TURN.T for face in FACES]
    return np.concatenate([np.concatenate(cells[0::2], 1), np.concatenate(cells[1::2], 1)])


def build_all_directions() -> bpy.types.Object:
    """The scene of the six quads, in the arrangement of `all_directions`."""
    scene = scenes.empty_scene()
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    points, quads, vectors = [], [], []
    for k, face in enumerate(FACES):
        centre = np.array([k // 2 + 0.5, k % 2 + 0.5])
        forward, right, up = (np.array(v, float) for v in (face.forward, face.right, face.up))
        quads.append(tuple(range(4 * k, 4 * k + 4)))
        for a, b in corners:
            points.append((*(centre + 0.5 * np.array([a, b])), 0.0))
            vectors.append(TURN @ (forward + a * right + b * up))
    mesh = bpy.data.meshes.new("quads")
    mesh.from_pydata(points, [], quads)
    attribute = mesh.attributes.new("Direction", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.array(vectors, np.float32).ravel())
    item = bpy.data.objects.new("quads", mesh)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 3.0, (1.5, 1.0, 1.0)
    for thing in (item, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = 3 * QUAD, 2 * QUAD
    return item


def direction_attribute(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """The quads' direction."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = "Direction"
    return node.outputs["Vector"]


def floor_direction(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """The box-corrected direction on the emissive room's floor, from the room's centre."""
    place = scenes.EMISSIVE_ROOM
    box = Box.from_matrix("room", np.array(place.matrix @ Matrix.Diagonal((*place.half_extents, 1.0))))
    node = group_node(tree, "box", formula.lookup(LookupEffects(box.correction, None, offset=False)))
    constants = {
        "Box Centre": box.centre,
        "Half Widths": box.half_widths,
        "Turn Mirror": box.turn_mirror,
    }
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    for socket in node.inputs:
        if socket.name in constants:
            socket.default_value = Vector(constants[socket.name])
        else:
            tree.links.new(geometry.outputs[socket.name], socket)
    return node.outputs["Direction"]


# Measuring -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Accuracy:
    """One lookup of all directions in one engine.

    Attributes:
        layout, engine, interpolation: what was measured.
        room, smooth: relative RMSE (RMS error over RMS truth) of the room with hard edges and of the smooth radiance.
        seams: largest error of the smooth radiance (mean 1) within 2 texels of each kind of seam.
        interior: largest error of the smooth radiance at least 6 texels from every seam.
        shown: (2·QUAD, 3·QUAD, 3) what was rendered of the smooth radiance.
    """

    layout: Layout
    engine: Engine
    interpolation: str
    room: float
    smooth: float
    seams: dict[str, float]
    interior: float
    shown: np.ndarray


@dataclass(frozen=True)
class FloorError:
    """Relative RMSE of the reflecting floor.

    Attributes:
        picture: which picture the floor shows.
        size: its width and height, texels.
        errors: by engine.
    """

    picture: str
    size: tuple[int, int]
    errors: dict[Engine, float]


def relative_rmse(picture: np.ndarray, truth: np.ndarray) -> float:
    """RMS of the difference over RMS of the truth, over all pixels and channels."""
    difference = picture.astype(np.float64) - truth
    return float(np.sqrt((difference**2).mean() / (truth.astype(np.float64) ** 2).mean()))


def accuracy_of(
    layout: Layout, engine: Engine, interpolation: str, room_shown: np.ndarray, smooth_shown: np.ndarray
) -> Accuracy:
    """Compare rendered lookups (2·QUAD, 3·QUAD, 3) of the two radiances to the exact values."""
    directions = all_directions()
    truth = smooth(directions)
    error = np.abs(smooth_shown - truth).max(-1)
    seams = layout.seams(directions)
    return Accuracy(
        layout,
        engine,
        interpolation,
        relative_rmse(room_shown, room(directions)),
        relative_rmse(smooth_shown, truth),
        {name: float(error[distance <= SEAM_REACH].max()) for name, distance in seams.items()},
        float(error[np.minimum.reduce(list(seams.values())) >= INTERIOR].max()),
        smooth_shown,
    )


def measure_all_directions(folder: Path) -> tuple[list[Accuracy], dict[Engine, dict[str, list[float]]], dict[str, int]]:
    """Accuracies, seconds a frame by engine and layout in rounds, and node counts by layout."""
    quads = build_all_directions()
    camera = Camera(folder)
    layouts = layouts_of(ALL_DIRECTIONS_RESOLUTION)
    lookups = [lookup_of(layout, direction_attribute) for layout in layouts]
    images = {
        (layout.label, radiance.__name__): image_of(fill(layout, radiance))
        for layout in layouts
        for radiance in (room, smooth)
    }
    quads.data.materials.append(None)

    def show(lookup: Lookup, radiance: Radiance, interpolation: str = "Linear") -> None:
        quads.data.materials[0] = lookup.material
        lookup.show(images[lookup.layout.label, radiance.__name__], interpolation)

    def picture(*choice: object) -> np.ndarray:
        show(*choice)
        return camera.picture()

    accuracies, seconds = [], {}
    for engine in Engine:
        camera.use(engine, 1, at_centres=True)
        for lookup in lookups:
            for name in INTERPOLATIONS if lookup is lookups[0] else INTERPOLATIONS[:1]:
                shown = picture(lookup, room, name), picture(lookup, smooth, name)
                accuracies.append(accuracy_of(lookup.layout, engine, name, *shown))
        camera.use(engine, TIMING_SAMPLES[engine], at_centres=False)
        seconds[engine] = frame_seconds(camera, {k.layout.label: lambda k=k: show(k, room) for k in lookups})
    return accuracies, seconds, {lookup.layout.label: lookup.nodes for lookup in lookups}


def frame_seconds(camera: Camera, choices: dict[str, Callable[[], None]]) -> dict[str, list[float]]:
    """Seconds to render each choice, alternating, after one unmeasured round."""
    seconds: dict[str, list[float]] = {name: [] for name in choices}
    for k in range(TIMING_ROUNDS + 1):
        for name, choose in choices.items():
            choose()
            elapsed = camera.seconds()
            if k:
                seconds[name].append(elapsed)
    return seconds


def captured_faces(resolution: int) -> list[np.ndarray]:
    """What six cameras with a pixel-wide box filter see of the room, with the bake's overscan."""
    k, size = OVERSAMPLING, resolution + 2 * OVERSCAN
    faces = []
    for face in FACES:
        directions = face_directions(face, k * resolution, k * OVERSCAN)
        rows = [
            room(block).reshape(-1, k, size, k, 3).mean((1, 3))
            for block in (directions[start : start + 32 * k] for start in range(0, size * k, 32 * k))
        ]
        faces.append(np.concatenate(rows))
    return faces


def atlas_of(faces: Sequence[np.ndarray]) -> np.ndarray:
    """The atlas of faces with the bake's overscan, not resampled."""
    cut = OVERSCAN - GUTTER
    cells = [face[cut : face.shape[0] - cut, cut : face.shape[1] - cut] for face in faces]
    return np.concatenate([np.concatenate(cells[0::2], 1), np.concatenate(cells[1::2], 1)])


def floor_pictures() -> list[tuple[str, Layout, np.ndarray]]:
    """The pictures that the floor is tried with: label, layout, pixels."""
    n = FLOOR_RESOLUTION
    tried = [
        (f"exact texels, {layout.label}", layout, fill(layout, room))
        for layout in layouts_of(n)
        if not isinstance(layout, GuardedEquirectangular)
    ]
    faces = captured_faces(n)
    tried.append(
        (f"{n} px capture, equirectangular (as baked)", Equirectangular(n), equirect.from_faces(faces, OVERSCAN))
    )
    tried.append((f"{n} px capture, its faces as an atlas", Atlas(n), atlas_of(faces)))
    return tried


def measure_floor(folder: Path) -> list[FloorError]:
    """The emissive room's floor with each picture, against the path-traced mirror; over the floor's pixels."""
    scene = scenes.emissive_room()
    floor = bpy.data.objects["Wall -Z"]
    walls = [item for item in scene.objects if item.name.startswith("Wall") and item is not floor]
    camera = Camera(folder)
    camera.use(Engine.CYCLES, FLOOR_SAMPLES, at_centres=False)
    truth = camera.picture()
    tried = floor_pictures()
    lookups = [lookup_of(layout, floor_direction) for _, layout, _ in tried]

    floor.data.materials[0] = lookups[0].material
    lookups[0].show(image_of(np.ones((2, 4, 3), np.float32)))
    for wall in walls:
        wall.hide_render = True
    inside = camera.picture()[..., 0] > 0.999
    for wall in walls:
        wall.hide_render = False

    errors: list[dict[Engine, float]] = [{} for _ in tried]
    for lookup, (_, _, pixels) in zip(lookups, tried, strict=True):
        lookup.show(image_of(pixels))
    for engine in Engine:
        camera.use(engine, FLOOR_SAMPLES, at_centres=False)
        for lookup, found in zip(lookups, errors, strict=True):
            floor.data.materials[0] = lookup.material
            found[engine] = relative_rmse(camera.picture()[inside], truth[inside])
    return [FloorError(label, layout.size, found) for (label, layout, _), found in zip(tried, errors, strict=True)]


# The page ------------------------------------------------------------------------------------------------------------

_NAMES = {Engine.CYCLES: "Cycles", Engine.EEVEE: "EEVEE"}


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def relative_time(seconds: dict[str, list[float]], label: str) -> str:
    """The median over rounds of a layout's frame time over the first layout's in the same round, and its range."""
    first = next(iter(seconds.values()))
    ratios = [a / b for a, b in zip(seconds[label], first, strict=True)]
    return f"{statistics.median(ratios):.2f} ({min(ratios):.2f} … {max(ratios):.2f})"


def layout_rows(
    accuracies: Sequence[Accuracy], seconds: dict[Engine, dict[str, list[float]]], nodes: dict[str, int]
) -> list[list[object]]:
    return [
        [
            a.layout.label,
            f"{a.layout.size[0]}×{a.layout.size[1]} = {a.layout.size[0] * a.layout.size[1]}",
            nodes[a.layout.label],
            _NAMES[a.engine],
            f"{a.room:.4f}",
            f"{a.smooth:.5f}",
            "; ".join(f"{name} {error:.4f}" for name, error in a.seams.items()),
            f"{a.interior:.4f}",
            relative_time(seconds[a.engine], a.layout.label),
        ]
        for a in accuracies
        if a.interpolation == "Linear"
    ]


def page(
    accuracies: Sequence[Accuracy],
    seconds: dict[Engine, dict[str, list[float]]],
    nodes: dict[str, int],
    floor: Sequence[FloorError],
) -> str:
    """The whole Markdown page."""
    first = accuracies[0].layout
    layouts = table(
        ["layout", "texels", "nodes", "engine", "room", "smooth", "largest error at seams", "away from them", "time"],
        layout_rows(accuracies, seconds, nodes),
    )
    interpolations = table(
        ["interpolation", "engine", "room", "smooth"],
        [
            [a.interpolation, _NAMES[a.engine], f"{a.room:.4f}", f"{a.smooth:.5f}"]
            for a in accuracies
            if a.layout == first
        ],
    )
    floors = table(
        ["picture", "size", "million texels", *_NAMES.values()],
        [
            [f.picture, f"{f.size[0]}×{f.size[1]}", f"{f.size[0] * f.size[1] / 1e6:.2f}"]
            + [f"{f.errors[engine]:.4f}" for engine in _NAMES]
            for f in floor
        ],
    )
    frames = ", ".join(
        f"{statistics.median(seconds[engine][first.label]):.1f} s in {name}" for engine, name in _NAMES.items()
    )
    samples = ", ".join(f"{TIMING_SAMPLES[engine]} samples in {name}" for engine, name in _NAMES.items())
    return f"""# Picture layouts

Measured with Blender {bpy.app.version_string} by `{COMMAND}`, which writes this page.

## Which layout

{layouts}

All pictures have the same number of texels to 0.3 %, each the exact mean of the radiance over its area, and are read
with Linear interpolation. The view holds all directions, {QUAD} pixels across 90°, one sample at each pixel's centre.

- room, smooth: relative RMSE (RMS error over RMS truth) of the lookup against the exact radiance: a room of squares
  with hard edges, and waves between 0.5 and 1.5.
- largest error at seams: of the smooth radiance, within {SEAM_REACH:g} texels of each kind of seam; away from them: at
  least {INTERIOR:g} texels from all.
- nodes: from the direction to the colour. The atlas and the octahedral map have gutters of {GUTTER} texels.
- time: a frame ({3 * QUAD}×{2 * QUAD} pixels; {samples}; EEVEE renders in software) over
  the first layout's in the same round; median and range of {TIMING_ROUNDS} alternating rounds. The first layout's
  median frame takes {frames}.

![Lookups of the smooth radiance around the worst pixel at each kind of seam](images/{FIGURE.name})

## Interpolation of the Environment Texture node

{interpolations}

## The floor of the emissive room

{floors}

Relative RMSE over the floor's pixels, box-corrected lookup against the path-traced mirror in Cycles,
{FLOOR_SAMPLES} samples, Linear interpolation.
"""


def plain(text: str) -> str:
    """`text` with the signs that the figure's font lacks spelt in ASCII."""
    return text.replace("−", "-").replace("×", "x")


def draw_figure(accuracies: Sequence[Accuracy], path: Path, reach: int = 16, zoom: int = 6) -> None:
    """Crops of 2·reach pixels around the worst pixel at each kind of seam: engines in rows, seams in columns."""
    from PIL import Image, ImageDraw, ImageFont

    linear = [a for a in accuracies if a.interpolation == "Linear"]
    columns = [(a.layout, name) for a in linear if a.engine is Engine.CYCLES for name in a.seams]
    side, margin, head = 2 * reach * zoom, 8, 40
    sheet = Image.new("RGB", (margin + len(columns) * (side + margin), head + 2 * (side + head)), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    directions = all_directions()
    truth = smooth(directions)
    for c, (layout, seam) in enumerate(columns):
        shown = {a.engine: a.shown for a in linear if a.layout == layout}
        error = np.maximum.reduce([np.abs(picture - truth).max(-1) for picture in shown.values()])
        row, column = np.unravel_index(
            np.where(layout.seams(directions)[seam] <= SEAM_REACH, error, 0.0).argmax(), error.shape
        )
        row, column = (int(np.clip(k, reach, n - reach)) for k, n in zip((row, column), error.shape, strict=True))
        x = margin + c * (side + margin)
        draw.text((x, 4), plain(layout.label.replace(", ", ",\n  ")), "black", font)
        for r, engine in enumerate(Engine):
            crop = shown[engine][row - reach : row + reach, column - reach : column + reach][::-1] / 1.5
            tile = Image.fromarray((255 * np.clip(crop, 0.0, 1.0) ** (1 / 2.2)).astype(np.uint8))
            y = head + r * (side + head)
            sheet.paste(tile.resize((side, side), Image.Resampling.NEAREST), (x, y))
            draw.text((x, y + side + 4), plain(f"{_NAMES[engine]}: {seam}"), "black", font)
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(path, optimize=True)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        accuracies, seconds, nodes = measure_all_directions(Path(folder))
        floor = measure_floor(Path(folder))
    text = page(accuracies, seconds, nodes, floor)
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(text, encoding="utf-8")
    draw_figure(accuracies, FIGURE)
    print(text)


if __name__ == "__main__":
    main()
