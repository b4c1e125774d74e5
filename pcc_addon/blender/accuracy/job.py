"""A cost run as one object: the shell drives it, a step at a time; the operator lets a shell of its own do so."""

from __future__ import annotations

import platform
import time
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime
from os import cpu_count
from pathlib import Path
from statistics import median

import bpy
import numpy as np

from ...core.accuracy import files
from ...core.accuracy.advice import advice
from ...core.accuracy.flip import flip
from ...core.accuracy.foresight import Foresight, renders
from ...core.accuracy.halves import Halves
from ...core.accuracy.heat import heat_map
from ...core.accuracy.labels import counted, label
from ...core.accuracy.ladder import ladder
from ...core.accuracy.metrics import flicker, noise_of_halves, relative_rmse
from ...core.accuracy.records import CostReport, Kind, Measurement, Settings, Truth
from ...core.accuracy.refine import next_rung
from ...core.accuracy.results import ResultsFolder
from ...core.errors import PccError
from ...core.workplace import workplace
from ..stepping import SteppedJob
from . import truth
from .bench import Bench, corrections, own_settings
from .key import run_key
from .question import Question, subject_of
from .served import served_pixels

_TRUTH_SHARE = 0.22  # of the budget
_SPARE = 1.0  # seconds, for choosing what comes next
_SEED, _SEED_OF_TRUTH, _SEED_AFRESH = 11, 1000, 500_000


class CostJob(SteppedJob):
    """Measures what accuracy costs in the open file; what was measured is kept however it ends.

    The file is changed as the measurements need it, and not changed back: open it again afterwards, or throw it away.

    Attributes:
        notes: what the user should know, in words, in their order.
        report: what was found out so far; None before the truth is there.
    """

    def __init__(
        self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, question: Question, folder: Path, *, resume: bool
    ) -> None:
        """A run that has not begun.

        Args:
            scene, view_layer: what is rendered.
            question: what is asked.
            folder: for results; made where it is missing.
            resume: whether to go on with what was kept there.
        """
        super().__init__()
        self.notes: list[str] = []
        self.report: CostReport | None = None
        self._scene, self._view_layer, self._question = scene, view_layer, question
        self._folder, self._resume = folder, resume
        self._begin = time.perf_counter()
        self._before = 0.0  # seconds of the runs that this one goes on with
        self._around_bake = 0.0  # seconds of a bake that is hardly more than nothing
        self._masks: list[np.ndarray] = []
        self._truths: list[Halves] = []

    def _went_on(self, told: object) -> None:
        self.message = str(told)
        self.progress = min(1.0, max(self.progress, self._elapsed / self._question.seconds))

    def run(self) -> CostReport | None:
        """All steps at once."""
        self.finish()
        return self.report

    @property
    def _elapsed(self) -> float:
        return self._before + time.perf_counter() - self._begin

    @property
    def _recommended(self) -> Measurement | None:
        """What is best so far."""
        chosen = advice(self.report).recommended
        return None if chosen is None else self.report.measurements[chosen]

    @property
    def _exposure(self) -> float:
        """Stops by which pictures are brightened: all but the brightest hundredth of the truth is below white."""
        return -float(np.log2(max(np.quantile(self._truths[0].mean.max(-1), 0.99), 1e-6)))

    @property
    def _left(self) -> float:
        return self._question.seconds - self._elapsed

    def _run(self) -> Iterator[str]:
        subject = self._subject = subject_of(self._question, self._scene, self._view_layer)
        own = own_settings(subject.probe, subject.engine, 16)
        self._key = run_key(self._scene, self._view_layer, subject)
        self._kept = ResultsFolder(self._folder)
        self._open_kept()
        self._scene.camera = subject.camera
        bakes = workplace(self._stack)
        self._bench = Bench(self._scene, self._view_layer, subject.probe, subject.size, subject.frames, bakes)
        yield from self._bench.find_fit()
        yield from self._find_served(own)
        yield from self._find_truth()
        yield from self._climb(own)
        yield from self._measure_afresh()

    def _open_kept(self) -> None:
        """Go on with the run that was kept, where that is asked for and it was of the same."""
        kept = files.read(self._folder) if self._resume else None
        if kept is not None and kept.key == self._key:
            self.report = replace(kept, budget=self._question.budget, target=self._question.target)
            self._before = kept.seconds
            self.notes.append(f"goes on with {counted(len(kept.measurements), 'measurement')}")
            return
        truth_begun = self._kept.halves(0, self._key) if self._resume else None
        if truth_begun is not None:
            self._before = truth_begun.seconds
            self.notes.append(f"goes on with a truth of {2 * truth_begun.samples} samples")
            return
        if kept is not None:
            self.notes.append("the scene, the probe or what is asked has changed since: begins anew")
        elif self._resume:
            self.notes.append(f"'{self._folder}' holds nothing to go on with: begins anew")
        self._kept.clear()

    def _find_served(self, own: Settings) -> Iterator[str]:
        """The pixels of each frame that the probe serves."""
        subject, size = self._subject, self._subject.size
        coarse = replace(own, correction="BOX", resolution=16, bake_samples=1)
        with closing(self._bench.bake(coarse, _SEED)) as bake:
            yield from (f"finding what the probe serves: {message}" for message in bake)
        self._around_bake = self._bench.last_bake.seconds
        for k, number in enumerate(subject.frames):
            self._bench.go_to(number)
            mask = served_pixels(self._scene, self._view_layer, subject.probe, size.width, size.height)
            self._masks.append(mask)
            self._kept.keep_array(f"served_{k}", mask)
            yield f"finding what the probe serves: frame {number}"
        if not all(mask.any() for mask in self._masks):
            raise PccError(
                f"probe '{subject.probe.name}' serves no pixel that camera '{subject.camera.name}' sees; turn the "
                "camera to a surface that shows the probe (the plan names them), or name another with --camera"
            )

    def _find_truth(self) -> Iterator[str]:
        frames = self._subject.frames
        each = _TRUTH_SHARE * self._question.seconds / len(frames)
        for k, number in enumerate(frames):
            kept = self._kept.halves(k, self._key)
            seed = _SEED_OF_TRUTH * (k + 1) + (2 * kept.samples if kept else 0)
            last = None
            for halves in truth.deepened(self._bench, number, self._masks[k], each, kept, seed):
                if halves is not kept:
                    self._kept.keep_halves(k, halves, self._key)
                last = halves
                yield f"truth of frame {number}: {2 * halves.samples} samples"
            self._truths.append(last)
        first, mask = self._truths[0], self._masks[0]
        self._kept.keep_array("truth", first.mean)
        found = Truth(
            samples=2 * first.samples,
            noise=noise_of_halves(first.first, first.second, mask),
            seconds=first.seconds,
            served=float(mask.mean()),
            picture=self._kept.keep_shown("truth", first.mean, self._exposure),
        )
        self._keep(self._report_of(found) if self.report is None else replace(self.report, truth=found))
        target = self._question.target
        if target is not None and found.noise > target:
            self.notes.append(
                f"the truth's own noise is {found.noise:.2g}, above the target of {target:g}: errors are uncertain; "
                "give it more seconds with --budget"
            )
        yield "truth found"

    def _climb(self, own: Settings) -> Iterator[str]:
        """Measure rung after rung, as long as there is time for one and for measuring the best once more."""
        halves = "half_float" in self._subject.probe.pcc_probe.bl_rna.properties
        fits, pairs = self._bench.fit is not None, self._bench.partner is not None
        all_rungs = (*ladder(self._subject.engine, corrections(), halves=halves, fits=fits, pairs=pairs), own)
        while (rung := self._next([each for each in all_rungs if not self._bench.is_needless(each)])) is not None:
            yield from self._measured(rung, _SEED)

    def _next(self, rungs: Sequence[Settings]) -> Settings | None:
        foresight, baked, left = self._foresight(), self._bench.baked, self._left - _SPARE
        best = self._recommended
        again = foresight.seconds(best.settings, ()) if best else 0.0

        def fits(rung: Settings) -> bool:
            return foresight.seconds(rung, baked) + max(again, foresight.seconds(rung, ())) <= left

        return next_rung(self.report, [rung for rung in rungs if fits(rung)], left)

    def _foresight(self) -> Foresight:
        size, first = self._subject.size, self._truths[0]
        pixels = size.width * size.height
        per_sample = first.seconds / (2.0 * first.samples * pixels)
        frames, bench = len(self._subject.frames), self._bench
        return Foresight(self.report.measurements, frames, pixels, per_sample, bench.quickest, self._around_bake)

    def _measured(self, rung: Settings, seed: int) -> Iterator[str]:
        """Measure a rung and keep what was found; a bake that takes too long is given up."""
        if rung.kind is Kind.PROBE and rung.bake_key not in self._bench.baked:
            with closing(self._bench.bake(rung, seed, most_seconds=max(self._left, 0.1))) as bake:
                for message in bake:
                    yield f"{label(rung)}: {message}"
                    if self._left < 0.0:
                        self.notes.append(f"{label(rung)}: its bake did not end in time")
                        return
        name = f"rung_{len(self.report.measurements) + 1:03d}"
        measurement, _ = yield from self._seen(rung, seed, name)
        self._keep(replace(self.report, measurements=(*self.report.measurements, measurement), afresh=None))
        yield f"{label(rung)}: error {measurement.rmse:.4f}"

    def _seen(self, rung: Settings, seed: int, name: str) -> Generator[str, None, tuple[Measurement, np.ndarray]]:
        """Render the frames of a rung whose bake is there, and compare them with the truth; returns the first too."""
        self._bench.show(rung)
        frames, pictures, seconds = self._subject.frames, [], []
        for k, number in enumerate(frames):
            taken = self._bench.frame(rung, number, seed + k)
            pictures.append(taken.pixels)
            seconds.append(taken.seconds)
            yield f"{label(rung)}: frame {number}"
        while len(seconds) < renders(seconds[0], len(frames)):
            seconds.append(self._bench.frame(rung, frames[0], seed + len(seconds)).seconds)
            yield f"{label(rung)}: frame {frames[0]} once more, for its seconds"
        truths = [halves.mean for halves in self._truths]
        errors = [relative_rmse(*each) for each in zip(pictures, truths, self._masks, strict=True)]
        bake = self._bench.bake_of(rung) if rung.kind is Kind.PROBE else None
        measurement = Measurement(
            settings=rung,
            rmse=float(np.sqrt(np.square(errors).mean())),
            flip=float(np.mean([flip(*each) for each in zip(pictures, truths, self._masks, strict=True)])),
            flicker=flicker(pictures, truths, self._masks),
            bake_seconds=bake.seconds if bake else 0.0,
            frame_seconds=median(seconds),
            megabytes=bake.megabytes if bake else 0.0,
            samplers=self._bench.samplers(),
            picture=self._kept.keep_shown(name, pictures[0], self._exposure),
        )
        return measurement, pictures[0]

    def _measure_afresh(self) -> Iterator[str]:
        """The recommended rung once more, with another seed and a bake of its own: do the predictions hold?"""
        best = self._recommended
        if best is None:
            self.notes.append("there was no time to measure anything; give more seconds with --budget")
            return
        if self.report.afresh is not None:
            return
        if self._foresight().seconds(best.settings, ()) > max(self._left, 0.0):
            self.notes.append("there was no time to measure the best once more; give more seconds with --budget")
            return
        if best.settings.kind is Kind.PROBE:
            with closing(self._bench.bake(best.settings, _SEED_AFRESH)) as bake:
                yield from (f"measuring the best afresh: {message}" for message in bake)
        afresh, picture = yield from self._seen(best.settings, _SEED_AFRESH, "rung_afresh")
        heat = self._kept.keep_png("heat", heat_map(picture, self._truths[0].mean, self._masks[0]).png)
        self._keep(replace(self.report, afresh=afresh, heat_map=heat))
        yield "measured the best afresh"

    def _report_of(self, found: Truth) -> CostReport:
        """A report without measurements."""
        subject = self._subject
        return CostReport(
            file=self._question.called or Path(bpy.data.filepath).name,
            scene=self._scene.name,
            camera=subject.camera.name,
            probe=subject.probe.name,
            engine=subject.engine,
            width=subject.size.width,
            height=subject.size.height,
            frames=subject.frames,
            truth=found,
            where=_where(),
            budget=self._question.budget,
            target=self._question.target,
            key=self._key,
        )

    def _keep(self, report: CostReport) -> None:
        self.report = replace(report, seconds=self._elapsed)
        files.keep(self.report, self._folder)


def _where() -> str:
    """What was measured with."""
    processor = platform.processor() or platform.machine()
    day = datetime.now(UTC).date().isoformat()
    return f"{processor}, {cpu_count()} cores, Blender {bpy.app.version_string}, {day}"
