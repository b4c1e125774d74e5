"""The open file as a bench to measure on: what its camera shows with probes, without, and with Blender's own probe.

It changes the file as it likes; whoever uses it opens the file again afterwards, or throws it away.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from ...core.accuracy.records import Kind, Settings
from ...core.effects.relief import DEPARTS
from ...core.errors import PccError
from ...core.fit.records import Fit
from ...core.frames import STILL
from ...core.probe import Engine
from ...core.sidecar import Sidecar
from ..bake.job import BakeJob
from ..fitting import FitJob, apply_fit
from ..overrides import override
from ..read.holders import Holders
from ..read.probes import bake_record
from ..rendering import Frame, Renderer, RenderSettings
from ..shade import injection
from ..store import pictures
from ..store.keeping import show_files
from .partner import partner_of
from .samplers import fullest

_SLOW = 1.0  # seconds of a frame, where none was rendered


class _Shows(Enum):
    """What materials show now."""

    UNKNOWN = 0
    THEMSELVES = 1
    PROBES = 2


@dataclass(frozen=True)
class Size:
    """Of the camera's picture, pixels."""

    width: int
    height: int


@dataclass(frozen=True)
class KeptBake:
    """A bake of the probe.

    Attributes:
        folder: where its pictures are.
        records: of it, as each probe that was baked keeps it.
        seconds: it took.
        megabytes: on disk, with the levels that materials asked for.
    """

    folder: Path
    records: tuple[str, ...]
    seconds: float
    megabytes: float


_WORTH_A_FIT = 0.0002  # of a half extent, in the box or where it is captured from


def differs(fit: Fit) -> bool:
    """Whether a fit found walls and is another box, or another capture point, than there was."""
    most = _WORTH_A_FIT * float(fit.before.half_extents.min())
    box = np.abs(np.array(fit.after.matrix) - np.array(fit.before.matrix)).max()
    point = np.abs(np.subtract(fit.point_after, fit.point_before)).max()
    return fit.found > 0 and max(float(box), float(point)) > most


@dataclass(frozen=True)
class _Drawn:
    """Where a probe was, as its user drew it."""

    basis: Matrix
    capture_offset: tuple[float, float, float]

    @classmethod
    def of(cls, probe: bpy.types.Object) -> _Drawn:
        return cls(probe.matrix_basis.copy(), tuple(probe.pcc_probe.capture_offset))

    def restore(self, probe: bpy.types.Object) -> None:
        if probe.matrix_basis != self.basis:
            probe.matrix_basis = self.basis
        if tuple(probe.pcc_probe.capture_offset) != self.capture_offset:
            probe.pcc_probe.capture_offset = self.capture_offset


class Bench:
    """Bakes a probe with any settings and renders the scene's camera.

    Attributes:
        size: of the pictures.
        frames: numbers of the scene's frames that are measured.
        last_bake: what was baked last.
        quickest: seconds of the frame that took least.
        fit: the box and the capture point of rungs that are fitted; None: nothing fits better than the probe's own.
        partner: the probe that shares the room, which only paired rungs show; None: there is none.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        probe: bpy.types.Object,
        size: Size,
        frames: tuple[int, ...],
        folder: Path,
    ) -> None:
        """Make the file ready.

        Args:
            scene, view_layer: what is rendered.
            probe: the one that is measured.
            size, frames: as the attributes.
            folder: an empty one, for bakes.
        """
        self.size, self.frames = size, frames
        self.last_bake: KeptBake | None = None
        self.quickest = _SLOW
        self._scene, self._view_layer, self._probe, self._folder = scene, view_layer, probe, folder
        self._shows, self._warm, self._made = _Shows.UNKNOWN, set[Engine](), 0
        self._bakes: dict[tuple, KeptBake] = {}
        self._drawn = _Drawn.of(probe)
        self.fit: Fit | None = None
        self.partner = partner_of(probe, scene, view_layer)
        self._flat: set[bool] = set()  # whether fitted: rooms in which nothing stands
        self._loaded: tuple | None = None  # the key of the bake that the probe has
        self._shown: tuple = ()  # the lookup that materials show
        render = scene.render
        render.use_compositing = render.use_sequencer = render.use_border = render.use_multiview = False
        scene.cycles.use_animated_seed = False
        for marker in scene.timeline_markers:
            marker.camera = None  # the camera that is measured stays
        self._camera = scene.camera

    @property
    def baked(self) -> frozenset[tuple]:
        """The keys of the bakes that are there and need not be made again."""
        return frozenset(self._bakes)

    def bake(self, settings: Settings, seed: int, most_seconds: float = 0.0) -> Iterator[str]:
        """Bake the probe as a rung says and let materials show it; yields what is done next.

        The bake that the iterator made is `last_bake`. Closing the iterator gives the bake up. A face by Cycles ends
        after `most_seconds`, unless they are 0, with too few samples: the bake is to be given up then.

        Raises:
            PccError: the bake failed.
            Cancelled: the user stopped a render.
        """
        self._made, self._shown = self._made + 1, ()
        folder = self._folder / f"bake_{self._made}"
        self._apply(settings)
        self.go_to(self.frames[0])
        seconds = 0.0
        with ExitStack() as stack:
            override(stack, self._scene.cycles, "seed", seed)
            probes = self._baked_by(settings)
            job = BakeJob(self._scene, self._view_layer, probes, folder, STILL, most_seconds=most_seconds)
            stack.callback(job.cancel)
            more = True
            while more:
                begin = time.perf_counter()
                more = job.step()
                seconds += time.perf_counter() - begin
                yield job.message
        fault = next((result.error for result in job.results if result.error), None)
        if fault:
            raise PccError(fault)
        self._loaded = settings.bake_key
        self._scene.pcc.folder = str(folder)  # where injecting puts levels that it finds missing
        self.show(settings)
        records = tuple(probe.pcc_probe.bake_record for probe in self._baked_by(settings))
        size = sum(path.stat().st_size for path in folder.iterdir()) / 1e6
        self.last_bake = KeptBake(folder, records, seconds, size)
        self._bakes[settings.bake_key] = self.last_bake
        record = bake_record(self._probe)
        if record is not None and record.departure is not None and record.departure <= DEPARTS:
            self._flat.add(settings.fitted)

    def bake_of(self, settings: Settings) -> KeptBake:
        """The bake that a rung shares with others."""
        return self._bakes[settings.bake_key]

    def show(self, settings: Settings) -> None:
        """Let materials show what makes a rung's picture: the probes as they are baked, or themselves."""
        if settings.kind is Kind.PROBE:
            if self._loaded != settings.bake_key:
                self._load(settings)
            if self._shows is _Shows.PROBES and self._shown == _lookup(settings):
                return
            self._apply(settings)
            self._shown = _lookup(settings)
            injection.inject(self._scene, self._view_layer)
            self._become(_Shows.PROBES)
            self._warm.discard(Engine.EEVEE)  # its shaders are compiled anew
            return
        self._drawn.restore(self._probe)
        self._view_layer.update()
        if self._shows is not _Shows.THEMSELVES:
            injection.remove()
            self._become(_Shows.THEMSELVES)

    def is_needless(self, settings: Settings) -> bool:
        """Whether a rung differs from another by nothing that is seen: relief where all that was captured is the box.

        Known once a bake with relief was made.
        """
        return settings.correction == "RELIEF" and settings.fitted in self._flat

    def find_fit(self) -> Iterator[str]:
        """See whether another box fits the room better; yields what is done next."""
        job = FitJob(self._scene, self._view_layer, [self._probe])
        with closing(job.steps()) as steps:
            yield from steps
        found = next((result.fit for result in job.results if result.fit), None)
        self.fit = found if found is not None and differs(found) else None

    def _apply(self, settings: Settings) -> None:
        """Write a rung into the probe, and give it the box of the fit or its own."""
        if self.partner is not None:
            self.partner.pcc_probe.is_probe = settings.paired
        for probe in self._baked_by(settings):
            apply(probe, settings)
        self._drawn.restore(self._probe)
        if settings.fitted:
            apply_fit(self._probe, self.fit, self._view_layer)
        self._view_layer.update()

    def _baked_by(self, settings: Settings) -> list[bpy.types.Object]:
        """The probes that a rung bakes."""
        return [self._probe, self.partner] if settings.paired else [self._probe]

    def samplers(self) -> int:
        """Of the material with the most, as EEVEE counts them."""
        return fullest()

    def frame(self, settings: Settings, number: int, seed: int) -> Frame:
        """Render a frame as a rung says; materials must show what it needs.

        Raises:
            BakeError: it cannot be rendered.
            Cancelled: the user stopped the render.
        """
        self.go_to(number)
        with ExitStack() as stack:
            if settings.kind is Kind.SPHERE:
                self._add_sphere(stack, settings)
            override(stack, self._scene.cycles, "seed", seed)
            override(stack, self._scene.cycles, "use_adaptive_sampling", False)
            override(stack, self._scene.eevee, "use_raytracing", settings.ray_tracing)
            renderer = Renderer(stack, self._scene, self._view_layer)
            if settings.engine not in self._warm:
                renderer.use(self._how(settings, 1))
                renderer.picture(f"scene '{self._scene.name}'")
                self._warm.add(settings.engine)
            renderer.use(self._how(settings, settings.frame_samples))
            taken = renderer.picture(f"scene '{self._scene.name}'")
        self.quickest = min(self.quickest, taken.seconds)
        return taken

    def _load(self, settings: Settings) -> None:
        """Give the probe the pictures of a bake that was made before."""
        kept = self.bake_of(settings)
        holders = Holders()
        with pictures.desk():
            for probe, text in zip(self._baked_by(settings), kept.records, strict=True):
                record = Sidecar.from_json(text, f"bake record of '{probe.name}'")
                show_files(probe, record, kept.folder, holders)
        self._scene.pcc.folder = str(kept.folder)
        self._loaded, self._shown = settings.bake_key, ()

    def _how(self, settings: Settings, samples: int) -> RenderSettings:
        return RenderSettings(settings.engine, samples, settings.frame_denoise, self.size.width, self.size.height)

    def go_to(self, number: int) -> None:
        """Show a frame of the scene."""
        if self._scene.frame_current != number:
            self._scene.frame_set(number)
        self._scene.camera = self._camera

    def _become(self, shows: _Shows) -> None:
        if self._shows is not shows:
            self._warm.discard(Engine.EEVEE)
        self._shows = shows

    def _add_sphere(self, stack: ExitStack, settings: Settings) -> None:
        """Blender's own sphere probe in the box's middle, which its parallax box has to be around.

        As it is added its parallax is a sphere, here the one around the box; with the box it takes some knowledge.
        """
        data = bpy.data.lightprobes.new("PCC Sphere", type="SPHERE")
        stack.callback(bpy.data.lightprobes.remove, data)
        item = bpy.data.objects.new("PCC Sphere", data)
        data.falloff = 0.0
        box = self._probe.matrix_world @ Matrix.Diagonal((*[self._probe.empty_display_size] * 3, 1.0))
        if settings.correction == "BOX":
            data.influence_type = data.parallax_type = "BOX"
            data.use_custom_parallax = True
            data.influence_distance = data.parallax_distance = 1.0
            item.matrix_world = box
        else:
            item.location = box.translation
            data.influence_distance = box.to_scale().length
        data.clip_start, data.clip_end = self._probe.pcc_probe.clip_start, self._probe.pcc_probe.clip_end
        self._scene.collection.objects.link(item)
        override(stack, self._scene.eevee, "gi_cubemap_resolution", str(settings.resolution))


def _lookup(settings: Settings) -> tuple:
    """What materials show beside the pictures."""
    return (settings.bake_key, settings.correction, settings.steps, settings.refinements)


def apply(probe: bpy.types.Object, settings: Settings) -> None:
    """Write a rung of a probe into the probe's own settings; what this version has no property for stays."""
    own = probe.pcc_probe
    wanted = {
        "correction": settings.correction,
        "resolution": settings.resolution,
        "samples": settings.bake_samples,
        "denoise": settings.bake_denoise,
        "half_float": settings.half_float,
        "adaptive": settings.bake_adaptive,
    }
    if settings.correction == "RELIEF":
        wanted |= {"relief_steps": settings.steps, "relief_refinements": settings.refinements}
    for name, value in wanted.items():
        if name in own.bl_rna.properties and getattr(own, name) != value:
            setattr(own, name, value)


def own_settings(probe: bpy.types.Object, engine: Engine, frame_samples: int) -> Settings:
    """A probe as its user set it, as a rung."""
    own = probe.pcc_probe
    has = own.bl_rna.properties.keys()
    relief = own.correction == "RELIEF"
    return Settings(
        kind=Kind.PROBE,
        engine=engine,
        correction=own.correction,
        resolution=own.resolution,
        bake_samples=own.samples,
        bake_denoise=own.denoise,
        half_float="half_float" in has and own.half_float,
        steps=own.relief_steps if relief else 0,
        refinements=own.relief_refinements if relief else 0,
        frame_samples=frame_samples,
        bake_adaptive=round(own.adaptive, 6),
    )


def corrections() -> tuple[str, ...]:
    """Those that this version's probes may have, the simplest first."""
    items = bpy.types.Object.bl_rna.properties["pcc_probe"].fixed_type.properties["correction"].enum_items
    return tuple(name for name in ("NONE", "BOX", "RELIEF") if name in items)
