"""A scene rendered with the effects that it needs, and with all that must not change its picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from pcc_addon.blender import handlers, properties
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.blender.shade.injection import inject
from pcc_addon.blender.status import statuses
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.blender.store.pictures import read_pixels, write_file
from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACE_NAMES, find_faces
from pcc_addon.core.decisions import OF_MATERIALS, OF_PROBES, Effect
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.probe import Engine

from .build import FRAMES

Pictures = dict[tuple[str, float], np.ndarray]
LOSSLESS = frozenset(effect for effect in Effect if effect.lossless)


def force(effects: Iterable[Effect], state: str = "ON") -> None:
    """Let an artist decide about some effects, for all probes and materials."""
    chosen = set(effects)
    listeners, properties.shader_listeners[:] = list(properties.shader_listeners), []
    with handlers.paused():  # the injection builds all of it, once
        for item in bpy.context.scene.objects:
            for effect in chosen.intersection(OF_PROBES) if item.pcc_probe.is_probe else ():
                setattr(item.pcc_probe.effects, effect.key, state)
        for material in bpy.data.materials:
            for effect in chosen.intersection(OF_MATERIALS):
                setattr(material.pcc.effects, effect.key, state)
        bpy.context.view_layer.update()
    properties.shader_listeners[:] = listeners


def bake_all() -> None:
    """Bake all probes of the scene."""
    scene = bpy.context.scene
    probes = [item for item in scene.objects if item.pcc_probe.is_probe]
    results = BakeJob(scene, bpy.context.view_layer, probes, bake_folder(scene)).run()
    errors = [result.error for result in results if result.error]
    assert not errors, errors


def put_in() -> None:
    """Inject, after which nothing may be left to do."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    inject(scene, layer)
    layer.update()
    said = {
        status.probe: status.words for status in statuses(scene, layer) if status.outdated or status.state != "baked"
    }
    assert not said, said


def baked() -> Pictures:
    """The pictures of all probes, by the probe's name and roughness.

    Where faces were left out captures are NaN, and what is blurred of them, which mixes guesses, is missing.
    """
    found = {}
    for item in bpy.context.scene.objects:
        if item.pcc_probe.is_probe:
            lacking = bake_record(item).lacks(FACE_NAMES)
            for level in item.pcc_probe.levels if not lacking else item.pcc_probe.levels[:1]:
                picture = read_pixels(level.image).copy()
                picture[np.isin(faces_of(picture), [FACE_NAMES.index(name) for name in lacking])] = np.nan
                found[item.name, round(level.roughness, 4)] = picture
    return found


def faces_of(picture: np.ndarray) -> np.ndarray:
    """(h, 2h) int: in which of `FACES` each texel of an equirectangular picture lies."""
    height = len(picture)
    found = np.empty(2 * height * height, int)
    for k, chosen, _, _ in find_faces(equirect.directions(2 * height, height).reshape(-1, 3)):
        found[chosen] = k
    return found.reshape(height, 2 * height)


def seen(frames: Iterable[int], engine: Engine = Engine.CYCLES, samples: int | None = None) -> np.ndarray:
    """(frames, h, w, 3): what the scene's camera sees."""
    scene, pictures, before = bpy.context.scene, [], bpy.context.scene.frame_current
    for frame in frames:
        if frame != scene.frame_current:
            scene.frame_set(frame)
        pictures.append(render(scene, RenderSettings(engine, samples)).pixels.astype(np.float64))
    if scene.frame_current != before:
        scene.frame_set(before)
    return np.array(pictures)


@dataclass(frozen=True)
class Comparison:
    """What everything on changes.

    Attributes:
        pruned, whole: (frames, h, w, 3) what is seen with the effects that are needed, and with all.
        pictures, all_pictures: the probes' pictures of either bake.
        probe_pictures: those of a bake with all effects of probes, and those of materials as they are needed.
    """

    pruned: np.ndarray
    whole: np.ndarray
    pictures: Pictures
    all_pictures: Pictures
    probe_pictures: Pictures

    @property
    def difference(self) -> np.ndarray:
        """(frames, h, w, 3): absolute."""
        return np.abs(self.pruned - self.whole)

    @property
    def relative(self) -> float:
        """The largest difference, over the brighter of its pixel and the picture's mean."""
        return float((self.difference / np.maximum(self._scale, 1e-30)).max())

    @property
    def allowed(self) -> np.ndarray:
        """(frames, h, w, 3): what arithmetic in single precision may change.

        That is `TOLERANCE`, and what summing all levels rounds. It starts from the sharpest and adds the steps to the
        next ones: each of `STEPS` steps rounds a difference, a product and a sum, none of them above the brightest
        texel L of the pictures, by half an ulp of L. A surface sends no more than that to the eye.
        """
        brightest = max((float(picture.max()) for picture in self.all_pictures.values()), default=0.0)
        return TOLERANCE * self._scale + 3.0 * STEPS * _HALF_ULP * brightest

    @property
    def steepest(self) -> float:
        """How much radiance a radian of the sharpest pictures may change at most."""
        sharp = [picture for (_, roughness), picture in self.all_pictures.items() if roughness == 0.0]
        steps = [np.abs(np.diff(one, axis=axis)).max() * len(one) / np.pi for one in sharp for axis in (0, 1)]
        return float(max(steps, default=0.0)) * 2.0**0.5

    @property
    def _scale(self) -> np.ndarray:
        return np.maximum(np.abs(self.whole), self.whole.mean())

    @property
    def changed_pictures(self) -> list[tuple[str, float]]:
        """Those of the first bake that are not bit for bit the same, or not there, with all effects of probes.

        Captures show what surfaces leave to their diffuse base, which effects of materials round otherwise.
        """
        return changed(self.pictures, self.probe_pictures)

    @property
    def rounded_pictures(self) -> float:
        """How far those of the first bake are from those of the second, over the brighter of a texel and the mean."""
        errors = [0.0]
        for key, one in self.pictures.items():
            other = self.all_pictures[key]
            scale = np.maximum(np.abs(other), other.mean())
            errors.append(float(np.nanmax(np.abs(one - other) / np.maximum(scale, 1e-30))))
        return max(errors)

    def write(self, folder: Path) -> None:
        """Both pictures and their difference as EXR files, a file for each frame."""
        for name, pictures in (("pruned", self.pruned), ("whole", self.whole), ("difference", self.difference)):
            for k, picture in enumerate(pictures):
                write_file(folder / f"{name} {k}.exr", picture.astype(np.float32))


TOLERANCE = 1e-5
STEPS = len(LADDER) - 1
_HALF_ULP = 2.0**-24


def compare(
    frames: Iterable[int] = FRAMES[:1], engine: Engine = Engine.CYCLES, samples: int | None = None
) -> Comparison:
    """Bake, inject and render the scene that is there as it needs it, then with everything on that must not matter."""
    frames = tuple(frames)
    bake_all()
    put_in()
    pruned, pictures = seen(frames, engine, samples), baked()
    force(LOSSLESS)
    for item in bpy.context.scene.objects:
        if item.pcc_probe.is_probe and item.pcc_probe.contact_hardening:
            item.pcc_probe.effects.hardening = "ON"  # mirrors are as sharp with it
    bake_all()
    put_in()
    check_all_on()
    whole, all_pictures = seen(frames, engine, samples), baked()
    probe_pictures = all_pictures
    if changed(pictures, all_pictures):
        force(OF_MATERIALS, "AUTO")
        put_in()
        bake_all()
        probe_pictures = baked()
    return Comparison(pruned, whole, pictures, all_pictures, probe_pictures)


def changed(some: Pictures, others: Pictures) -> list[tuple[str, float]]:
    """The pictures that are not there, or not bit for bit the same where they have texels, among others."""
    found = []
    for key, one in some.items():
        there = ~np.isnan(one)
        if key not in others or not np.array_equal(one[there], others[key][there]):
            found.append(key)
    return found


def check_all_on() -> None:
    """Whatever is lossless and could be decided is on."""
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    decisions = [(probe.probe, decision) for probe in plan.probes for decision in probe.decisions]
    for material in plan.materials:
        served = material.served.values()
        decisions += [(material.material, d) for surface in served for d in surface.decisions if d.effect in _ALWAYS]
    off = [(name, d) for name, d in decisions if d.effect in LOSSLESS and not d.on]
    assert not off, off


_ALWAYS = {Effect.METAL, Effect.TINT, Effect.ROUGHNESS}
"""Effects of materials that any surface has that could have them; one without a specular level has no dielectric."""
