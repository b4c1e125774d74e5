"""Which probes each material shows, and whether its objects show copies of it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from .belonging import Belongings
from .decisions import Decision, Effect
from .parts import Division, divide
from .pictures import LADDER
from .readings import MaterialReading
from .surface_plan import REFLECTS_NOTHING, SurfacePlan
from .words import listed, named

SAMPLERS = 30  # pictures that EEVEE lets a material read, beside two of its own
_NO_SURFACE = "has no surface that a probe could light; left as it is"


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
        decisions: what each effect of the material as a whole was decided to be.
        strays: probes that it shows on objects which are not in their influence, and not all in another's.
        choices: what its user chose of the probes that it shows, in words.
    """

    material: str
    division: Division
    objects: tuple[tuple[str, str], ...]
    surfaces: tuple[SurfacePlan, ...]
    reasons: tuple[str, ...]
    emits: bool = False
    decisions: tuple[Decision, ...] = ()
    strays: frozenset[str] = frozenset()
    choices: tuple[str, ...] = ()

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
        left = [s for s in self.surfaces if s.effects is None and s.reasons != (REFLECTS_NOTHING,)]
        kept = [f"material '{self.material}': surface '{s.name}' keeps its own lobe: {listed(s.reasons)}" for s in left]
        whole = [f"material '{self.material}' {reason}" for reason in self.reasons if reason != _NO_SURFACE]
        return (*whole, *(kept if self.probes or not whole else ()))


def plan_material(
    material: MaterialReading,
    owners: dict[str, dict[str, float]],
    found: Belongings,
    surfaces: tuple[SurfacePlan, ...],
    hardening: frozenset[str],
    relieved: frozenset[str] = frozenset(),
    borrowing: frozenset[str] = frozenset(),
) -> MaterialPlan:
    """The plan of a material whose objects belong to probes so much: by probe, then by object.

    The last are the names of the probes that show the sharper what is nearer, of those that read how near it is, and of
    those that show what was captured for another one.
    """
    ranked = sorted(owners, key=lambda name: (-sum(owners[name].values()), name in borrowing, name))
    served = [surface for surface in surfaces if surface.effects is not None]
    if material.obstacles or not served:
        why = [f"{obstacle}; left as it is" for obstacle in material.obstacles]
        if not why and not surfaces:
            why = [_NO_SURFACE]
        return MaterialPlan(material.name, Division(()), (), surfaces, tuple(why), material.emits)
    each = sum(_pictures_read(surface, not hardening.isdisjoint(owners)) for surface in served)
    each += not relieved.isdisjoint(owners)
    fitting = max(1, (SAMPLERS - material.textures) // max(each, 1))
    needs, refused = (by.get(material.name, {}) for by in (found.needs, found.refused))
    division = divide(ranked, needs, refused, found.fixed.get(material.name, ()), fitting)
    several = f"its objects are in {len(ranked)} probes" if len(ranked) > 1 else "its objects are in one probe"
    told = "its objects show copies of it" if division.parts else several
    by_place = material.forced.decide(Effect.BY_PLACE, any(map(division.blends, division.probes)), told)
    if by_place.forced and not by_place.on:
        first = ranked[:1]
        own = {item: {*first}.intersection(probes) for item, probes in needs.items()}
        division = divide(first, own, refused, found.fixed.get(material.name, ()), fitting)
    elif by_place.forced:
        division = divide(ranked, needs, refused, found.fixed.get(material.name, ()), fitting, together=len(ranked))
    objects = sorted((item, probe) for probe in division.probes for item in owners.get(probe, ()))
    reasons = []
    if division.parts:
        reasons.append(f"is shown as {len(division.parts)} copies, whose objects show different probes")
    stuck = found.excluded.get(material.name, set()) & found.fixed.get(material.name, set()) if division.kept else ()
    if stuck:
        reasons.append(f"shows probes on {named(sorted(stuck))} all the same: linked, or given it by a modifier")
    if division.dropped:
        dropped = named(division.dropped)
        reasons.append(f"shows {fitting} probes and not {dropped}: EEVEE reads no more pictures in one material")
    return MaterialPlan(
        material.name,
        division,
        tuple(objects),
        surfaces,
        tuple(reasons),
        material.emits,
        (by_place,),
        _strays(division, found.strays.get(material.name, {})),
    )


def _strays(division: Division, reached: Mapping[str, Collection[str]]) -> frozenset[str]:
    """The probes that objects show beside those that they reach."""
    worn = {item: part.probes for part in division.parts for item in part.objects}
    shown = ((worn.get(item, division.kept), probes) for item, probes in reached.items())
    return frozenset(probe for some, probes in shown for probe in some if probe not in probes)


def _pictures_read(surface: SurfacePlan, hardening: bool) -> int:
    """How many pictures of each probe a surface reads at most."""
    low, high = surface.roughness
    assert surface.effects is not None
    few = low == high and not hardening
    blurs = {ray.narrowing for ray in surface.effects.rays}  # rays of one blur read the same
    return min(3 * len(blurs), len(LADDER)) if few else len(LADDER)
