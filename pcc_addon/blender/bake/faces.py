"""From the renders of faces, or a picture from elsewhere, to the levels of one picture."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace

import bpy
import numpy as np

from ...core import equirect, radiance
from ...core.cubemap import FACE_NAMES
from ...core.effects import relief
from ...core.nearness import of_walls
from ...core.pictures import NEARNESS
from ...core.prefilter import prefilter
from ...core.probe import Engine, ProbeSpec
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
        nearness: 1/metres to what is seen, (2n, 4n), where that is captured too.
    """

    spec: ProbeSpec
    names: tuple[str, ...] = FACE_NAMES
    before: bpy.types.Image | None = None
    faces: dict[str, np.ndarray] = field(default_factory=dict)
    picture: np.ndarray | None = None
    nearness: np.ndarray | None = None
    replaced: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def bytes_held(self) -> int:
        return sum(face.nbytes for face in self.faces.values()) + (0 if self.picture is None else self.picture.nbytes)

    def forget(self) -> None:
        """Let go of all pictures."""
        self.faces.clear()
        self.picture = self.nearness = None


def steps(capture: Capture, roughnesses: Sequence[float]) -> int:
    """Pieces of work: its faces or a picture from elsewhere, assembling, each level but the sharpest, storing."""
    source, surveyed = capture.spec.source, len(FACE_NAMES) * capture.spec.captures_distance
    return surveyed + (environment.steps(source) if source.stretched else len(capture.names)) + 1 + len(roughnesses)


def render(stage: Stage, capture: Capture) -> Iterator[str]:
    """Render the faces of one probe, or take its picture from elsewhere; yields what comes next."""
    spec = capture.spec
    if spec.source.stretched:
        taken = yield from environment.take(spec, stage.scene)
        capture.picture = taken.picture
        capture.replaced += taken.replaced
        return
    with ExitStack() as stack:
        stage.aim(stack, spec)
        for index, name in enumerate(FACE_NAMES):
            if name not in capture.names:
                continue
            yield f"face {name}"
            picture, bad = radiance.clean(index, stage.face(spec, index), OVERSCAN)
            capture.faces[name] = picture
            if bad is None and spec.engine is Engine.CYCLES and spec.denoise:
                _, bad = radiance.clean(index, stage.glimpse(spec, index), OVERSCAN)
                bad = bad and replace(bad, glimpsed=True)
            capture.replaced += [str(bad)] if bad else []
            capture.seconds += stage.owed.pop(spec.name, 0.0)


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
    capture.nearness = yield from survey(stage, capture.spec)
    capture.seconds += stage.owed.pop(capture.spec.name, 0.0)


def departure(capture: Capture) -> float | None:
    """How far what was captured departs from the box at most, over the distance to it; None where that is not known."""
    return None if capture.nearness is None else relief.departure(capture.nearness, of_walls(capture.spec))


def survey(stage: Stage, spec: ProbeSpec) -> Generator[str, None, np.ndarray]:
    """1/metres from the capture point to what is nearest, (2n, 4n) float32; yields what comes next.

    Within a `Stage.survey`; 0 where nothing is.

    Raises:
        Cancelled, BakeError: as `Stage.face`.
    """
    found = []
    with ExitStack() as stack:
        stage.aim(stack, spec)
        for index, name in enumerate(FACE_NAMES):
            yield f"distance, face {name}"
            found.append(stage.nearness(spec, index)[..., :1])
    return equirect.from_faces(found, OVERSCAN)[..., 0]


def warnings_of(
    picture: np.ndarray, spec: ProbeSpec, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
) -> list[str]:
    """What the user should know of a capture (h, 2h, 3), in words."""
    return [black_capture(spec, scene, view_layer)] if is_nearly_black(picture) else []
