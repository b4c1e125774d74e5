"""The bake as one object: the operator and the shell both drive it, a step at a time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np

from ...core import equirect, radiance
from ...core.cubemap import FACES
from ...core.errors import Cancelled, PccError
from ...core.prefilter import prefilter
from ...core.probe import Engine, ProbeSpec
from ...core.sidecar import Sidecar
from ...version import ADDON_VERSION
from ..overrides import override
from ..probes import ensure_uid
from ..read import scene, surfaces
from ..read.fingerprint import SceneFingerprint
from ..read.probes import all_probes, probe_spec
from ..read.receivers import survey
from ..shade import groups, twin
from ..store import levels
from .capture import OVERSCAN, Stage


@dataclass(frozen=True)
class BakedProbe:
    """What became of one probe.

    Attributes:
        probe: its name.
        error: why it has no new bake, or None.
        seconds: of rendering and assembling.
        files: the pictures' paths; empty where they are packed.
        replaced_pixels: what was wrong in the capture, in words.
    """

    probe: str
    error: str | None = None
    seconds: float = 0.0
    files: tuple[str, ...] = ()
    replaced_pixels: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Task:
    """One probe to bake: its object and record, the hash of what it depends on, the levels that are called for."""

    probe: bpy.types.Object
    spec: ProbeSpec
    content_hash: str
    roughnesses: tuple[float, ...]
    all_inside: bool

    @property
    def steps(self) -> int:
        """Six faces, assembling, each level but the sharpest, storing."""
        return len(FACES) + 1 + len(self.roughnesses)


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
        specs, ready = self._read_probes()
        if not ready:
            return
        levels.check_folder(self._folder)
        self.missing_textures = scene.missing_textures(self._view_layer, self._scene.world)
        found = survey(self._view_layer, specs, self._scene.pcc.roughness_limit)
        fingerprint = SceneFingerprint(self._scene, self._view_layer)
        tasks = [
            _Task(
                probe,
                spec,
                fingerprint.content_hash(spec),
                tuple(sorted({0.0} | found.roughnesses(spec.name) | _levels_in_use(probe))),
                found.all_inside(spec.name),
            )
            for probe, spec in ready
        ]
        total = sum(task.steps for task in tasks)
        done = 0
        yield
        stage = Stage(self._stack, self._scene, self._view_layer)
        _show_diffuse_only(
            self._stack,
            [receiver.material for receiver in found.receivers],
            twin.Reflection(None, self._scene.pcc.roughness_limit),
        )
        for task in tasks:
            target = done + task.steps
            try:
                for message in self._bake(stage, task):
                    done += 1
                    self.progress, self.message = done / total, f"{task.spec.name}: {message}"
                    yield
            except Cancelled:
                raise
            except PccError as error:
                self.results.append(BakedProbe(task.spec.name, str(error)))
            done = target

    def _read_probes(self) -> tuple[list[ProbeSpec], list[tuple[bpy.types.Object, ProbeSpec]]]:
        """The records of all sound probes of the scene, and those to bake with theirs; faults become results."""
        specs, ready = [], []
        for probe in all_probes(self._scene):
            try:
                spec = probe_spec(probe)
            except PccError as error:
                if probe in self._probes:
                    self.results.append(BakedProbe(probe.name, str(error)))
                continue
            specs.append(spec)
            if probe in self._probes:
                ready.append((probe, spec))
        return specs, ready

    def _bake(self, stage: Stage, task: _Task) -> Iterator[str]:
        """Render, assemble, blur and store one probe; yields what comes next."""
        probe, spec = task.probe, task.spec
        start = time.perf_counter()
        faces: list[np.ndarray] = []
        replaced: list[str] = []
        with ExitStack() as stack:
            stage.aim(stack, spec)
            for index, face in enumerate(FACES):
                yield f"face {face.name}"
                picture, bad = radiance.clean(index, stage.face(spec, index), OVERSCAN)
                faces.append(picture)
                if bad is None and spec.engine is Engine.CYCLES and spec.denoise:
                    _, bad = radiance.clean(index, stage.glimpse(spec, index), OVERSCAN)
                    bad = bad and replace(bad, glimpsed=True)
                replaced += [str(bad)] if bad else []
        yield "assembling"
        pictures = {0.0: equirect.from_faces(faces, OVERSCAN)}
        for roughness in task.roughnesses:
            if roughness > 0.0:
                yield f"roughness {roughness:.3g}"
                pictures[roughness] = prefilter(pictures[0.0], roughness)
        yield "storing"
        seconds = time.perf_counter() - start
        record = Sidecar.of_bake(
            spec,
            ensure_uid(probe),
            seconds=round(seconds, 3),
            content_hash=task.content_hash,
            blender=bpy.app.version_string,
            addon=ADDON_VERSION,
            replaced_pixels=tuple(replaced),
        )
        levels.store(probe, record, pictures, self._folder, task.all_inside)
        images = [level.image for level in probe.pcc_probe.levels]
        files = tuple(bpy.path.abspath(image.filepath) for image in images if not image.packed_file)
        self.results.append(BakedProbe(spec.name, None, seconds, files, tuple(replaced)))


def _levels_in_use(probe: bpy.types.Object) -> set[float]:
    """The roughnesses that materials read from a probe now."""
    group = probe.pcc_probe.group
    names = twin.outputs_in_use(group) if group else set()
    known = (round(level.roughness, surfaces.ROUGHNESS_DIGITS) for level in probe.pcc_probe.levels)
    return {roughness for roughness in known if groups.level_output(roughness) in names}


def _show_diffuse_only(stack: ExitStack, receivers: list[bpy.types.Material], diffuse_only: twin.Reflection) -> None:
    """Switch off injected reflections, and the specular lobes of materials that will show a probe (S6)."""
    stack.callback(groups.drop_unused_groups)
    for material in bpy.data.materials:
        for node in twin.reflection_nodes(material):
            override(stack, node, "mute", True)
    for material in receivers:
        if not twin.shown_probe_group(material):
            stack.callback(twin.remove_twins, material)
            twin.add_twins(material, diffuse_only)
