"""Which objects renders show, by the collections that they are in."""

from __future__ import annotations

from collections.abc import Iterator

import bpy


def rendered(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Iterator[bpy.types.Object]:
    """The objects of a view layer's collections that renders show, each once, and those of the scenes behind it."""
    seen: set[int] = set()
    scenes = {scene.as_pointer()}
    layers = [view_layer.layer_collection]
    while layers:
        layer = layers.pop()
        hidden = layer.collection.hide_render
        if not hidden:
            layers += layer.children
        for item in () if hidden or layer.exclude else layer.collection.objects:
            if item.as_pointer() not in seen:
                seen.add(item.as_pointer())
                yield item
        behind = scene.background_set
        if not layers and behind is not None and behind.as_pointer() not in scenes:
            scenes.add(behind.as_pointer())
            scene = behind
            layers.append(behind.view_layers[0].layer_collection)


def of_collection(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """The objects of a collection and of those in it, each once, without what renders leave out."""
    found: dict[int, bpy.types.Object] = {}
    waiting = [collection]
    while waiting:
        each = waiting.pop()
        if not each.hide_render:
            found.update({item.as_pointer(): item for item in each.objects})
            waiting += each.children
    return list(found.values())
