"""What is decided from readings, and why: bake, injection, status, panels and reports obey it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .belonging import Belongings, belongings, vessels
from .cubemap import FACE_NAMES
from .effects.kinds import KINDS, MICROFACETS, WITHOUT_GLOSS, layers_of, may_transmit
from .effects.lookup import LEAST_SPREAD, MOST_SPREAD
from .effects.records import LookupEffects
from .effects.roughness import neighbours
from .effects.surface import Ray, SurfaceEffects, surface_effects
from .effects.transmission import Interface
from .faces_needed import FaceNeeds
from .parts import Division, divide
from .pictures import LADDER, PictureKey, PictureKind
from .probe import ProbeSpec, Receivers
from .readings import CameraReading, MaterialReading, ProbeReading, SceneReading, SurfaceReading

_THIN = 0.08  # thinness of a wall below which it is a pane
SAMPLERS = 30  # pictures that EEVEE lets a material read, beside two of its own
_REFLECTS_NOTHING = "it reflects nothing"
_NO_SURFACE = "has no surface that a probe could light; left as it is"


@dataclass(frozen=True)
class SurfacePlan:
    """One surface of a material.

    Attributes:
        path: as in its reading.
        effects: what its shader computes, or None where it keeps its own lobe.
        roughness: the least and the greatest that it may have.
        reasons: why, in words; all of them.
        interface: how often what it is on bends the light that passes, where it transmits.
        handed_over: the roughness from which on it is left to its own lobe, where it may be so rough; else None.
        layered: whether something lies over the lobe, such as a coat.
        bends_normals: whether its normals must be bent lest they mirror the view into the surface.
    """

    path: tuple[str, ...]
    effects: SurfaceEffects | None
    roughness: tuple[float, float]
    reasons: tuple[str, ...]
    interface: Interface = Interface.SOLID
    handed_over: float | None = None
    layered: bool = False
    bends_normals: bool = False

    @property
    def name(self) -> str:
        """Its node, with the groups that lead to it."""
        return " › ".join(self.path)

    def levels(self, rungs: Sequence[float], ray: Ray, hardening: bool = False) -> range:
        """Which levels of a ladder of ascending roughnesses it reads along one of its rays.

        Args:
            rungs: the roughnesses.
            ray: which.
            hardening: whether the probe shows the sharper what is nearer.
        """
        low, high = (roughness * ray.narrowing for roughness in self.roughness)
        if hardening:
            low, high = low * LEAST_SPREAD, high * MOST_SPREAD
        return neighbours(rungs, low, high)

    @property
    def captured_whole(self) -> bool:
        """Whether captures show its own lobes though they depend on the place, as glass is to be seen through."""
        return self.effects is not None and self.effects.transmits


@dataclass(frozen=True)
class MaterialPlan:
    """One material.

    Attributes:
        material: its name.
        division: the probes that it shows, itself and as copies that some of its objects wear.
        objects: (object, probe): which of them each of its objects shows; an object in several rooms has several.
        surfaces: one for each of its surfaces.
        reasons: why these probes, or why none, in words.
        emits: whether it is a light of its own.
    """

    material: str
    division: Division
    objects: tuple[tuple[str, str], ...]
    surfaces: tuple[SurfacePlan, ...]
    reasons: tuple[str, ...]
    emits: bool = False

    @property
    def probes(self) -> tuple[str, ...]:
        """Those that it shows, the one with most of its objects first; empty: it is left as it is."""
        return self.division.probes

    @property
    def served(self) -> dict[tuple[str, ...], SurfacePlan]:
        """The surfaces that show probes, by path."""
        return {surface.path: surface for surface in self.surfaces if surface.effects is not None}

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence on each thing that keeps its own reflection, and on what else a user should know.

        Nobody misses a reflection on what has none, so that is only in the plan.
        """
        left = [s for s in self.surfaces if s.effects is None and s.reasons != (_REFLECTS_NOTHING,)]
        named = [
            f"material '{self.material}': surface '{s.name}' keeps its own lobe: {_listed(s.reasons)}" for s in left
        ]
        whole = [f"material '{self.material}' {reason}" for reason in self.reasons if reason != _NO_SURFACE]
        return (*whole, *(named if self.probes or not whole else ()))


@dataclass(frozen=True)
class ProbePlan:
    """One probe.

    Attributes:
        probe: its name.
        receivers: what is known of the surfaces that show it.
        shares: whether a material shows it and others, each where it is the right one.
        lookup: what its lookup computes.
        pictures: those that it needs, sharpest first.
        reasons: why, in words.
        faces: those that its bake must capture, by name, in the order of `cubemap.FACES`.
        shown_faces: those that lookups may read of the picture that it has.
    """

    probe: str
    receivers: Receivers
    shares: bool
    lookup: LookupEffects
    pictures: tuple[PictureKey, ...]
    reasons: tuple[str, ...]
    faces: tuple[str, ...] = FACE_NAMES
    shown_faces: tuple[str, ...] = FACE_NAMES


@dataclass(frozen=True)
class Plan:
    """What a scene requires.

    Attributes:
        probes, materials: by name; faulty probes are missing and named in the notes.
        notes: sentences on probes that were left alone.
    """

    probes: tuple[ProbePlan, ...]
    materials: tuple[MaterialPlan, ...]
    notes: tuple[str, ...] = ()

    def probe(self, name: str) -> ProbePlan | None:
        return next((probe for probe in self.probes if probe.probe == name), None)


def make_plan(scene: SceneReading) -> Plan:
    """Decide which probes each material shows, what each surface computes, and which pictures each probe needs."""
    specs = [probe.spec for probe in scene.probes if probe.spec is not None]
    notes = [probe.fault for probe in scene.probes if probe.fault]
    found = belongings(specs, scene.placements)
    materials = []
    shapes = _interfaces(scene)
    hardening = frozenset(spec.name for spec in specs if spec.contact_hardening)
    for material in scene.materials:
        owners = found.owners.get(material.name, {})
        if owners:
            surfaces = plan_surfaces(material, scene.roughness_limit, shapes.get(material.name, Interface.SOLID))
            materials.append(_plan_material(material, owners, found, surfaces, hardening))
    read = {probe.name: probe for probe in scene.probes}
    showing: dict[str, list[MaterialPlan]] = {spec.name: [] for spec in specs}
    for plan in materials:
        for probe in plan.probes:
            showing[probe].append(plan)
    probes = [_plan_probe(spec, showing[spec.name], found, scene.cameras, read[spec.name]) for spec in specs]
    faces = FaceNeeds(scene)
    probes = [_with_faces(probe, faces, read[probe.probe], showing[probe.probe]) for probe in probes]
    return Plan(tuple(probes), tuple(materials), tuple(notes))


def plan_surfaces(
    material: MaterialReading, roughness_limit: float, interface: Interface = Interface.SOLID
) -> tuple[SurfacePlan, ...]:
    """What each surface of a material computes, or why it keeps its own lobe."""
    return tuple(
        _plan_surface(surface, roughness_limit, material.bends_normals, interface) for surface in material.surfaces
    )


def _interfaces(scene: SceneReading) -> dict[str, Interface]:
    """How often each material bends the light that passes: as its user says, else as most of what it covers would.

    A surface that ends somewhere bends it once, as renderers do: it may be that of water. Thin walls count as panes.
    """
    areas: dict[str, dict[Interface, float]] = {}
    for wall in scene.walls:
        kind = Interface.ONCE if wall.is_open else Interface.PANE if wall.thinness < _THIN else Interface.SOLID
        tally = areas.setdefault(wall.material, {})
        tally[kind] = tally.get(kind, 0.0) + wall.area
    found = {name: max(tally, key=lambda kind: (tally[kind], kind.value)) for name, tally in areas.items()}
    found |= dict.fromkeys(vessels(scene.placements, set(areas)), Interface.VESSEL)
    return found | {material.name: Interface.PANE for material in scene.materials if material.slab}


def _plan_surface(surface: SurfaceReading, limit: float, bends_normals: bool, interface: Interface) -> SurfacePlan:
    roughness = surface.scalar("Roughness") if surface.has("Roughness") else 0.0
    reasons = list(_refusals(surface, roughness, limit))
    if interface is Interface.VESSEL and surface.kind in KINDS and may_transmit(surface):
        reasons.append("is seen through, and other objects stand inside what it covers, which no probe could show")
    effects = None if reasons or surface.kind not in KINDS else surface_effects(surface, interface)
    low, high = (0.0, 1.0) if roughness is None else (min(max(roughness, 0.0), 1.0),) * 2
    if effects is None:
        return SurfacePlan(surface.path, None, (low, high), tuple(reasons or [_REFLECTS_NOTHING]), interface)
    handed_over = limit if high > limit else None
    how = f"roughness {low:.3g}" if low == high else "roughness varies"
    beyond = f"; where it is above the limit {limit:.3g} it keeps its own lobe" if handed_over is not None else ""
    layers = layers_of(surface)
    refused = KINDS[surface.kind].refused
    given = {name: surface.value(name) for name in refused if surface.has(name)}
    rounded = [refused[name].served for name, value in given.items() if value != 0.0 and refused[name].ignored(value)]
    reasons = [how + beyond, effects.label, *rounded, *(f"its {layer} lies over that as it is" for layer in layers)]
    bent = bends_normals and surface.has("Normal") and surface.value("Normal") is None
    reasons += ["its normals are bent where they would mirror the view into the surface"] * bent
    if effects.transmits and interface is Interface.ONCE:
        reasons.append("it bends light once, as its objects have no far side (Thickness: Slab would make them panes)")
    return SurfacePlan(surface.path, effects, (low, high), tuple(reasons), interface, handed_over, bool(layers), bent)


def _refusals(surface: SurfaceReading, roughness: float | None, limit: float) -> Iterator[str]:
    """Why a surface keeps its own lobe, all reasons; none where a probe can serve it or it reflects nothing."""
    if surface.kind in WITHOUT_GLOSS:
        return
    kind = KINDS.get(surface.kind)
    if kind is None:
        words = surface.kind.removeprefix("ShaderNode").removeprefix("Bsdf")
        yield f"is a {words} shader (a Principled BSDF would show a probe)"
        return
    yield from (no.why for name, no in kind.refused.items() if surface.has(name) and no.applies(surface.value(name)))
    if roughness != 0.0 and surface.distribution and surface.distribution not in MICROFACETS:
        yield f"its microfacets are {surface.distribution.replace('_', ' ').title()} (GGX would show a probe)"
    if surface.fresnel not in ("", "F82"):
        yield "has a physical conductor's curve (F82 Tint would show a probe)"
    ior = surface.scalar("IOR") if surface.has("IOR") else None
    if ior is not None and ior < 1.0 and roughness != 0.0:
        yield "has an IOR below 1 (1 or more would show a probe, or a roughness of 0)"
    if roughness is not None and roughness > limit:
        yield f"its roughness {roughness:.3g} is above the scene's limit {limit:.3g}"


def _plan_material(
    material: MaterialReading,
    owners: dict[str, dict[str, float]],
    found: Belongings,
    surfaces: tuple[SurfacePlan, ...],
    hardening: frozenset[str],
) -> MaterialPlan:
    """The plan of a material whose objects belong to probes so much: by probe, then by object.

    The last are the names of the probes that show the sharper what is nearer.
    """
    ranked = sorted(owners, key=lambda name: (-sum(owners[name].values()), name))
    served = [surface for surface in surfaces if surface.effects is not None]
    if material.obstacles or not served:
        why = [f"{obstacle}; left as it is" for obstacle in material.obstacles]
        if not why and not surfaces:
            why = [_NO_SURFACE]
        return MaterialPlan(material.name, Division(()), (), surfaces, tuple(why), material.emits)
    each = sum(_pictures_read(surface, not hardening.isdisjoint(owners)) for surface in served)
    fitting = max(1, (SAMPLERS - material.textures) // max(each, 1))
    needs, refused = (by.get(material.name, {}) for by in (found.needs, found.refused))
    division = divide(ranked, needs, refused, found.fixed.get(material.name, ()), fitting)
    objects = sorted((item, probe) for probe in division.probes for item in owners.get(probe, ()))
    reasons = []
    if division.parts:
        reasons.append(f"is shown as {len(division.parts)} copies, whose objects show different probes")
    if division.dropped:
        dropped = _named(division.dropped)
        reasons.append(f"shows {fitting} probes and not {dropped}: EEVEE reads no more pictures in one material")
    return MaterialPlan(material.name, division, tuple(objects), surfaces, tuple(reasons), material.emits)


def _pictures_read(surface: SurfacePlan, hardening: bool) -> int:
    """How many pictures of each probe a surface reads at most."""
    low, high = surface.roughness
    assert surface.effects is not None
    few = low == high and not hardening
    blurs = {ray.narrowing for ray in surface.effects.rays}  # rays of one blur read the same
    return min(3 * len(blurs), len(LADDER)) if few else len(LADDER)


def _plan_probe(
    spec: ProbeSpec,
    shown_by: Sequence[MaterialPlan],
    found: Belongings,
    cameras: Sequence[CameraReading],
    reading: ProbeReading,
) -> ProbePlan:
    showing = [material.material for material in shown_by]
    shared = [m.material for m in shown_by if m.division.blends(spec.name)]
    outside = [name for name in showing if name in found.leaving.get(spec.name, ())]
    touching = [name for name in showing if name in found.touching.get(spec.name, ())]
    watched = bool(touching) and not _all_within(spec, cameras)
    receivers = Receivers(all_inside=not outside, seen_from_outside=watched)
    if reading.captured_at is not None:
        lookup = spec.effects(receivers, reading.captured_at, reading.source)
    else:
        lookup = spec.effects(receivers, tuple(spec.capture_point), spec.source)
    reasons = [f"{len(showing)} materials show it" if showing else "no material shows it"]
    if outside:
        reasons.append(f"surfaces of {_named(outside)} reach beyond its box, so it fades")
    if watched:
        reasons.append(
            f"surfaces of {_named(touching)} lie on its box and may be seen from outside, where it is not shown"
        )
    if lookup.stretched:
        reasons.append("its picture was not captured in its box, so it is stretched to it and turns with it")
    if lookup.hardening:
        reasons.append("rough surfaces show the sharper what is nearer to them")
    refusing = sorted(found.refusing.get(spec.name, ()))
    if refusing:
        reasons.append(f"{_named(refusing)} in its influence are not to show it")
    if shared:
        reasons.append(f"shares {_named(shared)} with other probes, by place")
    reasons.append("all levels, so that a changed roughness needs no new bake")
    pictures = tuple(PictureKey(PictureKind.RADIANCE, level) for level in range(len(LADDER)))
    return ProbePlan(spec.name, receivers, bool(shared), lookup, pictures, tuple(reasons))


def _with_faces(
    plan: ProbePlan, faces: FaceNeeds, reading: ProbeReading, shown_by: Sequence[MaterialPlan]
) -> ProbePlan:
    needed = faces.of(plan, reading, shown_by)
    reasons = (*plan.reasons, needed.reason) if needed.reason else plan.reasons
    return replace(plan, faces=needed.captured, shown_faces=needed.shown, reasons=reasons)


def _all_within(probe: ProbeSpec, cameras: Sequence[CameraReading]) -> bool:
    """Whether all cameras are known to stay in a probe's box; False where there is none."""
    places = [camera.place for camera in cameras if camera.place is not None]
    return len(places) == len(cameras) > 0 and probe.encloses(np.array(places))


def _listed(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def _named(names: Sequence[str]) -> str:
    return _listed([f"'{name}'" for name in names])
