"""What a scene does not need can be left out without a trace: its picture is that of everything on."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from pprint import pformat

import bpy
import numpy as np
import pytest

from benchmarks.measure import ROOT
from pcc_addon.blender.status import statuses
from pcc_addon.core.decisions import Effect
from pcc_addon.core.probe import Engine
from sample_blends import glass, interior, moving, scenes, two_rooms
from sample_blends.build import FOLDER
from sample_blends.by_hand import by_hand
from tests.eevee import without_shadows

from .build import FRAMES, build, probes
from .pruning import TOLERANCE, Comparison, bake_all, compare, force, put_in, seen
from .scenes import Drawn, drawn

_NEWEST = bpy.app.version >= (5, 2)
QUICK, ALL = 10, 200 if _NEWEST else 16
EEVEE = 12 if _NEWEST else 2
on_newest = pytest.mark.skipif(not _NEWEST, reason="tried on the newest Blender, as it takes long")
EEVEE_TOLERANCE = 2e-3
"""Absolute; EEVEE reads pictures in half precision."""


def frames_of(scene: Drawn) -> tuple[int, ...]:
    """Those that are rendered: where nothing moves, the first says it all."""
    return (FRAMES[0], sum(FRAMES) // 2) if scene.moves else FRAMES[:1]


def check(found: Comparison, folder: Path, words: str, tolerance: np.ndarray | float | None = None) -> None:
    """Fail with both pictures and the scene's data where everything on changes something."""
    allowed = found.allowed if tolerance is None else tolerance
    assert found.rounded_pictures <= TOLERANCE
    if (found.difference > allowed).any() or found.changed_pictures:
        found.write(folder)
        where = f"pruned, whole and difference are in {folder}"
        pytest.fail(f"{found.relative:.2e}; other pictures: {found.changed_pictures}; {where}\n{words}")


def numbers(quick: int, count: int) -> list:
    return [pytest.param(k, marks=[pytest.mark.heavy] if k >= quick else []) for k in range(count)]


@pytest.mark.parametrize("number", numbers(QUICK, ALL))
def test_a_drawn_scene_looks_as_with_everything_on(number: int, tmp_path: Path) -> None:
    scene = drawn(number)
    build(scene)
    check(compare(frames_of(scene)), tmp_path, pformat(scene))


@pytest.mark.sweep
@pytest.mark.parametrize("state", ["ON", "OFF"])
@pytest.mark.parametrize("number", [2, 3])
def test_everything_can_be_forced_at_once(number: int, state: str) -> None:
    _check_forced(number, Effect, state)


@pytest.mark.heavy
@on_newest
@pytest.mark.parametrize("state", ["ON", "OFF"])
@pytest.mark.parametrize("effect", Effect, ids=lambda effect: effect.key)
def test_any_effect_can_be_forced(effect: Effect, state: str) -> None:
    _check_forced(3, [effect], state)


def _check_forced(number: int, effects: Iterable[Effect], state: str) -> None:
    """Nothing fails, an injection leaves nothing to do, and a picture comes of it; after a change of mind too."""
    build(drawn(number))
    bake_all()
    put_in()
    for each in (state, "AUTO"):
        force(effects, each)
        bake_all()
        put_in()
        assert np.isfinite(seen(FRAMES[:1])).all()


@pytest.mark.heavy
@pytest.mark.parametrize("number", range(EEVEE))
def test_a_drawn_scene_looks_as_with_everything_on_in_eevee(number: int, tmp_path: Path) -> None:
    scene = drawn(number)
    without_shadows(build(scene))
    check(compare(frames_of(scene)[:1], Engine.EEVEE, 1), tmp_path, pformat(scene), EEVEE_TOLERANCE)


def test_scenes_are_the_same_in_every_run_and_differ_from_each_other() -> None:
    found = [drawn(number) for number in range(QUICK)]
    assert found == [drawn(number) for number in range(QUICK)] and len(set(found)) == QUICK


def _open(path: Path, folder: Path) -> None:
    """Open a copy of a file, beside which pictures may be written."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / path.name))


def _living_room(folder: Path) -> None:
    path = ROOT.parent / "shared" / "scenes" / "living_room.blend"
    if not path.is_file():
        pytest.skip(f"{path.name} is not here")
    _open(path, folder)
    scenes.add_probe_around(bpy.context.scene)


def _any_cubemap(folder: Path) -> None:
    _open(FOLDER / "any_cubemap.blend", folder)  # its picture is found from there


def _emissive_room() -> None:
    scenes.emissive_room()
    scenes.add_room_probe(scenes.EMISSIVE_ROOM)


SAMPLES: dict[str, Callable[[], object]] = {
    "emissive room": _emissive_room,
    "gallery": scenes.gallery,
    "by hand": partial(by_hand, 16, 1),
    "glass": glass.glass,
    "interior": partial(interior.interior, 16, 1),
    "moving": moving.moving,
    "two rooms": two_rooms.two_rooms,
    "two rooms with a doorway": partial(two_rooms.two_rooms, doorway=True),
    "two rooms of metal": two_rooms.of_metal,
}


FILES: dict[str, Callable[[Path], None]] = {"any cubemap": _any_cubemap, "living room": _living_room}


@pytest.mark.heavy
@on_newest
@pytest.mark.parametrize("name", [*SAMPLES, *FILES])
def test_a_sample_looks_as_with_everything_on(name: str, tmp_path: Path) -> None:
    SAMPLES[name]() if name in SAMPLES else FILES[name](tmp_path)
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.seed, scene.cycles.use_denoising = 2, 7, False
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
    for probe in probes():
        probe.pcc_probe.resolution, probe.pcc_probe.samples, probe.pcc_probe.denoise = 32, 1, False
    bpy.context.view_layer.update()
    found = compare([scene.frame_current])
    tolerance = found.allowed + found.steepest * ANGLE if name == "any cubemap" else None
    check(found, tmp_path, pformat(statuses(scene, bpy.context.view_layer)), tolerance)


# Radians between the directions that a lookup of an aligned box and one of any box find, seen from the capture point in
# a room of 2 : 1 at most. Along the face normals each component is a sum of three products, 3 half ulps of a vector of
# length √3, for the ray and for its start; then the reciprocal distance (4), its product and the difference (2).
ANGLE = 2.0 * (2.0 * 3.0 * 3.0**0.5 + 6.0) * 2.0**-24
