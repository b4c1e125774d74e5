"""The bake as one object: the operator and the shell both drive it, a step at a time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..core import equirect, radiance
from ..core.cubemap import FACES
from ..core.errors import Cancelled, PccError
from ..core.prefilter import prefilter
from ..core.probe import ProbeSpec
from ..core.sidecar import Sidecar
from ..version import ADDON_VERSION
from . import groups, levels, scene, twin
from .capture import OVERSCAN, Stage
from .fingerprint import SceneFingerprint
from .overrides import override
from .probes import all_probes, ensure_uid, probe_spec
from .receivers import survey


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
        hashes = {spec.name: fingerprint.content_hash(spec) for _, spec in ready}
        wanted = {}
        for probe, spec in ready:
            in_use = twin.outputs_in_use(probe.pcc_probe.group) if probe.pcc_probe.group else set()
            kept = {
                round(level.roughness, 4)
                for level in probe.pcc_probe.levels
                if groups.level_output(level.roughness) in in_use
            }
            wanted[spec.name] = sorted({0.0} | found.roughnesses(spec.name) | kept)
        total = sum(len(FACES) + 1 + len(roughnesses) for roughnesses in wanted.values())
        done = 0
        yield
        stage = Stage(self._stack, self._scene, self._view_layer)
        _show_diffuse_only(
            self._stack,
            [receiver.material for receiver in found.receivers],
            twin.Reflection(None, self._scene.pcc.roughness_limit),
        )
        for probe, spec in ready:
            target = done + len(FACES) + 1 + len(wanted[spec.name])
            try:
                for message in self._bake(stage, probe, spec, hashes[spec.name], wanted[spec.name]):
                    done += 1
                    self.progress, self.message = done / total, f"{spec.name}: {message}"
                    yield
            except Cancelled:
                raise
            except PccError as error:
                self.results.append(BakedProbe(spec.name, str(error)))
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

    def _bake(
        self, stage: Stage, probe: bpy.types.Object, spec: ProbeSpec, content_hash: str, wanted: list[float]
    ) -> Iterator[str]:
        """Render, assemble, blur and store one probe; yields what comes next."""
        start = time.perf_counter()
        faces: list[np.ndarray] = []
        replaced: list[str] = []
        with ExitStack() as stack:
            stage.aim(stack, spec)
            for index, face in enumerate(FACES):
                yield f"face {face.name}"
                picture, bad = radiance.clean(index, stage.face(spec, index))
                faces.append(picture)
                replaced += [str(bad)] if bad else []
        yield "assembling"
        pictures = {0.0: equirect.from_faces(faces, OVERSCAN)}
        for roughness in wanted:
            if roughness > 0.0:
                yield f"roughness {roughness:.3g}"
                pictures[roughness] = prefilter(pictures[0.0], roughness)
        yield "storing"
        seconds = time.perf_counter() - start
        record = Sidecar(
            probe=spec.name,
            uid=ensure_uid(probe),
            matrix=spec.box.matrix,
            capture_point=tuple(float(c) for c in spec.capture_point),
            resolution=spec.resolution,
            samples=spec.samples,
            engine=spec.engine.value,
            denoise=spec.denoise,
            clip=(spec.clip_start, spec.clip_end),
            seconds=round(seconds, 3),
            content_hash=content_hash,
            blender=bpy.app.version_string,
            addon=ADDON_VERSION,
            levels=(),
            replaced_pixels=tuple(replaced),
        )
        levels.store(probe, record, pictures, self._folder)
        images = [level.image for level in probe.pcc_probe.levels]
        files = tuple(bpy.path.abspath(image.filepath) for image in images if not image.packed_file)
        self.results.append(BakedProbe(spec.name, None, seconds, files, tuple(replaced)))


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
