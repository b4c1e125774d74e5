"""Which pixels of the camera's picture a probe serves: those at whose middle the first surface shows it."""

from __future__ import annotations

from contextlib import ExitStack

import bpy
import numpy as np

from ...core.errors import BakeError
from ...core.probe import Engine
from .. import handlers, rendering
from ..overrides import override
from ..read.nodes import group_output
from ..shade.probe_group import shown_levels

_RADIANCE = 1e6  # of the white pictures: far above what lamps do, of which a render rounds away a part
_LEAST = 1e-3  # of that radiance, from which on a surface shows the probe
_ROUNDING = 1e-6  # of what is there without it


def served_pixels(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probe: bpy.types.Object, width: int, height: int
) -> np.ndarray:
    """(height, width) bool, row 0 at the bottom: where the probe adds to what the scene's camera sees first.

    The materials must show the probe. Its pictures are made black, then white, and nothing scatters light meanwhile:
    what differs shows the probe, whoever decides so (materials, influence, other probes over it). Depth of field and
    motion blur are left out.

    Raises:
        BakeError: the probe has no bake, or the scene cannot be rendered.
        Cancelled: the user stopped a render.
    """
    if probe.pcc_probe.group is None:
        raise BakeError(f"probe '{probe.name}' has no bake; bake it first")
    with ExitStack() as stack:
        stack.enter_context(handlers.paused())
        for owner, name, value in (
            (scene.cycles, "max_bounces", 0),
            (scene.cycles, "sample_clamp_direct", 0.0),
            (scene.cycles, "pixel_filter_type", "BOX"),
            (scene.cycles, "filter_width", 0.01),
            (scene.cycles, "use_adaptive_sampling", False),
            (scene.render, "use_motion_blur", False),
            (scene.camera.data.dof, "use_dof", False),
        ):
            override(stack, owner, name, value)
        seen = []
        for radiance in (0.0, _RADIANCE):
            with ExitStack() as shown:
                _show(shown, probe, radiance)
                settings = rendering.RenderSettings(Engine.CYCLES, 1, False, width, height)
                seen.append(rendering.render(scene, settings, view_layer).pixels.astype(np.float64))
    black, white = seen
    return (white - black).sum(-1) > _LEAST * _RADIANCE + _ROUNDING * np.abs(black).sum(-1)


def _show(stack: ExitStack, probe: bpy.types.Object, radiance: float) -> None:
    """Let a probe show one radiance to the camera's rays, and nothing to others, until `stack` closes.

    With no bounces a renderer still asks what the next surface emits, which would light what mirrors the probe's own.
    """
    tree = probe.pcc_probe.group
    path, factor = (tree.nodes.new(kind) for kind in ("ShaderNodeLightPath", "ShaderNodeMath"))
    factor.operation, factor.inputs[1].default_value = "MULTIPLY", radiance
    _, images, _ = shown_levels(probe)
    for socket in group_output(tree).inputs:
        if socket.name in images:
            (link,) = socket.links
            stack.callback(tree.links.new, link.from_socket, socket)
            tree.links.new(factor.outputs[0], socket)
    tree.links.new(path.outputs["Is Camera Ray"], factor.inputs[0])
    for node in (path, factor):
        stack.callback(tree.nodes.remove, node)
