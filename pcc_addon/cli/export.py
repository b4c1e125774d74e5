"""`pcc export`: baked probes for another engine."""

from __future__ import annotations

import argparse

import bpy

from ..blender.export import Exported, ExportJob
from ..core.export.targets import target_of
from ..core.workplace import real
from ..stopping import Stop
from .chosen import chosen_probes
from .voice import Voice


def run(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    """Export the probes, and say what was written."""
    probes = chosen_probes(options)
    target = target_of(options.target)
    to = real(options.to)
    job = ExportJob(bpy.context.scene, bpy.context.view_layer, probes, target, to, options.width)
    told = ""
    try:
        while job.step():
            stop.check()
            if job.message != told:
                told = job.message
                voice.progress(job.progress, told)
    except BaseException:
        job.cancel()
        raise
    for result in job.results:
        _tell(result, voice)
    done = [result for result in job.results if result.error is None]
    if done:
        many = "probe" if len(done) == 1 else "probes"
        text = f"wrote {len(done)} {many} for {target.title} into {to}"
        voice.event("exported", text, folder=str(to), target=target.key, probes=[result.probe for result in done])
    return len(job.results) - len(done)


def _tell(result: Exported, voice: Voice) -> None:
    if result.error is not None:
        voice.error(result.error)
        return
    text = f"probe '{result.probe}': {', '.join(result.files)}"
    voice.event("written", text, probe=result.probe, files=list(result.files))
    for note in result.notes:
        voice.event("note", note, note=note)
