"""A bake in a second Blender on a snapshot of the file: each probe takes its new bake when that is whole."""

from __future__ import annotations

import signal
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from typing import Any

import bpy

from ...core.errors import Cancelled, PccError
from ...core.frames import FrameRange
from ...core.workplace import workplace
from ..read.frames import frames_of
from ..read.scene import painted_images
from ..second_blender import SecondBlender, snapshot
from ..store.keeping import folder_for_parts
from ..store.levels import bake_folder
from ..store.sequences import check_packing
from .adoption import adopt, probe_of, told_bake
from .job import BakedProbe

_CANCELLED = 130


class BackgroundBake:
    """Bakes probes of the open file as it is now. Call `step` until it returns False, or `cancel`.

    Between two steps anything may happen to the file, but for opening another one: then it must be cancelled. No data
    block is held meanwhile. Probes that have adopted their bakes keep them however the rest ends.

    Attributes:
        progress: 0 … 1.
        message: what is being done.
        results: one for each probe that has its new bake, or never will.
        notes: what the user should know beside that, in words.
        waiting: bakes that are whole and wait to be adopted, oldest first.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        probes: Sequence[bpy.types.Object],
        frames: FrameRange | str | None = None,
        *,
        stale: bool = False,
    ) -> None:
        """Begin.

        Args:
            scene, view_layer: what is rendered.
            probes: those to bake.
            frames: as for `BakeJob`.
            stale: whether only those are baked that need it, and what has not changed is kept.

        Raises:
            PccError: pictures or the copy cannot be written, or no Blender can be started.
        """
        self.progress, self.message = 0.0, "Starting Blender"
        self.results: list[BakedProbe] = []
        self.notes = painted_images()
        self.waiting: list[BakedProbe] = []
        self._scene = scene.session_uid
        self._errors: list[str] = []
        self._at = ""  # the probe that is worked on
        self._clock = _Clock()
        folder = bake_folder(scene)
        for probe in probes if folder is None else ():
            self._check_packing(probe, frames)
        failed = {result.probe for result in self.results}
        self._identities = {probe.name: probe.session_uid for probe in probes if probe.name not in failed}
        self._left = list(self._identities)
        self._asked = [f"--scene={scene.name}", f"--view-layer={view_layer.name}", *(["--stale"] if stale else [])]
        if frames is not None:
            self._asked.append(f"--frames={frames.text if isinstance(frames, FrameRange) else frames}")
        self._blender: SecondBlender | None = None
        with ExitStack() as stack:
            if self._left:
                self._place = workplace(stack)
                self._delivery = folder_for_parts(stack, folder)
                self._copy = snapshot(stack, self._place)
                self._begin()
            self._stack = stack.pop_all()

    @property
    def seconds_left(self) -> float | None:
        """How long the rest may take; None where nobody knows yet."""
        return self._clock.seconds_left

    @property
    def being_baked(self) -> frozenset[int]:
        """The session uids of the probes that are to have new bakes yet."""
        return frozenset(self._identities[name] for name in (*self._left, *(baked.probe for baked in self.waiting)))

    def step(self) -> bool:
        """Take the news; False once all probes have their bakes, or never will.

        Raises:
            PccError: the bake failed as a whole; says why.
            Cancelled: somebody stopped the second Blender.
        """
        if self._blender is None:
            return False
        for event in self._blender.news():
            self._heed(event)
        if self._blender.code is None or self.waiting:
            return True
        if self._goes_on(self._blender.code):
            return True
        self._stack.close()
        self.progress, self.message = 1.0, "Done"
        return False

    def adopt_next(self) -> BakedProbe:
        """Let the probe of the first bake that waits have it; returns what became of it, which is a result too."""
        baked = self.waiting.pop(0)
        probe = probe_of(self._identities[baked.probe])
        if probe is None:
            result = BakedProbe(baked.probe, f"probe '{baked.probe}' was deleted meanwhile, and its new bake with it")
        else:
            scene = self._scene_of(probe)
            try:
                result = adopt(baked, probe, bake_folder(scene), scene.pcc.roughness_limit)
            except PccError as error:
                result = BakedProbe(baked.probe, str(error))
        self.results.append(result)
        return result

    def cancel(self) -> None:
        """Stop at once; what was not adopted is gone."""
        if self._blender is not None:
            self._blender.stop()
        self._stack.close()
        self.message = "Cancelled"

    def _begin(self) -> None:
        """Let a Blender bake the probes that are left."""
        self._at = ""
        self._share = (1.0 - len(self._left) / len(self._identities), 1.0)
        named = [f"--probe={name}" for name in self._left]
        folder = f"--folder={self._delivery}"
        arguments = [folder, *self._asked, *named]
        self._blender = SecondBlender(self._copy, "bake", arguments, self._place, gives_way=True)

    def _heed(self, event: Mapping[str, Any]) -> None:
        match event:
            case {"event": "progress", "progress": fraction, "message": message, "probe": probe}:
                low, high = self._share
                self.progress, self.message, self._at = low + (high - low) * fraction, message, probe
                self._clock.reached(self.progress)
            case {"event": "baking", "probes": probes}:
                self._left = list(probes)
            case {"event": "baked", "probe": probe}:
                self.waiting.append(told_bake(event))
                self._done_with(probe)
            case {"event": "error", "error": error, "probe": probe}:
                self.results.append(BakedProbe(probe, error))
                self._done_with(probe)
            case {"event": "error", "error": error}:
                self._errors.append(error)
            case {"event": "note", "note": note} if "probe" not in event:
                self.notes.append(note)

    def _done_with(self, probe: str) -> None:
        with suppress(ValueError):
            self._left.remove(probe)

    def _goes_on(self, code: int) -> bool:
        """Whether another Blender bakes what one left that has ended; the probe that it was at is left out.

        Raises:
            PccError: as `step`.
        """
        if code == _CANCELLED:
            raise self._failed(
                Cancelled("the second Blender was stopped; probes that were not finished keep their bakes")
            )
        if code == 0 or not self._left:
            self.notes += self._errors  # of textures that are missing
            return False
        why = "; ".join(self._errors) or _in_words(code, self._blender.last_words)
        self._errors.clear()
        if self._at not in self._left:
            raise self._failed(PccError(why))
        self.results.append(BakedProbe(self._at, f"probe '{self._at}': {why}. It keeps the bake that it had"))
        self._left.remove(self._at)
        if self._left:
            self._begin()
        return bool(self._left)

    def _failed(self, error: PccError) -> PccError:
        self._stack.close()
        return error

    def _check_packing(self, probe: bpy.types.Object, frames: FrameRange | str | None) -> None:
        if isinstance(frames, FrameRange) or (frames is None and frames_of(probe)):
            try:
                check_packing(probe.name, None)
            except PccError as error:
                self.results.append(BakedProbe(probe.name, str(error)))

    def _scene_of(self, probe: bpy.types.Object) -> bpy.types.Scene:
        """The scene that was baked, or one that the probe is in now."""
        scenes = probe.users_scene
        return next((scene for scene in scenes if scene.session_uid == self._scene), scenes[0])


class _Clock:
    """Tells from when which part of some work was begun how long the rest may take."""

    def __init__(self) -> None:
        self._first: tuple[float, float] | None = None  # a moment, and the share that was begun then
        self._last = (0.0, 0.0)

    def reached(self, share: float) -> None:
        """The work has come so far."""
        self._last = (time.monotonic(), share)
        self._first = self._first or self._last

    @property
    def seconds_left(self) -> float | None:
        """None where nobody knows yet."""
        if self._first is None or self._last[1] <= self._first[1]:
            return None
        took, done = self._last[0] - self._first[0], self._last[1] - self._first[1]
        piece = self._first[1]  # what was begun, and is not done
        return max(took * (1.0 - self._last[1] + piece) / done - (time.monotonic() - self._last[0]), 0.0)


def _in_words(code: int, last_words: str) -> str:
    """Why a second Blender ended before its work was done."""
    if code < 0 and -code == getattr(signal, "SIGKILL", 9):
        return (
            "the second Blender was ended by the system, most likely as memory ran out; close other programs, or bake "
            "fewer pixels"
        )
    if code < 0 or code > 255:
        return "the second Blender crashed; render the scene once to see whether it does so without a bake too"
    said = f" ({last_words})" if last_words else f" with code {code}"
    return f"the second Blender failed{said}"
