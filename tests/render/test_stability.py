"""Where the lookup is hardest, pictures follow the exact ones: no speckle, no flicker, no line.

Everything is a mirror lit by a probe whose capture float64 knows (`stability.py`). Where exact arithmetic itself has an
edge (a point on a wall whose ray turns from into the room to out of it; the end of the influence without a falloff),
the few pixels whose ray lies within the rounding of that edge may show either side: the exact picture, taken a rounding
aside, then allows both.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from pcc_addon.blender.store import pictures
from pcc_addon.core.effects.records import Outside
from pcc_addon.core.probe import Engine
from sample_blends.scenes import principled, principled_node

from .stability import (
    ALONG,
    BRIGHTEST,
    CAPTURE,
    DARKEST,
    HALF,
    HEIGHT,
    STEP,
    TORN,
    WIDTH,
    Seen,
    Stage,
    allowed_change,
    exit_distance,
)

OUTPUT = Path(__file__).resolve().parents[1] / "output" / bpy.app.version_string
NEAR = (3.0, -2.0, 1.0)
POSES = {
    "aligned": (NEAR, (0.0, 0.0, 0.0)),
    "turned": (NEAR, (0.0, 0.0, 0.6)),
    "tilted": (NEAR, (0.3, -0.2, 0.6)),
    "far away": ((1e4, -1e4, 3e3), (0.3, -0.2, 0.6)),  # float32 positions are 1 mm apart
}
MIRRORS = [("floor", 0.0), ("floor", 0.5), ("wall", 0.5)]  # on which face, and how far beyond its edges, metres
FADES = [(0.01, 0.25), (0.01, 0.0), (0.0, 0.0)]  # padding and falloff, metres
SHOWN = (Outside.UNCORRECTED, Outside.BLACK)  # what a probe shows by itself; a surface's own lobe is the renderer's
EDGE = {"padding": 0.0, "falloff": 0.0, "outside": Outside.BLACK.value}
SEAMS = {
    "-X meridian": (-1.0, 0.0, 0.1),
    "-X meridian below": (-1.0, 0.0, -0.15),
    "top pole": (0.0, 0.0, 1.0),
    "bottom pole": (0.0, 0.0, -1.0),
    "edge of +X and +Y": (1.0, 1.0, 0.2),
    "edge of -X and -Y": (-1.0, -1.0, -0.3),
    "edge of +Y and +Z": (0.2, 1.0, 1.0),
    "edge of +X and -Z": (1.0, -0.3, -1.0),
    "corner of +X, +Y and +Z": (1.0, 1.0, 1.0),
    "corner of -X, +Y and -Z": (-1.0, 1.0, -1.0),
}
IN_EEVEE = {"-X meridian", "top pole", "bottom pole", "edge of -X and -Y", "corner of +X, +Y and +Z"}


def _cases(in_cycles: Iterable[tuple], in_eevee: Iterable[tuple]) -> list:
    """Parameters with the engine before them; EEVEE takes half a minute for each shader."""
    heavy = [pytest.param(Engine.EEVEE, *case, marks=pytest.mark.heavy) for case in in_eevee]
    return [pytest.param(Engine.CYCLES, *case) for case in in_cycles] + heavy


def _add(stage: Stage, mesh: bpy.types.Mesh) -> None:
    """A mirror whose mesh is given along the box's axes."""
    mesh.materials.append(principled("Mirror", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0))
    item = bpy.data.objects.new("Mirror", mesh)
    item.matrix_world = stage.place
    stage.scene.collection.objects.link(item)


def _add_rectangle(stage: Stage, axis: int, at: float, low: Sequence[float], high: Sequence[float]) -> None:
    """A mirror across one of the box's axes, between corners given along the other two, with UVs in metres."""
    (a, b), (c, d) = low, high
    corners = [(a, b), (c, b), (c, d), (a, d)]
    mesh = bpy.data.meshes.new("Mirror")
    mesh.from_pydata([np.insert(corner, axis, at) for corner in corners], [], [(0, 1, 2, 3)])
    uv = mesh.uv_layers.new(name="Metres").uv
    for k, corner in enumerate(corners):
        uv[k].vector = corner
    _add(stage, mesh)


def _add_face(stage: Stage, axis: int, side: float, margin: float = 0.0) -> None:
    """A mirror on a face of the box, or running on beyond its edges."""
    reach = np.delete(HALF, axis) + margin
    _add_rectangle(stage, axis, side * HALF[axis], -reach, reach)


def _check(film: Sequence[Seen], request: pytest.FixtureRequest) -> None:
    """Every pixel, every change between frames and every change between neighbours are the exact ones."""
    name = "".join(c if c.isalnum() else "_" for c in request.node.name)
    assert film[0].covered.mean() > 0.3, "the mirror is not in the picture"
    for k, frame in enumerate(film):
        assert np.isfinite(frame.found).all()
        bounds = (frame.filling + frame.rounding)[frame.covered].max(-1)
        assert np.quantile(bounds, 0.8) < 0.01, "the bounds are too wide, and not only at edges of the box"
        off = np.abs(frame.found - frame.exact) - frame.allowed
        _report(f"{name}, frame {k}: pixels off", off, frame.covered, frame)
        for what, a, b in (("rows", frame[1:], frame[:-1]), ("columns", frame[:, 1:], frame[:, :-1])):
            _report_changes(f"{name}, frame {k}: changes between {what}", a, b, a.aiming + b.aiming, frame)
    for k, (a, b) in enumerate(itertools.pairwise(film)):
        # In one pixel all frames aim alike, which matters at edges only.
        edges = np.where(np.maximum(a.aiming, b.aiming) > TORN, a.aiming + b.aiming, 0.0)
        _report_changes(f"{name}, frames {k} and {k + 1}: changes", a, b, edges, b)


def _report_changes(what: str, a: Seen, b: Seen, aiming: np.ndarray, frame: Seen) -> None:
    off = np.abs((b.found - a.found) - (b.exact - a.exact)) - allowed_change(a, b) - aiming
    _report(what, off, a.covered & b.covered, frame)


def _report(what: str, off: np.ndarray, covered: np.ndarray, frame: Seen) -> None:
    """Fail where something that is covered is off, and leave pictures of it."""
    off = np.where(covered[..., None], off, -np.inf)
    if off.max() <= 0.0:
        return
    stem = what.split(":")[0].replace(", ", "_").replace(" ", "_")
    paths = _save(stem, frame)
    worst = np.unravel_index(off.argmax(), off.shape)
    raise AssertionError(
        f"{what}: {(off > 0.0).any(-1).sum()} of {covered.sum()} are off, the worst by {off.max():.2g} more than "
        f"allowed, at row {worst[0]}, column {worst[1]}; found, exact and difference: {', '.join(map(str, paths))}"
    )


def _save(stem: str, frame: Seen) -> list[Path]:
    """Write what was found, what is exact and their difference: as numbers (EXR), and side by side to look at (PNG)."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    difference = np.where(frame.covered[..., None], frame.found - frame.exact, 0.0)
    exact = np.where(frame.covered[..., None], frame.exact, 0.0)
    parts = {"found": frame.found, "exact": exact, "difference": difference}
    paths = [OUTPUT / f"{stem}_{part}.exr" for part in parts]
    for path, picture in zip(paths, parts.values(), strict=True):
        pictures.write_file(path, picture.astype(np.float32))
    scale = 0.5 / max(np.abs(difference).max(), 1e-9)
    panels = np.concatenate([frame.found, exact, 0.5 + difference * scale], 1).repeat(6, 0).repeat(6, 1)
    image = bpy.data.images.new("stability", panels.shape[1], panels.shape[0])
    pixels = np.ones((*panels.shape[:2], 4), np.float32)
    pixels[..., :3] = panels
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(OUTPUT / f"{stem}.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return [OUTPUT / f"{stem}.png", *paths]


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("engine", "pose", "face", "margin"),
    _cases([(pose, *mirror) for pose in POSES for mirror in MIRRORS], [(pose, "floor", 0.5) for pose in POSES]),
)
def test_a_mirror_on_a_face_of_the_box_is_inside_and_still(
    scene: bpy.types.Scene, pose: str, face: str, margin: float, engine: Engine, request: pytest.FixtureRequest
) -> None:
    stage = Stage(*POSES[pose], **EDGE)
    axis, side = (2, -1.0) if face == "floor" else (0, 1.0)
    _add_face(stage, axis, side, margin)
    eye, target = ((-2.0, -1.4, -0.1), (-0.9, -0.5, -1.25)) if face == "floor" else ((0.7, 1.4, 0.5), (3.0, 0.2, -0.1))
    stage.look(eye, target, 22.0)
    film = stage.film(engine, frames=12 if pose == "far away" else 6)
    _check(film, request)
    for k, frame in enumerate(film):
        # The points that the renderer says are where float64 puts them, so they hide no flicker.
        sight = frame.rays[frame.covered] * np.where(np.arange(3) == axis, -1.0, 1.0)
        start = np.array(eye) + k * STEP * np.array(ALONG)
        points = start + sight * ((side * HALF - start) / sight)[:, axis : axis + 1]
        off = np.abs(points - frame.points[frame.covered]) * np.abs(sight[:, axis : axis + 1])
        assert off.max() < 4.0 * np.finfo(np.float32).eps * (np.abs(POSES[pose][0]).max() + np.linalg.norm(HALF))
        across = np.delete(np.abs(frame.points) - HALF, axis, -1)
        inside = frame.covered & (across < -0.002).all(-1)
        inside &= frame.aiming.max(-1) < TORN  # not the outline
        assert frame.found[inside].min() > DARKEST - 0.01
        assert frame.found[inside].max() < BRIGHTEST + 0.01
    assert (film[0].exact != film[-1].exact).any(), "the eye has moved"


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("engine", "outside", "padding", "falloff"),
    _cases([(o, *fade) for o in SHOWN for fade in FADES], [(o, *fade) for o in SHOWN for fade in FADES[::2]]),
)
def test_across_the_boundary_the_picture_changes_as_the_fade_says(
    scene: bpy.types.Scene,
    outside: Outside,
    padding: float,
    falloff: float,
    engine: Engine,
    request: pytest.FixtureRequest,
) -> None:
    stage = Stage(*POSES["turned"], padding=padding, falloff=falloff, outside=outside.value)
    _add_rectangle(stage, 2, -0.5, (1.0, -1.8), (6.0, 1.8))
    stage.look((2.4, -1.2, 0.3), (3.1, 0.1, -0.5), 30.0)
    film = stage.film(engine, along=(1.0, 0.0, 0.0))
    _check(film, request)
    beyond = film[0].points[..., 0] - HALF[0] - padding
    covered = film[0].covered
    assert (beyond[covered] < -0.1).any()
    assert (beyond[covered] > falloff + 0.1).any()
    if outside is Outside.BLACK:
        bpy.data.objects["Stage"].pcc_probe.padding = 100.0
        whole = stage.film(engine, frames=1)[0]
        weight = (film[0].found / whole.found).mean(-1)
        clear = 1e-4  # metres; the padding is widened by the rounding of positions
        doubt = 2.0**-9 if engine is Engine.EEVEE else 1e-5  # of a quotient of two radiances
        np.testing.assert_allclose(weight[covered & (beyond < -clear)], 1.0, atol=doubt)
        assert (weight[covered & (beyond > falloff + clear)] == 0.0).all()
        if falloff > 0.0:
            for a, b in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
                steepest = 1.5 * np.abs(beyond[a] - beyond[b]) / falloff
                excess = np.abs(weight[a] - weight[b]) - steepest - 2.0 * doubt
                assert excess[covered[a] & covered[b]].max() <= 0.0


@pytest.mark.sweep
@pytest.mark.parametrize(("engine", "seam"), _cases([(s,) for s in SEAMS], [(s,) for s in SEAMS if s in IN_EEVEE]))
def test_no_line_shows_where_the_picture_is_put_together(
    scene: bpy.types.Scene, seam: str, engine: Engine, request: pytest.FixtureRequest
) -> None:
    stage = Stage(*POSES["aligned"])
    direction, capture = np.array(SEAMS[seam]), np.array(CAPTURE)
    spot = capture + exit_distance(capture, direction) * direction
    side = -1.0 if direction[2] >= 0.0 else 1.0  # the mirror: floor or ceiling, whichever the spot is not on
    _add_face(stage, 2, side)
    eye = (-0.6, 1.0, 0.1)
    stage.look(eye, (spot[0], spot[1], 2.0 * side * HALF[2] - spot[2]), 300.0)
    film = stage.film(engine)
    found = np.linalg.norm(film[0].texels[HEIGHT // 2, WIDTH // 2] - film[0].texels, axis=-1)
    assert np.median(found) > 3.0, "the picture is wider than the seam"
    _check(film, request)


@pytest.mark.parametrize("engine", _cases([()], [()]))
def test_a_smooth_sphere_against_the_wall_has_no_speckle(
    scene: bpy.types.Scene, engine: Engine, request: pytest.FixtureRequest
) -> None:
    stage = Stage(*POSES["tilted"], **EDGE)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.6)
    made = bpy.context.object
    mesh = made.data
    bpy.data.objects.remove(made)
    mesh.transform(Matrix.Translation((HALF[0] - 0.6, 0.2, 0.0)))
    mesh.shade_smooth()
    _add(stage, mesh)
    stage.look((1.2, -0.9, 0.3), (2.5, 0.15, 0.0), 32.0)
    film = stage.film(engine)
    _check_curved(film, request)


@pytest.mark.parametrize("engine", _cases([()], [()]))
def test_a_strong_normal_map_on_the_floor_has_no_speckle(
    scene: bpy.types.Scene, engine: Engine, request: pytest.FixtureRequest
) -> None:
    stage = Stage(*POSES["turned"], **EDGE)
    _add_face(stage, 2, -1.0)
    bpy.data.materials["Mirror"].cycles.use_bump_map_correction = False  # reflections may go below the floor
    tree = bpy.data.materials["Mirror"].node_tree
    tree.links.new(_bumps(tree), principled_node(bpy.data.materials["Mirror"]).inputs["Normal"])
    stage.look((-2.0, -1.4, -0.1), (-0.9, -0.5, -1.25), 22.0)
    film = stage.film(engine, normal=_bumps)
    below = film[0].rays[film[0].covered][:, 2] < -0.01
    assert below.mean() > 0.1, "the normals are not strong enough to turn reflections below the floor"
    _check_curved(film, request)


def _check_curved(film: Sequence[Seen], request: pytest.FixtureRequest) -> None:
    _check(film, request)
    for frame in film:
        lit = frame.found[frame.covered & (frame.aiming.max(-1) < TORN)]
        assert DARKEST - 0.01 < lit.min() <= lit.max() < BRIGHTEST + 0.01


def _bumps(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """A tangent-space normal map of crossed waves up to 68° steep, 1 m long; not a texture, which EEVEE would blur."""
    uv, scaled, wave, color = (tree.nodes.new(f"ShaderNode{k}") for k in ("UVMap", *["VectorMath"] * 3))
    normal = tree.nodes.new("ShaderNodeNormalMap")
    scaled.operation, wave.operation, color.operation = "MULTIPLY", "SINE", "MULTIPLY_ADD"
    scaled.inputs[1].default_value = (math.tau, math.tau, 0.0)
    color.inputs[1].default_value, color.inputs[2].default_value = (0.45, 0.45, 0.0), (0.5, 0.5, 0.75)
    tree.links.new(uv.outputs["UV"], scaled.inputs[0])
    tree.links.new(scaled.outputs["Vector"], wave.inputs[0])
    tree.links.new(wave.outputs["Vector"], color.inputs[0])
    tree.links.new(color.outputs["Vector"], normal.inputs["Color"])
    return normal.outputs["Normal"]
