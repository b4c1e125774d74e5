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
from ...core.lookup_plan import Receivers
from ...core.plan import Plan, make_plan
from ...core.probe import ProbeSpec
from ...core.probe_plan import ProbePlan
from ...core.sidecar import Sidecar, sidecar_file
from ...version import ADDON_VERSION
from .. import handlers
from ..overrides import override
from ..probes import ensure_uid
from ..read.fingerprint import SceneFingerprint
from ..read.frames import at_frame, frames_of
from ..read.holders import Holders
from ..read.probes import check_own, check_place, probe_spec
from ..read.scene import missing_textures, read_scene
from ..shade import by_hand, injection, twin
from ..shade.captured import seen_matt
from ..shade.probe_group import UNKNOWN_RECEIVERS
from ..shade.twin_order import TwinOrder
from ..stepping import SteppedJob
from ..store import levels
from ..store.pictures import desk
from . import environment, faces
from .capture import Stage
from .completing import Hashes, capture_of, completed
from .faces import Capture
from .going_on import Going, GoingOn
from .sequence import Sequences, Told
from .showing import files_of, show


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
        sidecar: the path of its record; empty where that is in the file alone.
        receivers, shares: what was planned of the surfaces that show it, as `ProbePlan` has it.
        content_hash: of what it shows; of a sequence, its first picture.
        whole: whether this is a bake, and not faces alone that somebody else makes a bake of.
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
    sidecar: str = ""
    receivers: Receivers = UNKNOWN_RECEIVERS
    shares: bool = False
    content_hash: str = ""
    whole: bool = True

    def __str__(self) -> str:
        frames = f" at frames {self.frames}: {self.rendered} of {self.pictures} pictures" if self.frames else ""
        faces = f", {len(self.faces)} of 6 faces," if self.faces != FACE_NAMES else ""
        if not self.faces:
            return f"'{self.probe}'{frames}, which was there already, {self.seconds:.1f} s of work"
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
        whole: whether a bake is made of the faces here, and not by somebody else.
    """

    probe: bpy.types.Object
    capture: Capture
    completes: Sidecar | None
    seen: Hashes
    plan: ProbePlan
    failed: bool = False
    whole: bool = True

    @property
    def cost(self) -> float:
        """How long its bake takes, beside others."""
        return faces.cost(self.capture, self.roughnesses)

    @property
    def pieces(self) -> int:
        """Into how many its bake may be divided: its faces, if they are rendered one by one."""
        return 1 if self.capture.spec.source.stretched else max(len(self.capture.names), 1)

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
        probe: the name of the one that is worked on; empty: none alone.
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
        going: Going | None = None,
        most_seconds: float = 0.0,
    ) -> None:
        """A bake that has not begun.

        Args:
            target, view_layer: what is rendered.
            probes: those to bake.
            folder: where pictures go; None packs them.
            frames: those that each probe has a picture for; `STILL` for one of the current frame; None: as last baked.
            reuse: whether pictures of sequences, and faces, that are there already are kept where nothing has changed.
            going: what it takes over that lies in the folder, and what it leaves to others; faces are kept there until
                their probes are whole. None: nothing.
            most_seconds: for a render by Cycles, after which it is not worth keeping, and who asks will stop; 0: any.
        """
        super().__init__()
        self.results: list[BakedProbe] = []
        self.probe = ""
        self._scene, self._view_layer, self._probes, self._folder = target, view_layer, list(probes), folder
        self.missing_textures: list[str] = []
        self._frames, self._reuse, self._most_seconds = frames, reuse, most_seconds
        self._going = GoingOn(going, folder) if going and folder else None

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
        tasks.sort(key=lambda task: (-task.cost, task.name))
        tasks, moving = self._left_to_do(tasks, moving)
        sequences = Sequences(
            self._stack, self._scene, self._view_layer, self._folder, self._reuse, self._holders, self._going
        )
        if moving:
            self._stack.enter_context(at_frame(self._scene))
            yield from self._told(sequences.read(moving), 0.0, 0.1)
            self._tell(sequences)
        if not tasks and not sequences.films and not moving:
            return
        stage = Stage(
            self._stack,
            self._scene,
            self._view_layer,
            [task.capture.spec for task in tasks],
            sequences.at_once,
            {task.name: task.capture.missing for task in tasks},
            self._most_seconds,
        )
        _show_diffuse_only(self._stack, plan)
        total = sum(faces.work(task.capture, task.roughnesses) for task in tasks)
        share = (0.1 if moving else 0.0, 0.1 + 0.9 * total / max(total + sequences.work, 1.0) if moving else 1.0)
        yield from self._told(self._bake_stills(stage, tasks, total), *share)
        if moving:
            yield from self._told(sequences.bake(stage, self._show), share[1], 1.0)
            self._tell(sequences)

    def _task(self, probe: bpy.types.Object, spec: ProbeSpec, plan: Plan, fingerprint: SceneFingerprint) -> _Task:
        probe_plan = plan.probe(spec.name)
        seen = Hashes(fingerprint.content_hash(spec), fingerprint.face_hashes(spec))
        capture, completes = capture_of(probe, spec, probe_plan, seen, self._reuse)
        return _Task(probe, capture, completes, seen, probe_plan)

    def _left_to_do(
        self, tasks: list[_Task], moving: Sequence[tuple[bpy.types.Object, tuple[int, ...], ProbePlan]]
    ) -> tuple[list[_Task], list[tuple[bpy.types.Object, tuple[int, ...], ProbePlan]]]:
        """What is neither there already nor somebody else's, of stills and of what `Sequences.read` takes."""
        going, films = self._going, list(moving)
        if going is None:
            return tasks, films
        costs = [*(task.cost for task in tasks), *(self._cost_of_film(*film) for film in films)]
        parts = going.dealt(costs, [*(task.pieces for task in tasks), *(1 for _ in films)])
        found, there = [], []
        with desk():
            for task, part in zip(tasks, parts, strict=False):
                if not len(part):
                    continue
                task.capture.kept = going.faces_of(task.probe, self._holders, task.seen.content)
                if len(part) < task.pieces:
                    task.capture.names, task.whole = tuple(task.capture.names[k] for k in part), False
                if self._recovered(task, going):
                    there.append(task.probe)
                else:
                    found.append(task)
        going.forget(there)
        films = [film for film, part in zip(films, parts[len(tasks) :], strict=True) if len(part)]
        for probe, _, _ in films:
            going.recover_sequence(probe, self._holders)
        return found, films

    def _cost_of_film(self, probe: bpy.types.Object, frames: tuple[int, ...], plan: ProbePlan) -> float:
        return len(frames) * faces.cost(Capture(probe_spec(probe)), plan.roughnesses)

    def _recovered(self, task: _Task, going: GoingOn) -> bool:
        """Whether a probe has its bake from the folder."""
        record = going.recovered(task.probe, task.capture.spec, self._holders, task.seen.content, task.plan.faces)
        if record is None:
            return False
        try:
            self._show(task.probe, task.plan)
        except PccError:  # what lies there cannot be shown, so it is baked
            return False
        self._tell_bake(task, record, (), ())
        return True

    def _asked(self, probe: bpy.types.Object) -> tuple[int, ...]:
        """The frames that a probe is to have pictures for; none for a still of the current one."""
        if isinstance(self._frames, FrameRange):
            return tuple(self._frames.frames)
        return () if self._frames == STILL else frames_of(probe)

    def _told(self, work: Iterator[Told], low: float, high: float) -> Iterator[None]:
        """Do some work that is the part of all work between two shares of it."""
        for fraction, self.probe, self.message in work:
            self.progress = low + (high - low) * min(fraction, 1.0)
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
                    files_of(film.probe),
                    tuple(film.replaced),
                    tuple(film.warnings),
                    film.said_frames,
                    film.pictures,
                    film.rendered,
                    sidecar=self._sidecar(film.probe),
                    receivers=film.plan.receivers,
                    shares=film.plan.shares,
                    content_hash=film.content_hash,
                )
            )

    def _bake_stills(self, stage: Stage, tasks: Sequence[_Task], total: float) -> Iterator[Told]:
        """Pictures of the current frame; yields how much of this is done and what comes next."""
        done, waiting, begin = 0.0, [], time.perf_counter()
        for task in tasks:
            for message in self._tried(task, faces.render(stage, task.capture)):
                done += faces.weight(task.capture)
                yield done / total, task.name, message
            if task.whole:
                waiting.append(task)
            elif not task.failed:
                self._tell_faces(task)
            held = sum(task.capture.bytes_held for task in waiting)
            if task is not tasks[-1] and held < _HELD_BYTES and time.perf_counter() - begin < _HELD_SECONDS:
                continue
            for name, message in self._survey(stage, waiting):
                done += 1
                yield done / total, name, message
            for held_task in waiting:
                for message in self._tried(held_task, self._store(held_task)):
                    done += 1
                    yield done / total, held_task.name, message
            if self._going:
                self._going.forget(held_task.probe for held_task in waiting if not held_task.failed)
            waiting, begin = [], time.perf_counter()

    def _survey(self, stage: Stage, tasks: Sequence[_Task]) -> Iterator[tuple[str, str]]:
        """Capture how near things are for those that want it; yields for which, and what comes next."""
        wanting = [task for task in tasks if task.capture.spec.captures_distance and not task.failed]
        if wanting:
            with stage.survey():
                for task in wanting:
                    for message in self._tried(task, faces.render_nearness(stage, task.capture)):
                        yield task.name, message

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
            told = str(error) if f"'{task.name}'" in str(error) else f"probe '{task.name}': {error}"
            self.results.append(BakedProbe(task.name, told))
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
            ensure_uid(probe, self._holders, self._folder),
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
        levels.store(probe, record, pictures, self._folder, self._holders, durable=self._going is not None)
        self._show(probe, task.plan)
        self._tell_bake(task, record, warnings, capture.names)
        capture.forget()

    def _tell_bake(self, task: _Task, record: Sidecar, warnings: Sequence[str], new: tuple[str, ...]) -> None:
        """A probe has a bake, of which some faces are new."""
        self.results.append(
            BakedProbe(
                task.name,
                None,
                record.seconds if not new else task.capture.seconds,
                files_of(task.probe),
                record.replaced_pixels if not new else tuple(task.capture.replaced),
                tuple(warnings),
                faces=new,
                sidecar=self._sidecar(task.probe),
                receivers=task.plan.receivers,
                shares=task.plan.shares,
                content_hash=record.content_hash,
            )
        )

    def _tell_faces(self, task: _Task) -> None:
        """The faces of a share are kept, for whoever makes a bake of all."""
        names, seconds = task.capture.names, task.capture.seconds
        self.results.append(
            BakedProbe(task.name, None, seconds, faces=names, content_hash=task.seen.content, whole=False)
        )
        task.capture.forget()

    def _show(self, probe: bpy.types.Object, plan: ProbePlan) -> None:
        show(probe, plan.receivers, plan.shares)

    def _sidecar(self, probe: bpy.types.Object) -> str:
        return "" if self._folder is None else str(self._folder / sidecar_file(probe.name, probe.pcc_probe.uid))


def _show_diffuse_only(stack: ExitStack, plan: Plan) -> None:
    """Switch off injected reflections, and the specular lobes of materials that will show a probe.

    What a lobe sends to the capture point depends on where one stands, so it is no part of the picture; metals are seen
    matt in half their colour. Diffuse surfaces get the light of the lobes as ever.
    """
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
