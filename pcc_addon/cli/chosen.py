"""Which probes a subcommand is for."""

from __future__ import annotations

import argparse

import bpy

from ..blender.read.probes import all_probes, named_probes
from ..core.errors import PccError
from ..core.words import named


def chosen_scene(options: argparse.Namespace) -> bpy.types.Scene:
    """The one that is named, or else the file's.

    Raises:
        PccError: there is none of this name.
    """
    return _named(bpy.data.scenes, "scene", getattr(options, "scene", None)) or bpy.context.scene


def chosen_view_layer(options: argparse.Namespace) -> bpy.types.ViewLayer:
    """The one of the chosen scene that is named; or else the file's, or the first of another scene.

    Raises:
        PccError: there is none of this name.
    """
    scene = chosen_scene(options)
    shown = bpy.context.view_layer if scene == bpy.context.scene else scene.view_layers[0]
    return _named(scene.view_layers, "view layer", options.view_layer) or shown


def _named(among: bpy.types.bpy_prop_collection, kind: str, name: str | None) -> bpy.types.bpy_struct | None:
    """What has a name; None where none is asked for."""
    if name is not None and name not in among:
        raise PccError(f"no {kind} is called '{name}'; there are {named(sorted(each.name for each in among))}")
    return among[name] if name is not None else None


def chosen_probes(options: argparse.Namespace) -> list[bpy.types.Object]:
    """Those that are named, or else all of the scene.

    Raises:
        PccError: there is none, or not one of these names.
    """
    scene = chosen_scene(options)
    probes = named_probes(scene, options.probe) if options.probe else all_probes(scene)
    if not probes:
        raise PccError(f"scene '{scene.name}' has no parallax probe; add one with Add > Light Probe > Parallax Probe")
    return probes
