"""From the renders of faces, or a picture from elsewhere, to the levels of one picture."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace

import bpy
import numpy as np

from ...core import equirect, radiance
from ...core.cubemap import FACE_NAMES
from ...core.effects import relief
from ...core.kept_faces import NOWHERE, KeptFace, KeptProbe
from ...core.nearness import of_walls
from ...core.pictures import NEARNESS
from ...core.prefilter import prefilter
from ...core.probe import Engine, ProbeSpec, Source
from .. import compat
from ..store.pictures import read_pixels
from . import environment
from .capture import OVERSCAN, Stage
from .surroundings import black_capture, is_nearly_black


@dataclass
class Capture:
    """The faces of one probe that wait to be assembled, what was wrong in them, and the seconds spent on it.

    A picture that was not captured in the box stands for the faces.

    Attributes:
        names: of the faces to render.
        before: the picture that has others already; None: these are guessed.
        kept: where faces are kept until the bake is whole.
        nearness: 1/metres to what is seen, (2n, 4n), where that is captured too.
    """

    spec: ProbeSpec
    names: tuple[str, ...] = FACE_NAMES
    before: bpy.types.Image | None = None
    kept: KeptProbe = NOWHERE
    faces: dict[str, np.ndarray] = field(default_factory=dict)
    picture: np.ndarray | None = None
    nearness: np.ndarray | None = None
    replaced: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def missing(self) -> tuple[str, ...]:
        """The faces to render that are not kept."""
        return tuple(name for name in self.names if not self.kept.has(name))

    @property
    def bytes_held(self) -> int:
        return sum(face.nbytes for face in self.faces.values()) + (0 if self.picture is None else self.picture.nbytes)

    def forget(self) -> None:
        """Let go of all pictures."""
        self.faces.clear()
        self.picture = self.nearness = None


_LEVEL = 6.0  # samples that take about as long as blurring a level of as many pixels


def renders(capture: Capture) -> int:
    """Pieces of work that `render` does: its faces, or those of a picture from elsewhere."""
    source = capture.spec.source
    return environment.steps(source) if source.stretched else len(capture.names)


def weight(capture: Capture) -> float:
    """How much longer one of these takes than any other piece of work."""
    return 1.0 if capture.spec.source is Source.IMAGE else max(1.0, capture.spec.samples / _LEVEL)


def work(capture: Capture, roughnesses: Sequence[float]) -> float:
    """That of its faces, distances where they are captured, assembling, each level but the sharpest, and storing."""
    surveyed = len(FACE_NAMES) * capture.spec.captures_distance
    return renders(capture) * weight(capture) + surveyed + 1 + len(roughnesses)


def cost(capture: Capture, roughnesses: Sequence[float]) -> float:
    """What `work` comes to where pictures differ in size."""
    return work(capture, roughnesses) * capture.spec.resolution**2


def render(stage: Stage, capture: Capture) -> Iterator[str]:
    """Render the faces of one probe, or take its picture from elsewhere; yields what comes next."""
    spec = capture.spec
    if spec.source.stretched:
        taken = yield from environment.take(spec, stage.scene, capture.kept)
        capture.picture = taken.picture
        capture.replaced += taken.replaced
        return
    with ExitStack() as stack:
        aim = _Aim(stack, stage, spec)
        for index, name in enumerate(FACE_NAMES):
            if name not in capture.names:
                continue
            found = capture.kept.take(name)
            if found is None:
                yield f"face {name}"
                aim.taken()
                found = _face(stage, spec, index)
                capture.kept.keep(name, found)
                capture.seconds += stage.owed.pop(spec.name, 0.0)
            else:
                capture.seconds += found.seconds
            capture.faces[name] = found.picture
            capture.replaced += found.words


class _Aim:
    """Aims a stage at a probe when the first of its faces is rendered."""

    def __init__(self, stack: ExitStack, stage: Stage, spec: ProbeSpec) -> None:
        self._stack, self._stage, self._spec, self._done = stack, stage, spec, False

    def taken(self) -> None:
        if not self._done:
            self._stage.aim(self._stack, self._spec)
            self._done = True


def _face(stage: Stage, spec: ProbeSpec, index: int) -> KeptFace:
    """Render one face, and say what was wrong with it."""
    begin, owed = time.perf_counter(), stage.owed.get(spec.name, 0.0)
    picture, bad = radiance.clean(index, stage.face(spec, index), OVERSCAN)
    if bad is None and spec.engine is Engine.CYCLES and spec.denoise and compat.CAN_DENOISE:
        _, bad = radiance.clean(index, stage.glimpse(spec, index), OVERSCAN)
        bad = bad and replace(bad, glimpsed=True)
    seconds = time.perf_counter() - begin + stage.owed.get(spec.name, 0.0) - owed
    return KeptFace(picture, (str(bad),) if bad else (), seconds)


def levels_of(capture: Capture, roughnesses: Sequence[float]) -> Generator[str, None, dict[float, np.ndarray]]:
    """The pictures (2n, 4n, 3) by roughness, with 0 for the capture itself and `NEARNESS`; yields what comes next."""
    yield "assembling"
    pictures = {0.0: _assembled(capture) if capture.picture is None else capture.picture}
    if capture.nearness is not None:
        pictures[NEARNESS] = np.repeat(capture.nearness[..., None], 3, -1)
    for roughness in roughnesses:
        if roughness > 0.0:
            yield f"roughness {roughness:.3g}"
            pictures[roughness] = prefilter(pictures[0.0], roughness)
    return pictures


def _assembled(capture: Capture) -> np.ndarray:
    faces = [capture.faces.get(name) for name in FACE_NAMES]
    before = None if capture.before is None else read_pixels(capture.before)
    if before is not None and not capture.names:
        return before
    return equirect.from_faces(faces, OVERSCAN, before=before)


def render_nearness(stage: Stage, capture: Capture) -> Iterator[str]:
    """Capture how near things are, within a `Stage.survey`; yields what comes next."""
    capture.nearness = yield from survey(stage, capture.spec, capture.kept)
    capture.seconds += stage.owed.pop(capture.spec.name, 0.0)


def departure(capture: Capture) -> float | None:
    """How far what was captured departs from the box at most, over the distance to it; None where that is not known."""
    return None if capture.nearness is None else relief.departure(capture.nearness, of_walls(capture.spec))


def survey(stage: Stage, spec: ProbeSpec, kept: KeptProbe = NOWHERE) -> Generator[str, None, np.ndarray]:
    """1/metres from the capture point to what is nearest, (2n, 4n) float32; yields what comes next.

    Within a `Stage.survey`; 0 where nothing is. Faces may be kept, as those of a `Capture`.

    Raises:
        Cancelled, BakeError: as `Stage.face`.
    """
    found = []
    with ExitStack() as stack:
        aim = _Aim(stack, stage, spec)
        for index, name in enumerate(FACE_NAMES):
            face = kept.take(f"distance{name}")
            if face is None:
                yield f"distance, face {name}"
                aim.taken()
                face = KeptFace(np.ascontiguousarray(stage.nearness(spec, index)[..., :1]))
                kept.keep(f"distance{name}", face)
            found.append(face.picture)
    return equirect.from_faces(found, OVERSCAN)[..., 0]


def warnings_of(
    picture: np.ndarray, spec: ProbeSpec, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
) -> list[str]:
    """What the user should know of a capture (h, 2h, 3), in words."""
    found = [black_capture(spec, scene, view_layer)] if is_nearly_black(picture) else []
    rendered = spec.source is not Source.IMAGE and spec.engine is Engine.CYCLES
    if rendered and spec.denoise and not compat.CAN_DENOISE:
        found.append(f"this Blender was built without a denoiser: the picture has the noise of {spec.samples} samples")
    return found
