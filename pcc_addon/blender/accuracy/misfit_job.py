"""Where probes err, as one object: the operator and the shell both drive it, a step at a time."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import TypeVar

import bpy
import numpy as np

from ...core.accuracy import misfit_words, unseen_words
from ...core.accuracy.misfit import Misfit, check, misfit
from ...core.accuracy.sampling import sample
from ...core.accuracy.unseen import Unseen, influence_of, unseen, viewers_of
from ...core.cubemap import FACES
from ...core.errors import Cancelled, PccError
from ...core.plan import Plan
from ...core.probe import ProbeSpec
from .. import handlers
from ..bake import faces
from ..bake.capture import Stage
from ..planning import plan_scene
from ..read.probes import check_place, probe_spec
from ..stepping import SteppedJob
from .surfaces import read_triangles, sightings

_TEXELS = 128  # across a face of the survey: walls are as exact with fewer, edges of things are not
_SAMPLES = 20_000
_STEPS = len(FACES) + 4
_T = TypeVar("_T")


@dataclass(frozen=True, eq=False)
class ProbeMisfit:
    """What was found of one probe.

    Attributes:
        probe: its name.
        error: why nothing was found, or None.
        misfit: how its box lies to what it sees; None where there is an error.
        unseen: which surfaces it does not see; None where there is an error.
        fit_lines, unseen_lines: both in words.
        seconds: of the survey and all that follows.
    """

    probe: str
    error: str | None = None
    misfit: Misfit | None = None
    unseen: Unseen | None = None
    fit_lines: tuple[str, ...] = ()
    unseen_lines: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def lines(self) -> tuple[str, ...]:
        """All that is said of it."""
        return (*self.fit_lines, *self.unseen_lines)


class MisfitJob(SteppedJob):
    """Surveys probes.

    Attributes:
        results: one for each probe that is finished or failed.
    """

    def __init__(
        self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probes: Sequence[bpy.types.Object]
    ) -> None:
        """A job that has not begun."""
        super().__init__()
        self.results: list[ProbeMisfit] = []
        self._scene, self._view_layer, self._probes = scene, view_layer, list(probes)

    def run(self) -> list[ProbeMisfit]:
        """All steps at once."""
        self.finish()
        return self.results

    def _run(self) -> Iterator[None]:
        self._view_layer.update()
        specs = list(self._specs())
        if not specs:
            return
        plan = plan_scene(self._scene, self._view_layer)
        yield
        total = _STEPS * len(specs)
        surveys: dict[str, tuple[np.ndarray, float]] = {}
        with ExitStack() as stack:
            stack.enter_context(handlers.paused())
            stack.callback(self._view_layer.update)  # what comes back is no change that anybody need follow
            stage = Stage(stack, self._scene, self._view_layer, specs)
            stack.enter_context(stage.survey())
            for index, spec in enumerate(specs):
                started = time.perf_counter()
                try:
                    nearness = yield from self._told(spec, faces.survey(stage, spec), len(FACES) * index, total)
                except Cancelled:
                    raise
                except PccError as error:
                    self.results.append(ProbeMisfit(spec.name, str(error)))
                    continue
                surveys[spec.name] = nearness, time.perf_counter() - started
        done = len(FACES) * len(specs)
        for spec in specs:
            if spec.name in surveys:
                nearness, seconds = surveys[spec.name]
                found = yield from self._told(spec, self._compared(spec, nearness, plan), done, total)
                self.results.append(replace(found, seconds=found.seconds + seconds))
            done += _STEPS - len(FACES)

    def _specs(self) -> Iterator[ProbeSpec]:
        """Those that can be surveyed; the others are results already."""
        for probe in self._probes:
            try:
                check_place(probe, self._view_layer)
                spec = replace(probe_spec(probe), resolution=_TEXELS)
                check(spec)
            except PccError as error:
                self.results.append(ProbeMisfit(probe.name, str(error)))
            else:
                yield spec

    def _told(
        self, spec: ProbeSpec, work: Generator[str | None, None, _T], done: int, total: int
    ) -> Generator[None, None, _T]:
        """Some work on a probe, with what it yields as what is told; None goes on with the same."""
        while True:
            try:
                told = next(work)
            except StopIteration as end:
                return end.value
            if told is not None:
                self.progress, self.message = done / total, f"{spec.name}: {told}"
                done += 1
            yield

    def _compared(self, spec: ProbeSpec, nearness: np.ndarray, plan: Plan) -> Generator[str | None, None, ProbeMisfit]:
        started = time.perf_counter()
        yield "surfaces"
        triangles = read_triangles(spec, self._view_layer)
        yield "distances to the box"
        samples = sample(triangles, _SAMPLES, influence_of(spec))
        receivers = frozenset(material.material for material in plan.materials if spec.name in material.probes)
        fit = misfit(spec, nearness, viewers_of(samples, receivers))
        yield "what is not seen"
        hidden = unseen(spec, nearness, samples, receivers)
        yield "what is where"
        names = yield from sightings(spec, nearness, self._scene, self._view_layer)
        return ProbeMisfit(
            spec.name,
            misfit=fit,
            unseen=hidden,
            fit_lines=tuple(misfit_words.lines(fit, names)),
            unseen_lines=tuple(unseen_words.lines(hidden)),
            seconds=time.perf_counter() - started,
        )
