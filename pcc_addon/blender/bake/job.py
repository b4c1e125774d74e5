"""The bake as one object: the operator and the shell both drive it, a step at a time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path

import bpy
import numpy as np

from ...core import equirect, radiance
from ...core.cubemap import FACES
from ...core.errors import Cancelled, PccError
from ...core.pictures import LADDER
from ...core.plan import Plan, ProbePlan, make_plan
from ...core.prefilter import prefilter
from ...core.probe import Engine, ProbeSpec
from ...core.sidecar import Sidecar
from ...version import ADDON_VERSION
from .. import handlers
from ..overrides import override
from ..probes import ensure_uid
from ..read.fingerprint import SceneFingerprint
from ..read.probes import check_own, check_place, probe_spec
from ..read.scene import missing_textures, read_scene
from ..shade import by_hand, groups, injection, interior, twin
from ..shade.probe_group import refresh_group
from ..shade.twin_order import TwinOrder
from ..store import levels
from . import environment
from .capture import OVERSCAN, Stage
from .surroundings import black_capture, is_nearly_black


@dataclass(frozen=True)
class BakedProbe:
    """What became of one probe.

    Attributes:
        probe: its name.
        error: why it has no new bake, or None.
        seconds: of rendering and assembling.
        files: the pictures' paths; empty where they are packed.
        replaced_pixels: what was wrong in the capture, in words.
        warnings: what the user should know of it, in words.
    """

    probe: str
    error: str | None = None
    seconds: float = 0.0
    files: tuple[str, ...] = ()
    replaced_pixels: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Task:
    """One probe to bake: its object and record, the hash of what it depends on, what the plan says of it."""

    probe: bpy.types.Object
    spec: ProbeSpec
    content_hash: str
    plan: ProbePlan

    @property
    def roughnesses(self) -> tuple[float, ...]:
        return tuple(LADDER[key.level] for key in self.plan.pictures)

    @property
    def steps(self) -> int:
        """Six faces or a picture from elsewhere, assembling, each level but the sharpest, storing."""
        return environment.steps(self.spec.source) + 1 + len(self.roughnesses)


@dataclass
class _Capture:
    """The faces of one probe that wait to be stored, what was wrong in them, and the seconds spent on it.

    A picture that was not captured in the box stands for the faces.
    """

    task: _Task
    faces: list[np.ndarray] = field(default_factory=list)
    picture: np.ndarray | None = None
    replaced: list[str] = field(default_factory=list)
    seconds: float = 0.0
    failed: bool = False

    @property
    def bytes_held(self) -> int:
        return sum(face.nbytes for face in self.faces) + (0 if self.picture is None else self.picture.nbytes)


# Storing a bake makes data blocks, after which a renderer reads the whole scene anew: that grows with the scene. So
# captures are stored together, but early enough that a cancelled bake loses little and memory stays small.
_HELD_BYTES, _HELD_SECONDS = 2**28, 20.0


class BakeJob:
    """Bakes probes of a scene. Call `step` until it returns False, or `cancel`; the scene is changed in between.

    Attributes:
        progress: 0 … 1.
        message: what is being done.
        results: one for each probe that is finished or failed.
        missing_textures: a sentence for each image file that is not there; what it covers is captured in pink.
    """

    def __init__(
        self,
        target: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        probes: Sequence[bpy.types.Object],
        folder: Path | None,
    ) -> None:
        self.progress = 0.0
        self.message = "Preparing"
        self.results: list[BakedProbe] = []
        self._scene, self._view_layer, self._probes, self._folder = target, view_layer, list(probes), folder
        self.missing_textures: list[str] = []
        self._stack = ExitStack()
        self._work = self._run()

    def step(self) -> bool:
        """Do the next piece of work; False once all is done and the scene is restored.

        Raises:
            BakeError: the folder cannot be written.
        Cancelled: the user stopped a render.
        Exception: whatever else went wrong. In every case the scene is restored first.
        """
        try:
            next(self._work)
        except StopIteration:
            self._stack.close()
            injection.mend(self._scene, self._view_layer)
            self.progress, self.message = 1.0, "Done"
            return False
        except BaseException:
            self._stack.close()
            raise
        return True

    def cancel(self) -> None:
        """Stop and restore the scene; probes already finished keep their new bakes, the others their old ones."""
        self._work.close()
        self._stack.close()
        self.message = "Cancelled"

    def run(self) -> list[BakedProbe]:
        """All steps at once."""
        while self.step():
            pass
        return self.results

    def _run(self) -> Iterator[None]:
        self._view_layer.update()
        ready = self._read_probes()
        if not ready:
            return
        levels.check_folder(self._folder)
        self.missing_textures = missing_textures(self._view_layer, self._scene.world)
        plan = make_plan(read_scene(self._scene, self._view_layer))
        fingerprint = SceneFingerprint(self._scene, self._view_layer)
        tasks = [
            _Task(
                probe,
                spec,
                fingerprint.content_hash(spec),
                plan.probe(spec.name),
            )
            for probe, spec in ready
        ]
        total = sum(task.steps for task in tasks)
        yield
        # Once all is as it was: what a bake changes in its probes' groups may call for other twins.
        self._stack.callback(handlers.bring_all_up_to_date, self._scene)
        self._stack.enter_context(handlers.paused())
        stage = Stage(self._stack, self._scene, self._view_layer, [task.spec for task in tasks])
        _show_diffuse_only(self._stack, plan)
        done, waiting, begin = 0, [], time.perf_counter()
        for task in tasks:
            waiting.append(_Capture(task))
            for message in self._tried(waiting[-1], self._render(stage, waiting[-1])):
                done += 1
                self.progress, self.message = done / total, message
                yield
            held = sum(capture.bytes_held for capture in waiting)
            if task is not tasks[-1] and held < _HELD_BYTES and time.perf_counter() - begin < _HELD_SECONDS:
                continue
            for capture in waiting:
                for message in self._tried(capture, self._store(capture)):
                    done += 1
                    self.progress, self.message = done / total, message
                    yield
            waiting, begin = [], time.perf_counter()

    def _tried(self, capture: _Capture, work: Iterator[str]) -> Iterator[str]:
        """What a piece of work on a probe does; an error that is expected becomes the probe's result."""
        if capture.failed:
            return
        begin = time.perf_counter()
        try:
            for message in work:
                capture.seconds += time.perf_counter() - begin
                yield f"{capture.task.spec.name}: {message}"
                begin = time.perf_counter()
        except Cancelled:
            raise
        except PccError as error:
            capture.failed = True
            capture.faces.clear()
            self.results.append(BakedProbe(capture.task.spec.name, str(error)))
        capture.seconds += time.perf_counter() - begin

    def _read_probes(self) -> list[tuple[bpy.types.Object, ProbeSpec]]:
        """The sound ones among the probes to bake, with their records; faults become results."""
        ready = []
        for probe in self._probes:
            try:
                check_own(probe)
                check_place(probe, self._view_layer)
                spec = probe_spec(probe)
                environment.check_source(spec, self._scene)
                ready.append((probe, spec))
            except PccError as error:
                self.results.append(BakedProbe(probe.name, str(error)))
        return ready

    def _render(self, stage: Stage, capture: _Capture) -> Iterator[str]:
        """Render the faces of one probe, or take its picture from elsewhere; yields what comes next."""
        spec = capture.task.spec
        if spec.source.stretched:
            taken = yield from environment.take(spec, self._scene)
            capture.picture = taken.picture
            capture.replaced += taken.replaced
            return
        with ExitStack() as stack:
            stage.aim(stack, spec)
            for index, face in enumerate(FACES):
                yield f"face {face.name}"
                picture, bad = radiance.clean(index, stage.face(spec, index), OVERSCAN)
                capture.faces.append(picture)
                if bad is None and spec.engine is Engine.CYCLES and spec.denoise:
                    _, bad = radiance.clean(index, stage.glimpse(spec, index), OVERSCAN)
                    bad = bad and replace(bad, glimpsed=True)
                capture.replaced += [str(bad)] if bad else []
                capture.seconds += stage.owed.pop(spec.name, 0.0)

    def _store(self, capture: _Capture) -> Iterator[str]:
        """Assemble, blur and store the faces of one probe; yields what comes next."""
        task, replaced = capture.task, capture.replaced
        probe, spec = task.probe, task.spec
        yield "assembling"
        given = capture.picture
        pictures = {0.0: equirect.from_faces(capture.faces, OVERSCAN) if given is None else given}
        black = is_nearly_black(pictures[0.0])
        warnings = (black_capture(spec, self._scene, self._view_layer),) if black else ()
        for roughness in task.roughnesses:
            if roughness > 0.0:
                yield f"roughness {roughness:.3g}"
                pictures[roughness] = prefilter(pictures[0.0], roughness)
        yield "storing"
        seconds = capture.seconds
        record = Sidecar.of_bake(
            spec,
            ensure_uid(probe),
            seconds=round(seconds, 3),
            content_hash=task.content_hash,
            blender=bpy.app.version_string,
            addon=ADDON_VERSION,
            replaced_pixels=tuple(replaced),
        )
        levels.store(probe, record, pictures, self._folder)
        refresh_group(probe, task.plan.receivers, task.plan.shares)
        interior.follow_bake(probe)
        by_hand.refresh(probe)
        images = [level.image for level in probe.pcc_probe.levels]
        files = tuple(bpy.path.abspath(image.filepath) for image in images if not image.packed_file)
        self.results.append(BakedProbe(spec.name, None, seconds, files, tuple(replaced), warnings))
        capture.faces.clear()
        capture.picture = None


def _show_diffuse_only(stack: ExitStack, plan: Plan) -> None:
    """Switch off injected reflections, and the specular lobes of materials that will show a probe.

    What a lobe sends to the capture point depends on where one stands, so it is no part of the picture.
    """
    stack.callback(groups.drop_unused_groups)
    by_hand.hide(stack)
    for material in bpy.data.materials:
        for node in twin.reflection_nodes(material):
            override(stack, node, "mute", True)
    materials = {material.name_full: material for material in bpy.data.materials}
    for material_plan in plan.materials:
        material = materials[material_plan.material]
        dimmed = {path: plan for path, plan in material_plan.served.items() if not plan.captured_whole}
        if material_plan.probes and dimmed and not twin.has_twins(material):
            stack.callback(twin.remove_twins, material)
            twin.add_twins(material, TwinOrder((), dimmed, material_plan.emits))
