"""The subcommands: each does one job on the open file, says what it did, and returns how much of it failed."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

import bpy

from ..blender.bake.job import BakedProbe, BakeJob
from ..blender.planning import plan_scene
from ..blender.saving import save_whole
from ..blender.shade import injection
from ..blender.status import statuses, waiting_probes
from ..blender.store import leftovers
from ..blender.store.levels import bake_folder
from ..core.errors import PccError
from ..core.frames import FrameRange, parse_frames
from ..core.picture_files import picture_files
from ..core.plan_report import lines, records
from ..core.probe import MAXIMUM_RESOLUTION, MINIMUM_RESOLUTION, MOST_SAMPLES, Source
from ..stopping import Stop
from . import cost, fit, misfit
from .chosen import chosen_probes
from .voice import Voice


def open_file(path: Path) -> None:
    """Open a .blend without its windows.

    Raises:
        PccError: Blender cannot open it.
    """
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False)
    except RuntimeError as error:
        raise PccError(
            f"'{path}' cannot be opened: it is damaged or no .blend file; give a file that Blender opens"
        ) from error


def save(options: argparse.Namespace, voice: Voice) -> None:
    """Save the open file where that was asked for.

    Raises:
        PccError: it could not be written whole.
    """
    if not getattr(options, "save", False) and not getattr(options, "output", None):
        return
    path = options.output.resolve() if options.output else Path(bpy.data.filepath)
    save_whole(path)
    voice.event("saved", f"saved {path}", file=str(path))


def words_of_cancelling(voice: Voice) -> str:
    """What was and was not done when the user stopped a command."""
    if voice.said("saved"):
        return "cancelled, but the file had been saved already"
    unused = leftovers.unsaved()
    folders = ", ".join(sorted({f"'{path.parent}'" for path in unused}))
    pictures = f"; {len(unused)} new pictures in {folders} belong to no saved file" if unused else ""
    return f"cancelled; nothing was saved{pictures}"


def _bake(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    frames = _frames(options.frames)
    probes = chosen_probes(options)
    _apply_settings(options, probes)
    if options.stale:
        waiting = waiting_probes(scene, view_layer, probes, frames)
        probes = list(waiting.probes)
        for line in waiting.unneeded:
            voice.event("note", line, note=line)
    folder = bake_folder(scene, str(options.output.resolve()) if options.output else None)
    job = BakeJob(scene, view_layer, probes, folder, frames, reuse=options.stale)
    told = 0
    try:
        while job.step():
            stop.check()
            told += _tell_results(job.results[told:], voice)
            voice.progress(job.progress, job.message)
    except BaseException:
        job.cancel()
        raise
    finally:
        told += _tell_results(job.results[told:], voice)
    failures = sum(result.error is not None for result in job.results)
    for line in job.missing_textures:
        failures += not options.allow_missing_textures
        voice.error(f"{line}, and bake again; until then it is baked in pink")
    if options.inject and voice.said("baked"):
        stop.check()
        failures += _inject(options, voice, stop)
    return failures


def _frames(asked: str | None) -> FrameRange | str | None:
    try:
        return parse_frames(asked)
    except PccError as error:
        raise PccError(f"--frames: {error}") from error


def _tell_results(results: Sequence[BakedProbe], voice: Voice) -> int:
    """Tell what became of some probes; returns how many there are."""
    for result in results:
        if result.error is not None:
            voice.error(result.error)
            continue
        voice.event("baked", f"baked {result}", **asdict(result))
        for line in (*result.replaced_pixels, *result.warnings):
            voice.event("note", f"probe '{result.probe}': {line}", probe=result.probe, note=line)
    return len(results)


def _apply_settings(options: argparse.Namespace, probes: Sequence[bpy.types.Object]) -> None:
    if options.resolution is not None and not MINIMUM_RESOLUTION <= options.resolution <= MAXIMUM_RESOLUTION:
        raise PccError(
            f"--resolution {options.resolution}: choose between {MINIMUM_RESOLUTION} and {MAXIMUM_RESOLUTION} pixels"
        )
    if options.samples is not None and not 1 <= options.samples <= MOST_SAMPLES:
        raise PccError(f"--samples {options.samples}: choose between 1 and {MOST_SAMPLES}")
    if options.picture is not None:
        for probe in probes:
            picture_files(probe.name, str(options.picture))
            probe.pcc_probe.source, probe.pcc_probe.picture = Source.IMAGE.value, str(options.picture.resolve())
    for name in ("engine", "resolution", "samples"):
        value = getattr(options, name)
        if value is not None:
            for probe in probes:
                setattr(probe.pcc_probe, name, value)


def _inject(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    report = injection.inject(bpy.context.scene, bpy.context.view_layer)
    for material, probe in report.materials:
        voice.event("injected", f"material '{material}' shows '{probe}'", material=material, probe=probe)
    for note in report.notes:
        voice.event("note", note, note=note)
    return 0


def _remove(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    for name in injection.remove():
        voice.event("restored", f"material '{name}' restored", material=name)
    return 0


def _plan(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    if options.json:
        for record in records(plan):
            voice.event("plan", "", **record)
    else:
        for line in lines(plan):
            voice.event("plan", line)
    return 0


def _status(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    found = statuses(bpy.context.scene, bpy.context.view_layer)
    if not found:
        raise PccError(f"scene '{bpy.context.scene.name}' has no parallax probe; add one")
    for status in found:
        why = f": {status.words}" if status.words else ""
        voice.event("status", f"{status.probe}: {status.state}{why}", **asdict(status))
    return sum(status.state == "error" for status in found)


COMMANDS: dict[str, Callable[[argparse.Namespace, Voice, Stop], int]] = {
    "bake": _bake,
    "fit": fit.run,
    "inject": _inject,
    "remove": _remove,
    "plan": _plan,
    "status": _status,
    "cost": cost.run,
    "misfit": misfit.run,
}
# What must have happened before a file is saved, by command; others save whatever they did.
WORK = {"bake": "baked", "fit": "applied"}
