"""A scene rendered with the effects that it needs, and with all that must not change its picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import bpy
import numpy as np

from pcc_addon.blender import handlers, properties
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.shade.injection import inject
from pcc_addon.blender.status import statuses
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.blender.store.pictures import read_pixels
from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.core.decisions import OF_MATERIALS, OF_PROBES, Effect
from pcc_addon.core.probe import Engine

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
    said = {status.probe: status.words for status in statuses(scene, layer) if status.outdated or status.state != "baked"}
    assert not said, said


def baked() -> Pictures:
    """The pictures of all probes, by the probe's name and roughness."""
    found = {}
    for item in bpy.context.scene.objects:
        if item.pcc_probe.is_probe:
            for level in item.pcc_probe.levels:
                found[item.name, round(level.roughness, 4)] = read_pixels(level.image).copy()
    return found


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
        pictures: probes' pictures of the first bake; `whole_pictures`, with all effects of probes;
            `on_pictures`, with those of materials too.
    """

    pruned: np.ndarray
    whole: np.ndarray
    pictures: Pictures
    whole_pictures: Pictures
    on_pictures: Pictures

    @property
    def difference(self) -> np.ndarray:
        """(frames, h, w, 3): of the brighter of the pixel and the picture's mean."""
        floor = max(self.whole.mean(), 1e-6)
        return np.abs(self.pruned - self.whole) / np.maximum(np.abs(self.whole), floor)
