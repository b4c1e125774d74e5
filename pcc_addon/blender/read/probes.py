"""Probe objects as plain data: which there are, their settings, their last bake."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import lru_cache

import bpy
import numpy as np
from mathutils import Matrix

from ...core.effects.records import Outside
from ...core.errors import PccError, ProbeError
from ...core.influence import Influence
from ...core.probe import Box, Engine, ProbeSpec, Source
from ...core.sidecar import Sidecar
from ..effect_settings import forced_of_probe
from ..properties import PCC_Probe
from .moving import is_animated

# The fields of a record that are what the setting of the same name says.
_AS_SET = [
    field.name
    for field in fields(ProbeSpec)
    if field.type in {"int", "float", "bool"} and field.name not in {"corrected", "relief", "animated"}
]


def all_probes(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The scene's own probes, by name; those linked from libraries show the bakes of their own files."""
    return sorted((o for o in scene.objects if is_own_probe(o)), key=lambda o: o.name)


def is_own_probe(item: bpy.types.Object) -> bool:
    """Whether an object is a probe of this file; probes are empties, which most objects can quickly say not to be."""
    return item.type == "EMPTY" and item.pcc_probe.is_probe and not item.library


def placed_objects() -> set[bpy.types.Object]:
    """All objects that are in a collection; deleted ones may stay in the file without.

    `Object.users_collection` goes over all objects, so it is for one. (View layers are faster, and behind after edits.)
    """
    collections = [*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes)]
    return {item for collection in collections for item in collection.objects}


def named_probes(scene: bpy.types.Scene, names: Sequence[str]) -> list[bpy.types.Object]:
    """The probes with these names.

    Raises:
        PccError: a name is not that of a probe in the scene.
    """
    known = {probe.name: probe for probe in all_probes(scene)}
    for name in names:
        if name not in known:
            listing = ", ".join(f"'{k}'" for k in known) or "none"
            raise PccError(f"no probe is called '{name}' in scene '{scene.name}'; its probes: {listing}")
    return [known[name] for name in names]


def unlocked(probes: Sequence[bpy.types.Object]) -> tuple[list[bpy.types.Object], list[str]]:
    """Those of some probes that bakes of many take, and a sentence for each that is locked and left as it is."""
    locked = [probe for probe in probes if probe.pcc_probe.locked]
    left = [f"probe '{probe.name}' is left as it is: it is locked; unlock it, or bake it by itself" for probe in locked]
    return [probe for probe in probes if probe not in locked], left


def hidden_objects(probe: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects that a probe's capture leaves out, by name: those chosen, and what it follows with all its parts."""
    settings = probe.pcc_probe
    found = {item.object.name: item.object for item in settings.hidden_objects if item.object}
    if settings.hidden_collection:
        found.update({o.name: o for o in settings.hidden_collection.all_objects})
    if settings.follow:
        parts = (settings.follow, *settings.follow.children_recursive)
        found.update({o.name: o for o in parts if o.type != "LIGHT" and not o.pcc_probe.is_probe})
    return [found[name] for name in sorted(found)]


def probe_spec(probe: bpy.types.Object) -> ProbeSpec:
    """The record of a probe, from its evaluated transform and its settings.

    Raises:
        ProbeError: its transform or settings cannot be baked.
    """
    settings = probe.pcc_probe
    return ProbeSpec(
        name=probe.name,
        box=Box.from_matrix(probe.name, _drawn_cube(probe)),
        capture_offset=tuple(settings.capture_offset),
        engine=Engine(settings.engine),
        outside=Outside(settings.outside),
        corrected=settings.correction != "NONE",
        relief=settings.correction == "RELIEF",
        hidden=tuple(o.name for o in hidden_objects(probe)),
        animated=is_animated(probe),
        source=Source(settings.source),
        picture=bpy.path.abspath(settings.picture, library=probe.library) if settings.picture else "",
        influence=_influence(settings),
        forced=forced_of_probe(probe),
        followed=tuple(settings.follow.matrix_world.translation) if settings.follow else None,
        **{name: getattr(settings, name) for name in _AS_SET},
    )


def _influence(settings: PCC_Probe) -> Influence:
    falloffs = (tuple(settings.falloff_low), tuple(settings.falloff_high)) if settings.falloff_per_face else (None,) * 2
    return Influence(
        tuple(settings.influence_low),
        tuple(settings.influence_high),
        *falloffs,
        normal_fade=settings.normal_fade,
        weight=settings.weight,
        priority=settings.priority,
        receivers=_names(settings.receivers) if settings.receivers else None,
        excluded=_names(settings.excluded) if settings.excluded else frozenset(),
    )


def _names(collection: bpy.types.Collection) -> frozenset[str]:
    return frozenset(item.name_full for item in collection.all_objects)


def check_own(probe: bpy.types.Object) -> None:
    """Refuse a probe that cannot keep a bake.

    Raises:
        ProbeError: it is a library override.
    """
    if probe.override_library is not None:
        raise ProbeError(f"probe '{probe.name}' {told_overridden(probe)}")


def told_overridden(probe: bpy.types.Object) -> str:
    """Why a library override of a probe is not baked and what to do, in words that follow its name."""
    library = probe.override_library.reference.library
    return (
        f"is a library override and cannot keep a bake; bake it in '{library.filepath}', or make it local (Object > "
        "Relations > Make Local)"
    )


def check_place(probe: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> None:
    """Refuse a probe whose place Blender does not keep up to date, since the view layer leaves it out.

    Raises:
        ProbeError: names it and says how to bring it in.
    """
    seen = probe.visible_get(view_layer=view_layer)  # which is known at once; names are looked for one by one
    if not seen and view_layer.objects.get(probe.name) != probe:
        raise ProbeError(
            f"probe '{probe.name}': view layer '{view_layer.name}' leaves its collection out, so nobody knows where it "
            "is; include the collection, or remove the probe"
        )
    followed = probe.pcc_probe.follow
    if followed is not None and view_layer.objects.get(followed.name) != followed:
        raise ProbeError(
            f"probe '{probe.name}' follows '{followed.name}', which is not in view layer '{view_layer.name}', so "
            "nobody knows where it is; include its collection, or let the probe follow something else"
        )
    if not seen and not is_animated(probe):
        parent = probe.parent.matrix_world @ probe.matrix_parent_inverse if probe.parent else Matrix()
        expected = np.array(parent @ probe.matrix_basis)
        if not np.allclose(expected, np.array(probe.matrix_world), rtol=1e-4, atol=1e-5, equal_nan=True):
            raise ProbeError(
                f"probe '{probe.name}' was moved while it is disabled in viewports, and its place is not up to date; "
                "enable it"
            )


def check_seen(probe: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> None:
    """Refuse a probe that moves, or follows what moves, where viewports leave that out: it is not moved then.

    Raises:
        ProbeError: names it and says what to do.
    """
    for item in (probe, probe.pcc_probe.follow):
        if item is not None and is_animated(item) and is_disabled(item, view_layer):
            raise ProbeError(
                f"probe '{probe.name}': '{item.name}' is animated and disabled in viewports, so nobody knows where it "
                "is at each frame; enable it"
            )


def is_disabled(item: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> bool:
    """Whether viewports leave an object out, so that animation does not move it; what is only hidden is moved."""
    kept = item.visible_get(view_layer=view_layer) or item.hide_get(view_layer=view_layer)
    return (item.hide_viewport or not kept) and item.name in view_layer.objects


def _drawn_cube(probe: bpy.types.Object) -> np.ndarray:
    """(4, 4): from [−1, 1]³ to the cube that the empty is drawn as, in world space.

    Applying the scale of an empty, or editing its size, changes what is drawn by the display size.
    """
    size = probe.empty_display_size
    return np.array(probe.matrix_world, np.float64) @ np.diag([size, size, size, 1.0])


def bake_record(probe: bpy.types.Object) -> Sidecar | None:
    """What the probe's pictures show, or None before its first bake.

    Raises:
        BakeError: the record is damaged or of a later version.
    """
    text = probe.pcc_probe.bake_record
    return _read_record(text, f"bake record of '{probe.name}'") if text else None


@lru_cache(maxsize=1024)
def _read_record(text: str, origin: str) -> Sidecar:
    """That of a sequence is long, and handlers ask for it again and again."""
    return Sidecar.from_json(text, origin)
