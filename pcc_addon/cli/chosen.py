"""Which probes a subcommand is for."""

from __future__ import annotations

import argparse

import bpy

from ..blender.read.probes import all_probes, named_probes
from ..core.errors import PccError


def chosen_probes(options: argparse.Namespace) -> list[bpy.types.Object]:
    """Those that are named, or else all of the scene.

    Raises:
        PccError: there is none, or not one of these names.
    """
    scene = bpy.context.scene
    probes = named_probes(scene, options.probe) if options.probe else all_probes(scene)
    if not probes:
        raise PccError(f"scene '{scene.name}' has no parallax probe; add one with Add > Light Probe > Parallax Probe")
    return probes
