"""`pcc bake`: probes of the open file, in this process or shared with others, and what is told of it."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

import bpy

from ..blender.bake.crew import Crew
from ..blender.bake.going_on import Going
from ..blender.bake.job import BakedProbe, BakeJob
from ..blender.read.probes import unlocked
from ..blender.status import stale_probes, waiting_probes
from ..blender.store.levels import bake_folder
from ..core import manifest
from ..core.errors import PccError
from ..core.frames import FrameRange, parse_frames
from ..core.manifest import manifest_file
from ..core.picture_files import picture_files
from ..core.probe import MAXIMUM_RESOLUTION, MINIMUM_RESOLUTION, MOST_SAMPLES, Source
from ..core.shares import Share
from ..core.workplace import real
from ..stopping import Stop
from ..version import ADDON_VERSION
from .chosen import chosen_probes, chosen_scene, chosen_view_layer
from .injecting import let_show
from .voice import Voice

_MOST_JOBS = 256


def run(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    """Bake; returns how much failed."""
    scene, view_layer = chosen_scene(options), chosen_view_layer(options)
    frames = _frames(options.frames)
    chosen = probes = chosen_probes(options)
    if not options.probe:
        probes, locked = unlocked(probes)
        for line in locked:
            voice.event("note", line, note=line)
    _apply_settings(options, probes)
    if options.stale:
        waiting = waiting_probes(scene, view_layer, probes, frames)
        probes = list(waiting.probes)
        for line in waiting.unneeded:
            voice.event("note", line, note=line)
    elif options.resume or options.jobs > 1:
        probes = stale_probes(scene, view_layer, probes, frames)
    folder = _folder(options, scene)
    count, fresh = len(probes), any(probe.pcc_probe.bake_record for probe in chosen)
    voice.event("baking", f"baking {count} {'probe' if count == 1 else 'probes'}", probes=[p.name for p in probes])
    teller = _Teller(voice, _manifest(options, folder))
    if options.jobs > 1 and probes:
        given_up = _shared(options, scene, view_layer, probes, folder, voice, stop)
        teller.tell([BakedProbe(name, why) for name, why in given_up.items()])
        probes = [probe for probe in probes if probe.name not in given_up]
    resumes = options.resume or options.jobs > 1 or options.share is not None
    going = Going(resumes, Share.parse(options.share) if options.share else None)
    job = BakeJob(scene, view_layer, probes, folder, frames, options.stale or resumes, going)
    told = 0
    try:
        while job.step():
            stop.check()
            told += teller.tell(job.results[told:])
            voice.progress(job.progress, job.message, probe=job.probe)
    except BaseException:
        job.cancel()
        raise
    finally:
        teller.tell(job.results[told:])
    failures = teller.failures
    for line in job.missing_textures:
        failures += not options.allow_missing_textures
        voice.error(f"{line}, and bake again; until then it is baked in pink")
    if options.inject and (voice.said("baked") or (not count and fresh)):
        stop.check()
        failures += let_show(scene, view_layer, voice)
    return failures


class _Teller:
    """Tells what becomes of probes, and writes it into the manifest.

    Attributes:
        failures: how many probes have no new bake, and whether the manifest has not all.
    """

    def __init__(self, voice: Voice, path: Path | None) -> None:
        self.failures = 0
        self._voice, self._path = voice, path

    def tell(self, results: Sequence[BakedProbe]) -> int:
        """Tell of some probes; returns how many there are."""
        for result in results:
            self.failures += result.error is not None
            self._note(result)
            if result.error is not None:
                self._voice.error(result.error, probe=result.probe)
                continue
            kind, did = ("baked", "baked") if result.whole else ("captured", "kept faces of")
            self._voice.event(kind, f"{did} {result}", **asdict(result))
            for line in (*result.replaced_pixels, *result.warnings):
                self._voice.event("note", f"probe '{result.probe}': {line}", probe=result.probe, note=line)
        return len(results)

    def _note(self, result: BakedProbe) -> None:
        """Write a line of the manifest; where that is not possible, the bake goes on without."""
        if self._path is None:
            return
        try:
            manifest.add(self._path, _entry(result))
        except PccError as error:
            self._path = None
            self.failures += 1
            self._voice.error(str(error))


def _entry(result: BakedProbe) -> dict[str, object]:
    """What the manifest says of a probe."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "blend": bpy.data.filepath,
        **asdict(result),
        "addon": ADDON_VERSION,
        "blender": bpy.app.version_string,
    }


def _folder(options: argparse.Namespace, scene: bpy.types.Scene) -> Path | None:
    """Where pictures go; None packs them."""
    if options.folder is not None:
        return real(options.folder)
    return bake_folder(scene, str(real(options.output)) if options.output else None)


def _manifest(options: argparse.Namespace, folder: Path | None) -> Path | None:
    """Where it is written that a bake is done; not by who bakes for somebody else, who writes it."""
    if options.attended or options.share:
        return None
    if options.manifest is not None:
        return real(options.manifest)
    return manifest_file(folder, Path(bpy.data.filepath)) if folder and bpy.data.filepath else None


def _shared(
    options: argparse.Namespace,
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    probes: Sequence[bpy.types.Object],
    folder: Path | None,
    voice: Voice,
    stop: Stop,
) -> dict[str, str]:
    """Let several processes bake into the folder what the bake here takes from there; why some probes were given up."""
    if folder is None or not bpy.data.filepath:
        raise PccError("--jobs: the processes read the file from the disk; save it first, or leave --jobs out")
    arguments = ["--resume", f"--folder={folder}", f"--scene={scene.name}", f"--view-layer={view_layer.name}"]
    arguments += [f"--probe={probe.name}" for probe in probes]
    arguments += [
        f"--{name}={value}"
        for name in ("engine", "resolution", "samples", "frames", "picture")
        if (value := getattr(options, name)) is not None
    ]
    with ExitStack() as stack:
        crew = Crew(stack, Path(bpy.data.filepath), arguments, min(options.jobs, _MOST_JOBS))
        while crew.step():
            stop.check()
            voice.progress(crew.progress, crew.message, probe="")
        return dict(crew.given_up)


def _frames(asked: str | None) -> FrameRange | str | None:
    try:
        return parse_frames(asked)
    except PccError as error:
        raise PccError(f"--frames: {error}") from error


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
            probe.pcc_probe.source, probe.pcc_probe.picture = Source.IMAGE.value, str(real(options.picture))
    for name in ("engine", "resolution", "samples"):
        value = getattr(options, name)
        if value is not None:
            for probe in probes:
                setattr(probe.pcc_probe, name, value)
