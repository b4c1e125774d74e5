"""`pcc misfit`: how a probe's box lies to the room, and what its capture point does not see."""

from __future__ import annotations

import argparse

import bpy

from ..blender.accuracy.misfit_job import MisfitJob, ProbeMisfit
from ..core.accuracy.misfit_files import write_pictures
from ..core.accuracy.misfit_records import record
from ..core.errors import PccError
from ..core.workplace import real
from ..stopping import Stop
from .chosen import chosen_probes
from .voice import Voice


def run(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    """Survey the probes, say what was found, and write pictures where that is asked for."""
    scene = bpy.context.scene
    probes = chosen_probes(options)
    if options.out is not None and options.out.exists() and not options.out.is_dir():
        raise PccError(f"--out '{options.out}' is a file; name a folder")
    job = MisfitJob(scene, bpy.context.view_layer, probes)
    told, message = 0, ""
    try:
        while job.step():
            stop.check()
            while told < len(job.results):
                _tell(job.results[told], options, voice)
                told += 1
            if job.message != message:
                message = job.message
                voice.progress(job.progress, message)
    except BaseException:
        job.cancel()
        raise
    for result in job.results[told:]:
        _tell(result, options, voice)
    return sum(result.error is not None for result in job.results)


def _tell(result: ProbeMisfit, options: argparse.Namespace, voice: Voice) -> None:
    if result.misfit is None or result.unseen is None:
        voice.error(result.error or "")
        return
    text = "\n".join([f"probe '{result.probe}':", *(f"    {line}" for line in result.lines)])
    details = record(result.misfit, result.unseen)
    voice.event(
        "misfit", text, probe=result.probe, lines=list(result.lines), seconds=round(result.seconds, 3), **details
    )
    if options.out is not None:
        for path in write_pictures(result.misfit, result.unseen, real(options.out)):
            voice.event("picture", f"wrote {path}", probe=result.probe, file=str(path))
