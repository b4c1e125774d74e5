"""Probes for other engines: gathers what an export needs from the file, and writes it."""

from __future__ import annotations

import shutil
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..core import equirect
from ..core.cubemap import FACE_NAMES
from ..core.effects.records import Correction
from ..core.errors import BakeError, PccError
from ..core.export import containers, cubemaps, document, folder, lookup, shader
from ..core.export.document import ExportedProbe
from ..core.export.target import PROBE, Picture, Target
from ..core.pictures import PictureKind
from ..core.prefilter import prefilter, shrink
from ..core.probe import MAXIMUM_RESOLUTION, MINIMUM_RESOLUTION, ProbeSpec
from ..core.sequence import changes
from ..core.sidecar import Level, Sidecar, file_stem
from ..core.words import named
from ..version import ADDON_VERSION
from .read.probes import bake_record, check_place, probe_spec
from .stepping import SteppedJob
from .store import pictures
from .store.levels import faulty_picture

_BESIDE = Path(document.__file__).parent / "beside"


@dataclass(frozen=True)
class Exported:
    """What became of one probe: its files, or why there are none."""

    probe: str
    files: tuple[str, ...] = ()
    error: str | None = None
    notes: tuple[str, ...] = ()


class ExportJob(SteppedJob):
    """Exports probes into one folder, which has them all at the end or is as it was.

    Attributes:
        results: one for each probe that is finished or failed.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        probes: Sequence[bpy.types.Object],
        target: Target,
        to: Path,
        width: int | None = None,
    ) -> None:
        """A job that has not begun.

        Args:
            scene, view_layer: that the probes are of.
            probes: those to export.
            target: the engine.
            to: the folder, which is made where it is not there.
            width: texels across a face, a power of two; None: each probe's resolution, or the next power of two.

        Raises:
            PccError: the width is none that cubemaps have.
        """
        super().__init__()
        self.results: list[Exported] = []
        self._scene, self._view_layer, self._probes = scene, view_layer, list(probes)
        self._target, self._to, self._width = target, to, width
        if width is not None:
            _check_width(width)

    def _run(self) -> Iterator[None]:
        try:
            yield from self._all()
        except OSError as error:
            raise folder.cannot_write(self._to, error) from error

    def _all(self) -> Iterator[None]:
        self._view_layer.update()
        done: list[ExportedProbe] = []
        parts = self._stack.enter_context(folder.parts_of(self._to))
        for index, probe in enumerate(self._probes):
            self.progress, self.message = index / len(self._probes), f"{probe.name}: export"
            yield
            before = {path.name for path in parts.iterdir()}
            try:
                exported = yield from self._export(probe, parts)
            except PccError as error:
                self.results.append(Exported(probe.name, error=str(error)))
                continue
            files = sorted({path.name for path in parts.iterdir()} - before)
            self.results.append(Exported(probe.name, tuple(files), notes=_notes(exported)))
            done.append(exported)
        if not done:
            return
        for name in self._target.beside:
            if PROBE not in name:
                shutil.copyfile(_BESIDE / self._target.key / name, parts / name)
        names = sorted(path.name for path in parts.iterdir())
        digests = {name: folder.digest(parts / name) for name in names}
        text = document.document(done, self._target, ADDON_VERSION, digests)
        (parts / document.NAME).write_text(text, encoding="utf-8")
        folder.publish(parts, self._to, names)

    def _export(self, probe: bpy.types.Object, parts: Path) -> Generator[None, None, ExportedProbe]:
        target = self._target
        check_place(probe, self._view_layer)
        captured = _captured(probe, self._scene.frame_current)
        spec, record, picture, captured_at = captured.spec, captured.record, captured.picture, captured.at
        yield
        width = self._width or _next_width(record.resolution)
        roughnesses = target.roughnesses(width)
        levels = []
        for done in _levels(picture, target, width, roughnesses):
            levels.append(done)
            yield
        stem = file_stem(probe.name, record.uid)
        written = _write_pictures(parts, stem, picture, levels, target)
        effects = lookup.effects_of(spec, captured_at)
        shader_file = f"{stem}.{target.language.suffix}"
        exported = ExportedProbe(spec, record, captured_at, effects, width, roughnesses, shader_file, written)
        heading = (
            f"Parallax probe '{probe.name}' for {target.title}, in {target.language.name}.\n"
            f"Written by Parallax Probes {ADDON_VERSION}; {document.NAME} beside it says the rest."
        )
        numbers = lookup.numbers(spec, captured_at, target)
        text = shader.shader(exported.formula, numbers, target, heading)
        (parts / shader_file).write_text(text, encoding="utf-8")
        for name in target.beside:
            if PROBE in name:
                text = (_BESIDE / target.key / name).read_text(encoding="utf-8").replace(PROBE, stem)
                (parts / name.replace(PROBE, stem)).write_text(text, encoding="utf-8")
        return exported


@dataclass(frozen=True, eq=False)
class CubemapFile:
    """A probe's cubemap as the content of a KTX 2.0 file, with the roughness of each level."""

    ktx2: bytes
    width: int
    roughnesses: tuple[float, ...]
    captured_at: tuple[float, float, float]


def cubemap_file(probe: bpy.types.Object, target: Target, widest: int) -> CubemapFile:
    """A baked probe's cubemap at the scene's frame, of at most so many texels across a face.

    Raises:
        PccError: the probe has no bake, or its pictures are missing.
    """
    captured = _captured(probe, bpy.context.scene.frame_current)
    width = min(_next_width(captured.record.resolution), widest)
    picture = captured.picture
    while picture.shape[0] % 2 == 0 and picture.shape[0] > 2 * width:
        picture = shrink(picture, picture.shape[0] // 2).astype(np.float32)
    roughnesses = target.roughnesses(width)
    text = containers.ktx2(list(_levels(picture, target, width, roughnesses)), f"Parallax Probes {ADDON_VERSION}")
    return CubemapFile(text, width, roughnesses, captured.at)


@dataclass(frozen=True, eq=False)
class _Captured:
    """What a probe shows at a frame: its picture (h, 2h, 3) along the world's axes, and where that was taken."""

    spec: ProbeSpec
    record: Sidecar
    picture: np.ndarray
    at: tuple[float, float, float]


def _captured(probe: bpy.types.Object, frame: int) -> _Captured:
    spec, record = probe_spec(probe), bake_record(probe)
    if record is None:
        raise BakeError(f"probe '{probe.name}' has no bake; bake it first")
    if fault := faulty_picture(probe, record):
        raise BakeError(f"probe '{probe.name}': {fault}; bake it again")
    number, captured_at = _shown(record, frame)
    x, y, z = spec.box.centre if record.source.stretched else captured_at
    picture = _along_world_axes(spec, record, _capture(probe, record, number))
    return _Captured(spec, record, picture, (float(x), float(y), float(z)))


def _levels(picture: np.ndarray, target: Target, width: int, roughnesses: Sequence[float]) -> Iterator[cubemaps.Level]:
    """All levels down to a single texel."""
    for k in range(width.bit_length()):
        if k < len(roughnesses):
            blurred = prefilter(picture, roughnesses[k])
        yield cubemaps.level(blurred, target.from_sampler, width >> k, sharp=k == 0)


def _shown(record: Sidecar, frame: int) -> tuple[int | None, tuple[float, float, float]]:
    """The number of the picture of a sequence that is shown at a frame, and where it was taken; None for a still."""
    shown = None
    for change in changes(record.moments):
        if shown is None or change.frame <= frame:
            shown = change
    return (None, record.capture_point) if shown is None else (shown.number, shown.capture_point)


def _capture(probe: bpy.types.Object, record: Sidecar, number: int | None) -> np.ndarray:
    """(h, 2h, 3) float32: the probe's sharpest picture."""
    image = next(level.image for level in probe.pcc_probe.levels if level.roughness == 0.0 and level.image)
    if number is None:
        return pictures.read_pixels(image)
    at = pictures.pictures_folder(probe)
    level = _level_of(record, number)
    if at is None or level is None or not (at / level.file).is_file():
        raise BakeError(f"probe '{probe.name}': picture {number} of its sequence is missing; bake it again")
    return pictures.read_file(at / level.file)


def _level_of(record: Sidecar, number: int) -> Level | None:
    kept = (PictureKind.RADIANCE, 0, number)
    return next((level for level in record.levels if (level.key.kind, level.key.level, level.key.number) == kept), None)


def _along_world_axes(spec: ProbeSpec, record: Sidecar, picture: np.ndarray) -> np.ndarray:
    """A picture that is stretched to the box as one that was taken in the middle of it, along the world's axes.

    The lookup of such a picture multiplies the corrected direction by one matrix, so this is exact between texels.
    """
    if not record.source.stretched:
        return picture
    box = spec.box
    own_axes = lookup.effects_of(spec, tuple(box.centre)).correction is Correction.NONE
    ratios = np.ones(3) if own_axes else box.half_widths.min() / box.half_widths
    to_picture = box.face_normals * ratios[:, None]
    height, width = picture.shape[:2]
    rows = (equirect.directions(width, height, slice(row, row + 1))[0] for row in range(height))
    return np.stack([cubemaps.bicubic_lookup(picture, row @ to_picture.T) for row in rows]).astype(np.float32)


def _write_pictures(
    parts: Path, stem: str, picture: np.ndarray, levels: Sequence[cubemaps.Level], target: Target
) -> dict[str, str | list[str]]:
    written: dict[str, str | list[str]] = {}
    for kind in target.pictures:
        if kind is Picture.FACES:
            names = [f"{stem}.{face}.exr" for face in cubemaps.FACE_FILES]
            for name, face in zip(names, levels[0], strict=True):
                pictures.write_file(parts / name, face[::-1])
            written[kind.value] = names
            continue
        name = f"{stem}.{kind.value}"
        if kind is Picture.DDS:
            (parts / name).write_bytes(containers.dds(levels))
        elif kind is Picture.KTX2:
            (parts / name).write_bytes(containers.ktx2(levels, f"Parallax Probes {ADDON_VERSION}"))
        elif kind is Picture.EQUIRECT_EXR:
            pictures.write_file(parts / name, picture)
        else:
            pictures.write_radiance(parts / name, picture)
        written[kind.value] = name
    return written


def _notes(exported: ExportedProbe) -> tuple[str, ...]:
    notes = []
    name = exported.spec.name
    if exported.spec.captures_distance:
        notes.append(f"probe '{name}': engines are given its box, not its relief")
    if missing := [face for face in FACE_NAMES if face not in exported.record.faces]:
        notes.append(
            f"probe '{name}': nothing here mirrors {named(missing)}, so that was not rendered and is guessed; for "
            "surfaces that do, set its effect All Faces to On and bake it again"
        )
    if exported.record.moments:
        notes.append(f"probe '{name}': the picture of this frame is exported; its others are not")
    return tuple(notes)


def _next_width(resolution: int) -> int:
    return 1 << (resolution - 1).bit_length()


def _check_width(width: int) -> None:
    if width & (width - 1) or not MINIMUM_RESOLUTION <= width <= MAXIMUM_RESOLUTION:
        raise PccError(
            f"face width {width} is no power of two between {MINIMUM_RESOLUTION} and {MAXIMUM_RESOLUTION}; choose "
            f"{max(MINIMUM_RESOLUTION, min(_next_width(max(width, 1)), MAXIMUM_RESOLUTION))}"
        )
