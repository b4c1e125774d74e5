"""`pcc fit`: how boxes fit the rooms around them, and what would; with what that does to the picture."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from ..blender.accuracy.fit_errors import picture_errors
from ..blender.fitting import FitJob, FittedProbe, apply_fit
from ..blender.read.probes import named_probes
from ..core.errors import PccError
from ..core.fit import report
from ..stopping import Stop
from .chosen import chosen_probes
from .voice import Voice


def run(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    """Fit the probes, say what was found, and apply it where that is asked for."""
    if (options.save or options.output) and not options.apply:
        raise PccError(
            "nothing would be saved that is not in the file already; add --apply, or leave --save and --output out"
        )
    scene = bpy.context.scene
    probes = chosen_probes(options)
    job = FitJob(scene, bpy.context.view_layer, probes)
    try:
        while job.step():
            stop.check()
            voice.progress(job.progress, job.message)
    except BaseException:
        job.cancel()
        raise
    failures = sum(not _tell(result, voice) for result in job.results)
    found = [result for result in job.results if result.fit is not None]
    if options.render:
        failures += sum(not _measured(result, voice, stop) for result in found)
    if options.apply:
        failures += sum(not _applied(result, voice) for result in found)
    return failures


def _tell(result: FittedProbe, voice: Voice) -> bool:
    """Tell of one probe's fit; returns whether there is one."""
    if result.fit is None:
        voice.error(result.error)
        return False
    details = report.record(result.fit)
    voice.event("fitted", f"'{result.probe}': {report.headline(result.fit)}", probe=result.probe, **details)
    for line in report.lines(result.fit):
        voice.event("note", f"probe '{result.probe}': {line}", probe=result.probe, note=line)
    return True


def _measured(result: FittedProbe, voice: Voice, stop: Stop) -> bool:
    """Tell what the fit does to the camera's picture; returns whether that could be told. The file is as before."""
    blend = Path(bpy.data.filepath)
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    [probe] = named_probes(scene, [result.probe])
    work = picture_errors(scene, view_layer, probe, result.fit)
    try:
        while True:
            stop.check()
            try:
                voice.progress(0.0, f"{result.probe}: {next(work)}")
            except StopIteration as end:
                errors = end.value
                break
    except PccError as error:
        voice.error(str(error))
        return False
    finally:
        work.close()
        bpy.ops.wm.open_mainfile(filepath=str(blend), load_ui=False)  # as it was before it was measured on
    text = f"'{result.probe}': {errors}"
    voice.event("measured", text, probe=result.probe, before=errors.before, after=errors.after)
    return True


def _applied(result: FittedProbe, voice: Voice) -> bool:
    """Give a probe its fit; returns whether that was done."""
    try:
        apply_fit(named_probes(bpy.context.scene, [result.probe])[0], result.fit, bpy.context.view_layer)
    except PccError as error:
        voice.error(str(error))
        return False
    voice.event("applied", f"probe '{result.probe}' has the new box and capture point", probe=result.probe)
    return True
