"""`pcc cost`: how good the probe is, what that costs, and what to set."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path

import bpy

from ..blender.accuracy import applying
from ..blender.accuracy.job import CostJob
from ..blender.accuracy.question import Question
from ..core.accuracy import files, labels
from ..core.accuracy.advice import Advice, advice
from ..core.accuracy.page import write_page
from ..core.accuracy.plotting import draw_plots
from ..core.accuracy.records import CostReport, Measurement
from ..core.errors import PccError
from ..core.probe import Engine
from ..core.workplace import real
from ..stopping import Stop
from .voice import Voice

_KEPT = "what was measured is kept in {}; --resume goes on with it"


def run(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    """Measure, say what follows, and apply it where that is asked for."""
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    blend = Path(bpy.data.filepath)
    folder = real(options.out) if options.out else applying.results_folder(blend)
    question = Question(
        probe=options.probe,
        camera=options.camera,
        engine=Engine(options.engine) if options.engine else None,
        frames=options.frames,
        target=options.target_error,
        budget=options.budget,
        quick=options.quick,
        width=options.width,
        called=options.called,
    )
    job = CostJob(scene, view_layer, question, folder, resume=options.resume)
    try:
        _drive(job, voice, stop)
    except BaseException:
        job.cancel()
        if job.report is not None:
            voice.event("note", _KEPT.format(folder), note=_KEPT.format(folder))
        raise
    finally:
        bpy.ops.wm.open_mainfile(filepath=str(blend), load_ui=False)  # as it was before it was measured on
    report = job.report
    _write_results(report, folder, voice)
    found = advice(report)
    for sentence in found.sentences:
        voice.event("advice", sentence, advice=sentence)
    if report.afresh is not None:
        _tell_afresh(report, voice)
    if found.recommended is None:
        raise PccError("no setting of the probe could be measured in time; give more seconds with --budget")
    if options.apply:
        _apply(report, found, voice)
    return 0 if found.meets_target in (None, True) else _missed(report, voice)


def _write_results(report: CostReport, folder: Path, voice: Voice) -> None:
    """Tables, plots where they can be drawn, and the page that shows them."""
    table, _ = files.write_tables(report, folder)
    missing = ""
    try:
        draw_plots(table, folder)
    except PccError as error:
        missing = str(error)
        voice.event("note", missing, note=missing)
    shown = write_page(report, folder, missing)
    voice.event("results", f"results are in {folder}; open {shown.name}", folder=str(folder), page=str(shown))


def _drive(job: CostJob, voice: Voice, stop: Stop) -> None:
    """Do all steps, and tell what comes of them."""
    told, noted, truth_told = 0, 0, False
    while job.step():
        stop.check()
        for note in job.notes[noted:]:
            voice.event("note", note, note=note)
        noted = len(job.notes)
        if job.report is not None:
            if not truth_told:
                _tell_truth(job.report, voice)
                told = len(job.report.measurements)
                truth_told = True
            for measurement in job.report.measurements[told:]:
                _tell_measurement(measurement, voice)
            told = len(job.report.measurements)
        voice.progress(job.progress, job.message)
    for note in job.notes[noted:]:
        voice.event("note", note, note=note)


def _tell_truth(report: CostReport, voice: Voice) -> None:
    truth = report.truth
    text = (
        f"the probe serves {truth.served:.0%} of the picture; the truth has {truth.samples} samples and a noise of "
        f"{labels.error(truth.noise)}, in {labels.seconds(truth.seconds)}"
    )
    voice.event("truth", text, samples=truth.samples, noise=truth.noise, seconds=truth.seconds, served=truth.served)


def _tell_measurement(measurement: Measurement, voice: Voice) -> None:
    name = labels.label(measurement.settings)
    bake = f", bakes in {labels.seconds(measurement.bake_seconds)}" if measurement.bake_seconds else ""
    text = f"{name}: error {labels.error(measurement.rmse)}{bake}, {labels.seconds(measurement.frame_seconds)} a frame"
    voice.event("measured", text, measurement=asdict(measurement))


def _tell_afresh(report: CostReport, voice: Voice) -> None:
    """What was predicted of the recommended setting, and what came of it."""
    afresh = report.afresh
    predicted = next(m for m in report.measurements if m.settings == afresh.settings)
    text = (
        f"predicted: error {labels.error(predicted.rmse)}, bake {labels.seconds(predicted.bake_seconds)}, frame "
        f"{labels.seconds(predicted.frame_seconds)}; measured afresh: error {labels.error(afresh.rmse)}, bake "
        f"{labels.seconds(afresh.bake_seconds)}, frame {labels.seconds(afresh.frame_seconds)}"
    )
    voice.event("afresh", text, predicted=asdict(predicted), measured=asdict(afresh))


def _apply(report: CostReport, found: Advice, voice: Voice) -> None:
    probe = applying.apply_to(bpy.context.scene, bpy.context.view_layer, report, found)
    settings = report.measurements[found.recommended].settings
    text = f"probe '{probe.name}' is set to {labels.of_bake(settings)}; bake it to see it"
    voice.event("applied", text, probe=probe.name, settings=asdict(settings), advice=probe.pcc_probe.advice)


def _missed(report: CostReport, voice: Voice) -> int:
    voice.error(
        f"no setting that was measured meets the target of {labels.error(report.target)}; the sentences above say what "
        "comes nearest"
    )
    return 1
