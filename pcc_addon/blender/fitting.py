"""Fitting probes' boxes to the rooms around them, a step at a time, and setting the probes so."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix

from ..core.errors import Cancelled, PccError, ProbeError
from ..core.fit.choice import chosen
from ..core.fit.records import Fit, offset_of
from ..core.fit.room import Fitted, fit_room
from ..core.probe import ProbeSpec, Source
from . import handlers
from .bake import faces
from .bake.capture import Stage
from .read.moving import is_animated
from .read.probes import check_own, check_place, probe_spec
from .stepping import SteppedJob

_RESOLUTION = 96  # pixels of a face: a wall of 5 m is found to 0.02 mm, and what is a hand wide is seen
_STEPS = 14  # of a probe: two surveys of six faces, and what is made of each
_EXACT = 1e-4  # of a box's size: how exactly an object must be able to take it
_NO_TURN = 1e-6  # radians that only rounding makes
_DIGITS = 5  # decimals of metres that are kept of a capture offset: pictures are not taken more exactly


@dataclass(frozen=True)
class FittedProbe:
    """What became of one probe.

    Attributes:
        probe: its name.
        error: why it has no fit, or None.
        fit: it, or None.
        seconds: that it took.
    """

    probe: str
    error: str | None = None
    fit: Fit | None = None
    seconds: float = 0.0


class FitJob(SteppedJob):
    """Fits probes of a scene.

    Attributes:
        results: one for each probe that is finished or failed.
    """

    def __init__(
        self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probes: Sequence[bpy.types.Object]
    ) -> None:
        """A fit that has not begun.

        Args:
            scene, view_layer: what is looked at.
            probes: those to fit.
        """
        super().__init__()
        self.results: list[FittedProbe] = []
        self._scene, self._view_layer, self._probes = scene, view_layer, list(probes)

    def steps(self) -> Iterator[str]:
        """All steps, with what is done next after each; closing it cancels. Raises as `step` does."""
        try:
            while self.step():
                yield self.message
        finally:
            self.cancel()

    def run(self) -> list[FittedProbe]:
        """All steps at once."""
        self.finish()
        return self.results

    def _run(self) -> Iterator[None]:
        self._view_layer.update()
        ready = self._read()
        if not ready:
            return
        yield
        self._stack.enter_context(handlers.paused())
        stage = Stage(self._stack, self._scene, self._view_layer, ready)
        self._stack.enter_context(stage.survey())
        for index, spec in enumerate(ready):
            begin, done = time.perf_counter(), 0
            work = chosen(spec, partial(_look, stage, spec))
            while True:
                try:
                    message = next(work)
                except StopIteration as end:
                    self.results.append(FittedProbe(spec.name, None, end.value, time.perf_counter() - begin))
                    break
                except Cancelled:
                    raise
                except PccError as error:
                    self.results.append(FittedProbe(spec.name, str(error)))
                    break
                self.progress = (index + min(done / _STEPS, 1.0)) / len(ready)
                self.message, done = f"{spec.name}: {message}", done + 1
                yield

    def _read(self) -> list[ProbeSpec]:
        """The records of those that can be fitted; faults become results."""
        ready = []
        for probe in self._probes:
            try:
                check_free(probe)
                check_place(probe, self._view_layer)
                ready.append(replace(probe_spec(probe), resolution=_RESOLUTION))
            except PccError as error:
                self.results.append(FittedProbe(probe.name, str(error)))
        return ready


def check_free(probe: bpy.types.Object) -> None:
    """Refuse a probe whose transform is not its own.

    Raises:
        ProbeError: names it and says what to do.
    """
    check_own(probe)
    if probe.library is not None:
        raise ProbeError(f"probe '{probe.name}' is linked from '{probe.library.filepath}'; fit it in that file")
    if is_animated(probe):
        raise ProbeError(
            f"probe '{probe.name}' or a parent of it is animated or constrained, so that a fit would not last; take "
            "the animation or the constraints away, or fit it by hand"
        )


def _look(stage: Stage, spec: ProbeSpec, point: np.ndarray) -> Generator[str, None, Fitted]:
    """The box as a point shows it, within a survey; yields what comes next.

    Raises:
        Cancelled, BakeError: as `Stage.nearness`.
        ProbeError: nothing is seen.
    """
    offset = offset_of(spec.box, point, spec.box.centre)
    here = replace(spec, capture_offset=offset, followed=None, source=Source.BAKE)
    stage.expect([here])
    nearness = yield from faces.survey(stage, here)
    yield "walls"
    return fit_room(spec.name, spec.box, nearness, here.capture_point)


def apply_fit(probe: bpy.types.Object, fit: Fit, view_layer: bpy.types.ViewLayer) -> None:
    """Give a probe the box and the capture point of a fit; its display size stays.

    Raises:
        ProbeError: its transform is not its own, or no transform of its own gives it the box; then it is as before.
    """
    check_free(probe)
    settings = probe.pcc_probe
    basis = probe.matrix_basis.copy()
    matrix = np.array(fit.after.matrix).reshape(4, 4)
    matrix[:3, :3] /= probe.empty_display_size
    probe.matrix_world = Matrix(matrix.tolist())
    if probe.parent is None and probe.rotation_mode not in {"QUATERNION", "AXIS_ANGLE"}:
        probe.rotation_euler = [0.0 if abs(angle) < _NO_TURN else angle for angle in probe.rotation_euler]
    view_layer.update()
    spec = probe_spec(probe)
    off = max(np.abs(spec.box.axes - fit.after.axes).max(), np.linalg.norm(spec.box.centre - fit.after.centre))
    if off > _EXACT * float(fit.after.half_extents.max()) + spec.boundary:
        probe.matrix_basis = basis
        view_layer.update()
        raise ProbeError(
            f"probe '{probe.name}': its parents shear it, so that no box with right angles is left; clear its parent "
            "(Object > Parent > Clear and Keep Transformation) and fit again"
        )
    if not spec.source.stretched:
        origin = fit.after.centre if spec.followed is None else np.array(spec.followed)
        offset = offset_of(fit.after, np.array(fit.point_after), origin)
        settings.capture_offset = [round(length, _DIGITS) + 0.0 for length in offset]  # + 0.0: no "-0"
