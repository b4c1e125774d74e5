"""An animated room: errors of stills and of a sequence over the frames, and what sharing pictures between frames saves.

python3 dev.py run benchmarks/moving.py [PICTURES]
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from benchmarks.doorway import _keep as keep
from benchmarks.measure import masks, relative_rmse, render, start, table, write_page
from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.core.probe import Engine
from sample_blends.moving import BLINKS, FRAMES, moving

SHOWN = (1, 8, 14, 20, 27, 31)
RESOLUTION, SAMPLES, TRUTH_SAMPLES, EEVEE_SAMPLES = 64, 8, 96, 2
PROBES = ("Ball Probe", "Room Probe")
PARTS = {"ball": "Ball", "floor": "Wall -Z"}
ALL = f"{FRAMES[0]}-{FRAMES[1]}"


def build(folder: Path) -> bpy.types.Scene:
    """The sample, small, saved in a folder; its world's light in EEVEE is none."""
    scene = moving()
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    for name in PROBES:
        settings = bpy.data.objects[name].pcc_probe
        settings.resolution, settings.samples, settings.denoise = RESOLUTION, SAMPLES, False
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "moving.blend"))
    return scene


@dataclass(frozen=True)
class Bake:
    """What a bake cost."""

    pictures: int
    rendered: int
    seconds: float


def bake(frames: str, scope: str = "ALL") -> Bake:
    """Bake both probes; only pictures that are new where the scope is STALE."""
    before = {level.digest for name in PROBES for level in _levels(name)} if scope == "STALE" else set()
    begin = time.perf_counter()
    assert bpy.ops.pcc.bake(scope=scope, frames=frames) == {"FINISHED"}
    seconds = time.perf_counter() - begin
    sharp = [level for name in PROBES for level in _levels(name) if level.roughness == 0.0]
    return Bake(len(sharp), sum(level.digest not in before for level in sharp), seconds)


def _levels(probe: str) -> tuple:
    record = bake_record(bpy.data.objects[probe])
    return record.levels if record else ()


@contextmanager
def sharing_nothing() -> Iterator[None]:
    """Each frame counts as another."""
    asked = SceneFingerprint.content_hash
    SceneFingerprint.content_hash = lambda self, spec: f"{bpy.context.scene.frame_current} {asked(self, spec)}"
    try:
        yield
    finally:
        SceneFingerprint.content_hash = asked


def files(folder: Path) -> tuple[int, float]:
    """How many files the pictures of both probes are, and their megabytes."""
    paths = [folder / level.file for name in PROBES for level in _levels(name)]
    return len(paths), sum(path.stat().st_size for path in paths) / 1e6


def linked(folder: Path) -> tuple[int, float, float]:
    """The same with a name for each frame: files, megabytes on this disk, and once the folder was copied."""
    with tempfile.TemporaryDirectory(dir=folder.parent) as name:
        place = Path(name, "linked")
        place.mkdir()
        for probe in PROBES:
            record = bake_record(bpy.data.objects[probe])
            for level in record.levels:
                for moment in record.moments:
                    if moment.number == level.key.number:
                        os.link(folder / level.file, place / f"{level.file}.{moment.frame}")
        shutil.copytree(place, Path(name, "copied"))
        count = len(list(place.iterdir()))
        here = {path.stat().st_ino: path.stat().st_size for path in place.iterdir()}
        copied = sum(path.stat().st_size for path in Path(name, "copied").iterdir())
        return count, sum(here.values()) / 1e6, copied / 1e6


def errors(scene: bpy.types.Scene, pictures: Path | None) -> dict[str, dict[int, dict[str, float]]]:
    """Relative error by way, frame and part. The sequence is baked last and stays."""
    truth, seen = {}, {}
    for frame in SHOWN:
        scene.frame_set(frame)
        truth[frame], seen[frame] = render(scene, samples=TRUTH_SAMPLES).pixels, masks(scene, PARTS)
        keep(pictures, f"{frame} path-traced", truth[frame])
    found: dict[str, dict[int, dict[str, float]]] = {}
    ways = (
        ("still, uncorrected", "NONE", "still", Engine.CYCLES),
        ("still", "BOX", "still", Engine.CYCLES),
        ("sequence", "BOX", ALL, Engine.CYCLES),
        ("sequence, EEVEE", "BOX", ALL, Engine.EEVEE),
    )
    done = ""
    for way, correction, frames, engine in ways:
        scene.frame_set(FRAMES[0])
        for name in PROBES:
            bpy.data.objects[name].pcc_probe.correction = correction
        if frames != done:
            bake(frames)
            done = frames
        bpy.ops.pcc.inject()
        for frame in SHOWN:
            scene.frame_set(frame)
            picture = render(scene, engine, TRUTH_SAMPLES if engine is Engine.CYCLES else EEVEE_SAMPLES).pixels
            keep(pictures, f"{frame} {way}", picture)
            clipped = np.minimum(picture, 1.0), np.minimum(truth[frame], 1.0)
            found.setdefault(way, {})[frame] = {
                part: relative_rmse(*clipped, mask) for part, mask in seen[frame].items()
            }
    bpy.ops.pcc.remove()
    return found


def change_lamp() -> None:
    """The lamp is half as bright where it was off from the fourth blink on."""
    frame, last = BLINKS[3][0], BLINKS[4][0] - 1
    light = bpy.data.objects["Blinking Lamp"].data
    for at in (frame, last):
        light.energy = 45.0
        light.keyframe_insert("energy", frame=at)


def main() -> None:
    start()
    pictures = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    with redirect_stdout(sys.stderr), tempfile.TemporaryDirectory() as name:
        scene = build(Path(name))
        folder = Path(name, "moving.pcc")
        found = errors(scene, pictures)
        scene.frame_set(FRAMES[0])
        shared = bake(ALL)
        of_shared, (links, here, copied) = files(folder), linked(folder)
        change_lamp()
        scene.frame_set(FRAMES[0])
        again = bake(ALL, "STALE")
        with sharing_nothing():
            alone = bake(ALL)
        of_alone = files(folder)
    count = FRAMES[1] - FRAMES[0] + 1
    heads = ["frame", *(f"{part}: {way}" for part in PARTS for way in found)]
    rows = [[frame, *(f"{found[way][frame][part]:.3f}" for part in PARTS for way in found)] for frame in SHOWN]
    costs = [
        ["one for each frame", alone.rendered, f"{alone.seconds:.0f}", of_alone[0], f"{of_alone[1]:.0f}"],
        ["one for each thing seen", shared.rendered, f"{shared.seconds:.0f}", of_shared[0], f"{of_shared[1]:.0f}"],
        [
            "… with a link for each frame",
            shared.rendered,
            "",
            links,
            f"{here:.0f}; copied {copied:.0f}",
        ],
        ["after the lamp changed at 4 frames", again.rendered, f"{again.seconds:.0f}", "", ""],
    ]
    text = (
        "A chrome ball rolls, a box slides and a door opens until frame 20; from then on only a lamp blinks "
        f"(`sample_blends/moving.py`). Faces of {RESOLUTION} pixels, {SAMPLES} samples, not denoised. The ball's probe "
        "follows it and leaves it out; the floor has a probe in the middle of the room.\n\n"
        f"Relative error of the picture, clipped at 1, against {TRUTH_SAMPLES} path-traced samples of the same frame. "
        "Stills are of frame 1. What is left on the ball is mostly its own image in the floor, which no probe "
        "shows, and the box that stands before the wall; on the floor the ball, which its probe leaves out; and "
        "noise.\n\n"
        + table(heads, rows)
        + f"\n\nPictures of both probes for {count} frames:\n\n"
        + table(["pictures", "rendered", "seconds of the bake", "files", "megabytes"], costs)
        + "\n\n"
        + HOW
    )
    write_page("animation.md", "Animated probes", "python3 dev.py run benchmarks/moving.py", text)


HOW = """## What is baked, and what plays it

`pcc bake --frames A-B[:STEP]`, or *Bake Frames* in the sidebar, reads what each probe sees at each frame: all
that is rendered and not hidden from it, shapes that modifiers, bones and shape keys make, instances, lamps, the
world, its own capture point. Frames at which that is the same share a picture, also where others lie between,
as when a lamp blinks. What nobody can read without rendering (films as textures, cloth, fluids, particles,
grease pencil, animated objects that are disabled in viewports) makes each frame another. Bake simulations
before: frames are not always visited in order.

`pcc status` names the frames that changed since; `pcc bake --stale` (*Bake Stale*) renders these alone. Without
`--frames` each probe keeps the frames that it has; `--frames still` goes back to one picture. Between frames of
a STEP, and after the last one, the picture before stays. The old bake stays until the new one is whole, and the
scene's frame comes back whatever happens; values of animated properties that were changed without a keyframe
are lost, as they are in any change of frame.

*Follow* (a probe's settings) puts the capture point at an object's origin instead of the box's centre, so that
the box can stay on the walls while the object moves; the object and its children, but no lamps, are left out of
the capture. A probe that is parented to something takes its box along.

Nothing of this needs the add-on afterwards: drivers of the frame choose the picture and its capture point,
drivers of the probe's matrix carry the box, in both engines. Pictures of several frames lie beside the .blend;
Blender cannot pack them. *Windows* show a sequence from the capture point of its first picture."""


if __name__ == "__main__":
    main()
