"""Which faces of its capture each probe needs: those that lookups of the surfaces that show it may read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .cubemap import FACE_NAMES
from .decisions import Effect
from .effects.records import Correction, LookupEffects, Outside
from .effects.surface import Ray
from .material_plan import MaterialPlan
from .pictures import LADDER
from .prefilter import mixed_within
from .probe import ProbeSpec
from .probe_plan import ProbePlan
from .reach import Facets, reachable
from .readings import MaterialReading, ProbeReading, SceneReading
from .surface_plan import SurfacePlan


@dataclass(frozen=True)
class NeededFaces:
    """What lookups may read.

    Attributes:
        captured: the faces, by name, that a bake must have; in the order of `cubemap.FACES`.
        shown: those that lookups may read of the picture that there is now, which may have been taken elsewhere.
        why_all: why all of them are, in words.
    """

    captured: tuple[str, ...] = FACE_NAMES
    shown: tuple[str, ...] = FACE_NAMES
    why_all: str = "surfaces that show it may mirror any way"

    @property
    def reason(self) -> str:
        """Why some are not captured, or why all are, in words."""
        left = [name for name in FACE_NAMES if name not in self.captured]
        why = "no surface that shows it can mirror that way"
        return f"its {said(left)} not captured: {why}" if left else self.why_all


def said(faces: Sequence[str]) -> str:
    """Faces with a verb, such as "faces -Y and -Z are"."""
    *others, last = faces
    return f"faces {', '.join(others)} and {last} are" if others else f"face {last} is"


def told_missing(probe: str, lacking: Sequence[str]) -> str:
    """A sentence on faces that a probe's bake lacks."""
    return f"probe '{probe}': its {said(lacking)} not captured and needed now; bake it again"


class FaceNeeds:
    """Decides which faces the probes of a scene need."""

    def __init__(self, scene: SceneReading) -> None:
        """Read what all probes share."""
        self._animated = scene.animated
        self._materials = {material.name: material for material in scene.materials}
        self._specs = [probe.spec for probe in scene.probes if probe.spec is not None]
        self._facets = {(facets.object, facets.material): facets for facets in scene.facets}
        self._corners: dict[str, dict[str, list[np.ndarray]]] = {}  # by material, by object
        for placement in scene.placements if scene.facets else ():
            for material in placement.materials:
                self._corners.setdefault(material, {}).setdefault(placement.object, []).append(placement.corners)

    def of(self, plan: ProbePlan, reading: ProbeReading, shown_by: Sequence[MaterialPlan]) -> NeededFaces:
        """The faces that a probe needs.

        Args:
            plan: what else is decided of it.
            reading: of it; its record is there.
            shown_by: the materials that show it.
        """
        spec = reading.spec
        assert spec is not None
        bound = plan.receivers.all_inside and shown_by and not reading.read_anyhow
        if not bound or spec.animated or _looks_anywhere(plan.lookup):
            return NeededFaces()
        if _follows_relief(plan, reading):
            return NeededFaces(why_all="what stands in its box may lie any way from the capture point")
        rungs = [LADDER[key.level] for key in plan.pictures]
        read: dict[float, list[Facets]] = {}  # by how far around a direction texels are mixed
        beyond = 0.0
        for material in shown_by:
            widening = self._mixed(material, spec, rungs)
            if widening is None:
                return NeededFaces()
            for item in self._wearers(material, spec):
                facets = self._facets.get((item, material.material))
                if facets is None or item in self._animated:
                    return NeededFaces()
                read.setdefault(widening, []).append(Facets(facets.normals, facets.offsets))
                beyond = max(beyond, *(_beyond(spec, at) for at in self._corners[material.material][item]))
        merged = {widening: _merged(facets) for widening, facets in read.items()}
        captured = FACE_NAMES if spec.source.stretched else _read(spec, spec.capture_point, merged, beyond)
        if reading.captured_at is None:
            return NeededFaces(captured, captured)
        return NeededFaces(captured, _read(spec, np.array(reading.captured_at), merged, beyond))

    def _mixed(self, material: MaterialPlan, spec: ProbeSpec, rungs: Sequence[float]) -> float | None:
        """The angle within which lookups of a material mix texels; None where they may go any way."""
        reading, height = self._materials[material.material], 2 * spec.resolution
        widest = 0.0
        for surface in material.served.values():
            if not _reflects_above(surface, reading):
                return None
            assert surface.effects is not None
            for ray in surface.effects.rays:
                widest = max(widest, *_mixed_by(surface, ray, spec, rungs, height))
        return widest

    def _wearers(self, material: MaterialPlan, spec: ProbeSpec) -> Iterator[str]:
        """The objects whose points may show a probe: all that wear a material, or a copy of it, that shows it.

        An object that belongs to other probes shows one of these wherever it is in their influence.
        """
        parts = {item: part.probes for part in material.division.parts for item in part.objects}
        here = {item for item, probe in material.objects if probe == spec.name}
        for item, places in self._corners.get(material.material, {}).items():
            if spec.name not in parts.get(item, material.division.kept):
                continue
            others = {probe for owned, probe in material.objects if owned == item} - {spec.name}
            theirs = [other for other in self._specs if other.name in others]
            elsewhere = all(any(other.contains(at) for other in theirs) for at in places)
            if item in here or not elsewhere:
                yield item


def with_faces(plan: ProbePlan, faces: FaceNeeds, reading: ProbeReading, shown_by: Sequence[MaterialPlan]) -> ProbePlan:
    """The plan of a probe with the faces that its bake must capture."""
    needed = faces.of(plan, reading, shown_by)
    assert reading.spec is not None
    decision = reading.spec.forced.decide(Effect.FACES, needed.captured == FACE_NAMES, needed.reason)
    captured = FACE_NAMES if decision.on else needed.captured
    return replace(plan, faces=captured, shown_faces=needed.shown, decisions=(*plan.decisions, decision))


def _follows_relief(plan: ProbePlan, reading: ProbeReading) -> bool:
    """Whether rays may end before the walls, or will once distances are captured."""
    assert reading.spec is not None
    return plan.lookup.steps > 0 or (reading.spec.captures_distance and reading.departure is None)


def _looks_anywhere(lookup: LookupEffects) -> bool:
    """Whether lookups go along directions that do not end on the box."""
    return lookup.correction is Correction.NONE or lookup.stretched or lookup.outside is Outside.UNCORRECTED


def _reflects_above(surface: SurfacePlan, material: MaterialReading) -> bool:
    """Whether all lookups of a surface on a flat polygon rise above it."""
    effects = surface.effects
    if effects is None or effects.transmits or effects.anisotropy is not None:
        return False
    reading = next(one for one in material.surfaces if one.path == surface.path)
    if not reading.has("Normal"):
        return True
    normal = reading.value("Normal")
    return surface.bends_normals if normal is None else isinstance(normal, tuple) and not any(normal)


def _mixed_by(surface: SurfacePlan, ray: Ray, spec: ProbeSpec, rungs: Sequence[float], height: int) -> Iterator[float]:
    for level in surface.levels(rungs, ray, spec.contact_hardening):
        yield mixed_within(height, rungs[level])


def _beyond(spec: ProbeSpec, corners: np.ndarray) -> float:
    """How far world-space points (n, 3) reach out of a probe's box, metres; 0 where they do not."""
    return max(float((np.abs(spec.box.coordinates(corners)) - spec.box.half_widths).max()), 0.0)


def _merged(facets: Sequence[Facets]) -> Facets:
    """One facet for each normal: the deepest, whose half space holds those of the others."""
    normals = np.concatenate([each.normals for each in facets])
    offsets = np.concatenate([each.offsets for each in facets])
    if not len(normals):
        return Facets(normals, offsets)
    unique, index = np.unique(normals, axis=0, return_inverse=True)
    deepest = np.full(len(unique), np.inf)
    np.minimum.at(deepest, index.ravel(), offsets)
    return Facets(unique, deepest)


def _read(spec: ProbeSpec, capture_point: np.ndarray, facets: dict[float, Facets], beyond: float) -> tuple[str, ...]:
    """The faces that facets may read, by the angle within which they mix texels; all where nothing is seen."""
    found: set[str] = set()
    for widening, each in facets.items():
        found |= reachable(spec, capture_point, each, beyond, widening)
    return tuple(name for name in FACE_NAMES if name in found) or FACE_NAMES
