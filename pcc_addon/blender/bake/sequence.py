"""Animated probes: what each sees at each frame is read first, then only pictures that nobody has are rendered."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path

import bpy

from ...core.errors import Cancelled, PccError
from ...core.frames import spans
from ...core.kept_faces import NOWHERE, KeptProbe
from ...core.probe import ProbeSpec
from ...core.probe_plan import ProbePlan
from ...core.sequence import SequencePlan, plan_sequence
from ...core.sidecar import Sidecar
from ...version import ADDON_VERSION
from ..probes import ensure_uid
from ..read.fingerprint import SceneFingerprint
from ..read.frames import visit
from ..read.holders import Holders
from ..read.probes import bake_record, check_place, check_seen, probe_spec
from ..store.pictures import pictures_folder
from ..store.sequences import Reel, Shown, check_packing, known_pictures
from . import environment, faces
from .capture import Stage
from .faces import Capture
from .going_on import GoingOn

Show = Callable[[bpy.types.Object, ProbePlan], None]
Told = tuple[float, str, str]
"""How much of some work is done, for which probe comes what is next (empty: for several), and what."""


@dataclass
class Film:
    """A probe over the frames of a scene.

    Attributes:
        probe: its object.
        frames: those that it is to have pictures for, ascending.
        plan: what the plan says of it.
        error: why it has no new bake, or None.
        seconds: of rendering and assembling.
        replaced: what was wrong in its captures, in words.
        warnings: what the user should know of it, in words.
    """

    probe: bpy.types.Object
    frames: tuple[int, ...]
    plan: ProbePlan
    error: str | None = None
    seconds: float = 0.0
    replaced: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    _specs: list[ProbeSpec] = field(default_factory=list, init=False)
    _hashes: list[str] = field(default_factory=list, init=False)
    _known: dict[str, Shown] = field(default_factory=dict, init=False)
    _before: Path | None = field(default=None, init=False)
    _needs: SequencePlan | None = field(default=None, init=False)
    _reel: Reel | None = field(default=None, init=False)

    @property
    def name(self) -> str:
        return self.probe.name

    @property
    def roughnesses(self) -> tuple[float, ...]:
        return self.plan.roughnesses

    @property
    def said_frames(self) -> str:
        """Its frames in words."""
        return spans(self.frames)

    @property
    def pictures(self) -> int:
        """How many different ones its frames show."""
        return len(self._needs.hashes) if self._needs else 0

    @property
    def rendered(self) -> int:
        """How many of them are new."""
        return len(self._needs.missing) if self._needs else 0

    @property
    def work(self) -> float:
        """As `faces.work`, of all pictures."""
        return faces.work(Capture(self._specs[0]), self.roughnesses) * self.rendered if self._specs else 0.0

    def look(self, view_layer: bpy.types.ViewLayer, scene: bpy.types.Scene, fingerprint: SceneFingerprint) -> None:
        """Note what the probe sees at the frame where the scene is.

        Raises:
            PccError: it cannot be baked there.
        """
        check_place(self.probe, view_layer)
        check_seen(self.probe, view_layer)
        spec = probe_spec(self.probe)
        environment.check_source(spec, scene)
        self._specs.append(spec)
        self._hashes.append(fingerprint.content_hash(spec))

    @property
    def content_hash(self) -> str:
        """Of what its first picture shows."""
        return self._hashes[0]

    def decide(self, stack: ExitStack, folder: Path | None, reuse: bool) -> None:
        """Find out which pictures are missing, and make a place for them.

        Raises:
            PccError: they cannot be stored.
        """
        place = check_packing(self.name, folder)
        record = bake_record(self.probe) if reuse else None
        self._before = pictures_folder(self.probe) or place
        self._known = known_pictures(self.probe, record, self._before, self.roughnesses)
        points = [_point(spec) for spec in self._specs]
        self._needs = plan_sequence(self.frames, self._hashes, points, self._known)
        self._reel = Reel(stack, self.probe, place, self.roughnesses)

    def missing(self) -> Iterator[tuple[int, int]]:
        """Frames to render at, and the numbers of the pictures."""
        yield from ((self._needs.frames[number], number) for number in self._needs.missing)

    def spec_at(self, frame: int) -> ProbeSpec:
        return self._specs[self.frames.index(frame)]

    def take(
        self, stage: Stage, frame: int, number: int, view_layer: bpy.types.ViewLayer, kept: KeptProbe
    ) -> Iterator[str]:
        """Render a picture at the frame where the scene is; yields what comes next."""
        capture = Capture(self.spec_at(frame), kept=kept)
        yield from faces.render(stage, capture)
        shown = yield from faces.levels_of(capture, self.roughnesses)
        yield "storing"
        black = faces.warnings_of(shown[0.0], capture.spec, stage.scene, view_layer)
        self.warnings += [f"frame {frame}: {line}" for line in black]
        self.replaced += [f"frame {frame}: {line}" for line in capture.replaced]
        self.seconds += capture.seconds  # what its faces took while another probe's were asked for
        self._reel.add(number, shown)

    def hash_at(self, frame: int) -> str:
        return self._hashes[self.frames.index(frame)]

    def store(self, holders: Holders, folder: Path | None) -> None:
        """Let the probe show all its pictures, which are in a folder.

        Raises:
            PccError: they cannot be stored; the old bake stays.
        """
        for number, content_hash in enumerate(self._needs.hashes):
            if number not in self._needs.missing:
                self._reel.reuse(number, self._known[content_hash], self._before)
        record = Sidecar.of_bake(
            self._specs[0],
            ensure_uid(self.probe, holders, folder),
            seconds=round(self.seconds, 3),
            content_hash=self._hashes[0],
            blender=bpy.app.version_string,
            addon=ADDON_VERSION,
            replaced_pixels=tuple(self.replaced),
        )
        self._reel.store(replace(record, moments=self._needs.moments), holders)


class Sequences:
    """The animated probes of a bake.

    Attributes:
        films: those that are not finished.
        at_once: how many probes at most are captured at one frame.
    """

    def __init__(
        self,
        stack: ExitStack,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        folder: Path | None,
        reuse: bool,
        holders: Holders,
        going: GoingOn | None = None,
    ) -> None:
        self._going = going
        self._stack, self._scene, self._view_layer, self._folder, self._reuse = stack, scene, view_layer, folder, reuse
        self._holders = holders
        self.films: list[Film] = []
        self._finished: list[Film] = []
        self.at_once = 0

    @property
    def work(self) -> float:
        """What `bake` does, as `faces.work`."""
        return sum(film.work for film in self.films)

    def take_finished(self) -> list[Film]:
        """Those that have a new bake, or never will, since this was last asked."""
        found, self._finished = self._finished, []
        return found

    def read(self, probes: Sequence[tuple[bpy.types.Object, tuple[int, ...], ProbePlan]]) -> Iterator[Told]:
        """Go through all frames and decide what to render; yields how much of that is done and what comes next.

        Afterwards the scene is where it was.
        """
        self.films = [Film(*each) for each in probes]
        at = (self._scene.frame_current, self._scene.frame_subframe)
        frames = sorted({frame for film in self.films for frame in film.frames})
        for film in list(self.films):
            self._attempt(film, check_packing, film.name, self._folder)
        for k, frame in enumerate(frames):
            looking = [film for film in self.films if frame in film.frames]
            if looking:
                yield k / len(frames), "", f"frame {frame}: reading the scene"
                visit(self._scene, self._view_layer, frame)
                fingerprint = SceneFingerprint(self._scene, self._view_layer)
                for film in looking:
                    self._attempt(film, film.look, self._view_layer, self._scene, fingerprint, at=frame)
        visit(self._scene, self._view_layer, *at)
        for film in list(self.films):
            self._attempt(film, film.decide, self._stack, self._folder, self._reuse)
        self.at_once = len(self.films)

    def bake(self, stage: Stage, show: Show) -> Iterator[Told]:
        """Render what is missing, frame by frame, and store it; yields how much is done and what comes next.

        Args:
            stage: made ready.
            show: lets everything that shows a probe show its new bake.
        """
        done, total = 0.0, max(self.work, 1.0)
        at = (self._scene.frame_current, self._scene.frame_subframe)
        missing = sorted((frame, number, k) for k, film in enumerate(self.films) for frame, number in film.missing())
        films = list(self.films)
        for frame in sorted({frame for frame, _, _ in missing}):
            here = [(films[k], number) for at_frame, number, k in missing if at_frame == frame]
            visit(self._scene, self._view_layer, frame)
            stage.expect([film.spec_at(frame) for film, _ in here])
            for film, number in here:
                capture, kept = Capture(film.spec_at(frame)), self._kept(film, frame)
                taken = film.take(stage, frame, number, self._view_layer, kept)
                for k, message in enumerate(self._tried(film, taken, frame)):
                    done += faces.weight(capture) if k < faces.renders(capture) else 1.0
                    yield done / total, film.name, f"frame {frame}, {film.name}: {message}"
        visit(self._scene, self._view_layer, *at)
        for film in list(self.films):
            yield 1.0, film.name, f"{film.name}: storing {film.pictures} pictures"
            self._attempt(film, film.store, self._holders, self._folder)
            self._attempt(film, show, film.probe, film.plan)
            if film.error is None:
                if self._going:
                    self._going.forget([film.probe])
                self.films.remove(film)
                self._finished.append(film)

    def _kept(self, film: Film, frame: int) -> KeptProbe:
        """Where the faces of a frame are kept."""
        if self._going is None:
            return NOWHERE
        return self._going.faces_of(film.probe, self._holders, film.hash_at(frame))

    def _tried(self, film: Film, work: Iterator[str], frame: int) -> Iterator[str]:
        """What a piece of work on a probe does; an error that is expected becomes what is said of it."""
        if film.error is not None:
            return
        begin = time.perf_counter()
        try:
            for message in work:
                film.seconds += time.perf_counter() - begin
                yield message
                begin = time.perf_counter()
        except Cancelled:
            raise
        except PccError as error:
            self._fail(film, error, frame)
        film.seconds += time.perf_counter() - begin

    def _attempt(self, film: Film, work: Callable[..., object], *arguments: object, at: int | None = None) -> None:
        if film.error is not None:
            return
        try:
            work(*arguments)
        except PccError as error:
            self._fail(film, error, at)

    def _fail(self, film: Film, error: PccError, frame: int | None) -> None:
        film.error = str(error) if frame is None else f"{error} (at frame {frame})"
        self.films.remove(film)
        self._finished.append(film)


def _point(spec: ProbeSpec) -> tuple[float, float, float]:
    x, y, z = spec.capture_point
    return float(x), float(y), float(z)
