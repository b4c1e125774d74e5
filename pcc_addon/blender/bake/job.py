"""The bake as one object: the operator and the shell both drive it, a step at a time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.cubemap import FACE_NAMES
from ...core.errors import Cancelled, PccError
from ...core.frames import STILL, FrameRange
from ...core.plan import Plan, make_plan
from ...core.probe import ProbeSpec
from ...core.probe_plan import ProbePlan
from ...core.sidecar import Sidecar
from ...version import ADDON_VERSION
from .. import handlers
from ..overrides import override
from ..probes import ensure_uid
from ..read.fingerprint import SceneFingerprint
from ..read.frames import at_frame, frames_of
from ..read.holders import Holders
from ..read.probes import check_own, check_place, probe_spec
from ..read.scene import missing_textures, read_scene
from ..shade import by_hand, groups, injection, interior, twin
from ..shade.captured import seen_matt
from ..shade.probe_group import refresh_group
from ..shade.twin_order import TwinOrder
from ..stepping import SteppedJob
from ..store import levels
from . import environment, faces
from .capture import Stage
from .completing import Hashes, capture_of, completed
from .faces import Capture
from .sequence import Sequences


@dataclass(frozen=True)
class BakedProbe:
    """What became of one probe.

    Attributes:
        probe: its name.
        error: why it has no new bake, or None.
        seconds: of rendering and assembling.
        files: the pictures' paths, of a sequence the first of each level; empty where they are packed.
        replaced_pixels: what was wrong in the capture, in words.
        warnings: what the user should know of it, in words.
        frames: of a sequence, in words; empty for a still.
        pictures, rendered: how many different ones the frames show, and how many of these are new.
        faces: those that are new, by name; of a sequence, of each new picture.
    """

    probe: str
    error: str | None = None
    seconds: float = 0.0
    files: tuple[str, ...] = ()
    replaced_pixels: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    frames: str = ""
    pictures: int = 1
    rendered: int = 1
    faces: tuple[str, ...] = FACE_NAMES

    def __str__(self) -> str:
        frames = f" at frames {self.frames}: {self.rendered} of {self.pictures} pictures" if self.frames else ""
        faces = f", {len(self.faces)} of 6 faces," if self.faces != FACE_NAMES else ""
        return f"'{self.probe}'{frames}{faces} in {self.seconds:.1f} s"


@dataclass
class _Task:
    """One probe to bake.

    Attributes:
        probe: its object.
        capture: of it.
        completes: the record of the bake that the capture completes; None: it is a new one.
        seen: what it depends on.
        plan: what the plan says of it.
        failed: whether it has no new bake.
    """

    probe: bpy.types.Object
    capture: Capture
    completes: Sidecar | None
    seen: Hashes
    plan: ProbePlan
    failed: bool = False

    @property
    def name(self) -> str:
        return self.capture.spec.name

    @property
    def roughnesses(self) -> tuple[float, ...]:
        return self.plan.roughnesses


# Storing a bake makes data blocks, after which a renderer reads the whole scene anew: that grows with the scene. So
# captures are stored together, but early enough that a cancelled bake loses little and memory stays small.
_HELD_BYTES, _HELD_SECONDS = 2**28, 20.0


class BakeJob(SteppedJob):
    """Bakes probes of a scene. Probes that are finished when it is stopped keep their new bakes, the others their old.

    Attributes:
        results: one for each probe that is finished or failed.
        missing_textures: a sentence for each image file that is not there; what it covers is captured in pink.
    """

    def __init__(
        self,
        target: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        probes: Sequence[bpy.types.Object],
        folder: Path | None,
        frames: FrameRange | str | None = None,
        reuse: bool = False,
    ) -> None:
        """A bake that has not begun.

        Args:
            target, view_layer: what is rendered.
            probes: those to bake.
            folder: where pictures go; None packs them.
            frames: those that each probe has a picture for; `STILL` for one of the current frame; None: as last baked.
            reuse: whether pictures of sequences, and faces, that are there already are kept where nothing has changed.
        """
        super().__init__()
        self.results: list[BakedProbe] = []
        self._scene, self._view_layer, self._probes, self._folder = target, view_layer, list(probes), folder
        self.missing_textures: list[str] = []
        self._frames, self._reuse = frames, reuse

    def _ended(self) -> None:
        injection.mend(self._scene, self._view_layer)

    def run(self) -> list[BakedProbe]:
        """All steps at once."""
        self.finish()
        return self.results

    def _run(self) -> Iterator[None]:
        self._view_layer.update()
        ready = self._read_probes()
        if not ready:
            return
        levels.check_folder(self._folder)
        self.missing_textures = missing_textures(self._view_layer, self._scene.world)
        plan = make_plan(read_scene(self._scene, self._view_layer))
        asked = {spec.name: self._asked(probe) for probe, spec in ready}
        fingerprint = SceneFingerprint(self._scene, self._view_layer, seen_matt(plan))
        tasks = [self._task(probe, spec, plan, fingerprint) for probe, spec in ready if not asked[spec.name]]
        moving = [(probe, asked[spec.name], plan.probe(spec.name)) for probe, spec in ready if asked[spec.name]]
        yield
        # Once all is as it was: what a bake changes in its probes' groups may call for other twins.
        self._stack.callback(handlers.bring_all_up_to_date, self._scene)
        self._stack.enter_context(handlers.paused())
        self._holders = Holders()
        sequences = Sequences(self._stack, self._scene, self._view_layer, self._folder, self._reuse, self._holders)
        if moving:
            self._stack.enter_context(at_frame(self._scene))
            yield from self._told(sequences.read(moving), 0.0, 0.1)
            self._tell(sequences)
        stage = Stage(
            self._stack,
            self._scene,
            self._view_layer,
            [task.capture.spec for task in tasks],
            sequences.at_once,
            {task.name: task.capture.names for task in tasks},
        )
        _show_diffuse_only(self._stack, plan)
        total = sum(faces.steps(task.capture, task.roughnesses) for task in tasks)
        share = (0.1 if moving else 0.0, 0.1 + 0.9 * total / max(total + sequences.steps, 1) if moving else 1.0)
        yield from self._told(self._bake_stills(stage, tasks, total), *share)
        if moving:
            yield from self._told(sequences.bake(stage, self._show), share[1], 1.0)
            self._tell(sequences)

    def _task(self, probe: bpy.types.Object, spec: ProbeSpec, plan: Plan, fingerprint: SceneFingerprint) -> _Task:
        probe_plan = plan.probe(spec.name)
        seen = Hashes(fingerprint.content_hash(spec), fingerprint.face_hashes(spec))
        capture, completes = capture_of(probe, spec, probe_plan, seen, self._reuse)
        return _Task(probe, capture, completes, seen, probe_plan)

    def _asked(self, probe: bpy.types.Object) -> tuple[int, ...]:
        """The frames that a probe is to have pictures for; none for a still of the current one."""
        if isinstance(self._frames, FrameRange):
            return tuple(self._frames.frames)
        return () if self._frames == STILL else frames_of(probe)

    def _told(self, work: Iterator[tuple[float, str]], low: float, high: float) -> Iterator[None]:
        """Do some work that is the part of all work between two shares of it."""
        for fraction, message in work:
            self.progress, self.message = low + (high - low) * min(fraction, 1.0), message
            yield

    def _tell(self, sequences: Sequences) -> None:
        """Take over what became of sequences."""
        for film in sequences.take_finished():
            if film.error is not None:
                self.results.append(BakedProbe(film.name, film.error))
                continue
            self.results.append(
                BakedProbe(
                    film.name,
                    None,
                    film.seconds,
                    self._files(film.probe),
                    tuple(film.replaced),
                    tuple(film.warnings),
                    film.said_frames,
                    film.pictures,
                    film.rendered,
                )
            )

    def _bake_stills(self, stage: Stage, tasks: Sequence[_Task], total: int) -> Iterator[tuple[float, str]]:
        """Pictures of the current frame; yields how much of this is done and what comes next."""
        done, waiting, begin = 0, [], time.perf_counter()
        for task in tasks:
            waiting.append(task)
            for message in self._tried(task, faces.render(stage, task.capture)):
                done += 1
                yield done / total, message
            held = sum(task.capture.bytes_held for task in waiting)
            if task is not tasks[-1] and held < _HELD_BYTES and time.perf_counter() - begin < _HELD_SECONDS:
                continue
            for message in self._survey(stage, waiting):
                done += 1
                yield done / total, message
            for held_task in waiting:
                for message in self._tried(held_task, self._store(held_task)):
                    done += 1
                    yield done / total, message
            waiting, begin = [], time.perf_counter()

    def _survey(self, stage: Stage, tasks: Sequence[_Task]) -> Iterator[str]:
        """Capture how near things are for those that want it; yields what comes next."""
        wanting = [task for task in tasks if task.capture.spec.captures_distance and not task.failed]
        if wanting:
            with stage.survey():
                for task in wanting:
                    yield from self._tried(task, faces.render_nearness(stage, task.capture))

    def _tried(self, task: _Task, work: Iterator[str]) -> Iterator[str]:
        """What a piece of work on a probe does; an error that is expected becomes the probe's result."""
        if task.failed:
            return
        begin = time.perf_counter()
        try:
            for message in work:
                task.capture.seconds += time.perf_counter() - begin
                yield f"{task.name}: {message}"
                begin = time.perf_counter()
        except Cancelled:
            raise
        except PccError as error:
            task.failed = True
            task.capture.forget()
            self.results.append(BakedProbe(task.name, str(error)))
        task.capture.seconds += time.perf_counter() - begin

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

    def _store(self, task: _Task) -> Iterator[str]:
        """Assemble, blur and store the faces of one probe; yields what comes next."""
        capture, probe, spec = task.capture, task.probe, task.capture.spec
        pictures = yield from faces.levels_of(capture, task.roughnesses)
        warnings = faces.warnings_of(pictures[0.0], spec, self._scene, self._view_layer)
        yield "storing"
        seconds = capture.seconds
        record = Sidecar.of_bake(
            spec,
            ensure_uid(probe, self._holders),
            seconds=round(seconds, 3),
            content_hash=task.seen.content,
            blender=bpy.app.version_string,
            addon=ADDON_VERSION,
            replaced_pixels=tuple(capture.replaced),
            faces=capture.names,
            face_hashes=task.seen.faces,
            departure=faces.departure(capture),
        )
        record = completed(record, task.completes)
        levels.store(probe, record, pictures, self._folder, self._holders)
        self._show(probe, task.plan)
        files = self._files(probe)
        replaced, captured = tuple(capture.replaced), capture.names
        self.results.append(BakedProbe(spec.name, None, seconds, files, replaced, tuple(warnings), faces=captured))
        capture.forget()

    def _show(self, probe: bpy.types.Object, plan: ProbePlan) -> None:
        """Let everything that shows a probe show its new bake."""
        refresh_group(probe, plan.receivers, plan.shares or None)  # twins may choose until the next injection
        interior.follow_bake(probe)
        by_hand.refresh(probe)

    def _files(self, probe: bpy.types.Object) -> tuple[str, ...]:
        images = [level.image for level in probe.pcc_probe.levels]
        return tuple(bpy.path.abspath(image.filepath) for image in images if not image.packed_file)


def _show_diffuse_only(stack: ExitStack, plan: Plan) -> None:
    """Switch off injected reflections, and the specular lobes of materials that will show a probe.

    What a lobe sends to the capture point depends on where one stands, so it is no part of the picture; metals are seen
    matt in half their colour. Diffuse surfaces get the light of the lobes as ever.
    """
    stack.callback(groups.drop_unused_groups)
    by_hand.hide(stack)
    for material in bpy.data.materials:
        for node in twin.reflection_nodes(material):
            override(stack, node, "mute", True)
        for socket in twin.capture_inputs(material):
            override(stack, socket, "default_value", 1.0)
    materials = {material.name_full: material for material in bpy.data.materials}
    for material_plan in plan.materials:
        material = materials[material_plan.material]
        dimmed = {path: plan for path, plan in material_plan.served.items() if not plan.captured_whole}
        if material_plan.probes and dimmed and not twin.has_twins(material):
            stack.callback(twin.remove_twins, material)
            twin.add_twins(material, TwinOrder((), dimmed, material_plan.emits))
