"""The selected probes in the viewport: box, influence, falloff and capture point, before whatever is behind them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import gpu
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from ...blender.read.probes import probe_spec
from ...core.errors import PccError
from ...core.probe import ProbeSpec
from ..kept.redrawing import redraw
from . import probe_shapes

_NEARER = 0.998  # of the distance: lines on a wall are drawn before it
_THROUGH = 0.3  # opacity of what something hides
_WIDTH, _RIM = 1.5, 1.5  # pixels: of a line, and of its dark rim to each side
_RIM_OPACITY = 0.35


@dataclass(frozen=True, eq=False)
class _Drawn:
    """What the graphics card has of a probe, made once: a batch for each colour."""

    spec: ProbeSpec
    box: gpu.types.GPUBatch
    influence: gpu.types.GPUBatch | None
    capture_point: gpu.types.GPUBatch


_drawn: dict[str, _Drawn] = {}  # by the probe's name
_handle: object = None


def draw() -> None:
    """Draw the probes that are selected, unless overlays are off."""
    context = bpy.context
    overlay = context.space_data.overlay
    shown = list(_shown(context)) if overlay.show_overlays and context.window_manager.pcc_show_probes else []
    for name in set(_drawn) - {spec.name for spec in shown}:
        del _drawn[name]
    if not shown:
        return
    before = gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()
    gpu.state.depth_mask_set(False)
    gpu.state.blend_set("ALPHA")
    try:
        with gpu.matrix.push_pop():
            _draw_nearer(context.region_data)
            for spec in shown:
                _draw_one(context, _batches(spec))
    finally:
        gpu.state.depth_test_set(before[0])
        gpu.state.depth_mask_set(before[1])
        gpu.state.blend_set(before[2])


def _shown(context: bpy.types.Context) -> Iterator[ProbeSpec]:
    for item in context.selected_objects:
        if item.pcc_probe.is_probe and item.visible_in_viewport_get(context.space_data):
            try:
                yield probe_spec(item)
            except PccError:  # a box without volume, in passing or for good: its bake says so
                continue


def _draw_nearer(view: bpy.types.RegionView3D) -> None:
    """Bring what is drawn nearer to the eye, where that moves nothing on the screen."""
    if view.is_perspective:
        nearer = Matrix.Scale(_NEARER, 4)
    else:
        nearer = Matrix.Translation((0.0, 0.0, (1.0 - _NEARER) * view.view_distance))
    gpu.matrix.load_matrix(nearer @ view.view_matrix)


def _draw_one(context: bpy.types.Context, drawn: _Drawn) -> None:
    theme = context.preferences.themes[0]
    colours = theme.user_interface.gizmo_secondary, theme.view_3d.object_active, theme.user_interface.gizmo_primary
    batches = drawn.influence, drawn.box, drawn.capture_point  # the box over an influence that is as large
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    scale = context.preferences.system.ui_scale
    for width, strength, rim in ((_WIDTH + 2.0 * _RIM, _RIM_OPACITY, True), (_WIDTH, 1.0, False)):
        shader.uniform_float("lineWidth", width * scale)
        for depth, opacity in (("NONE", _THROUGH), ("LESS_EQUAL", 1.0)):
            gpu.state.depth_test_set(depth)
            for colour, batch in zip(colours, batches, strict=True):
                if batch is not None:
                    shader.uniform_float("color", (*((0.0,) * 3 if rim else colour[:3]), strength * opacity))
                    batch.draw(shader)


def _batches(spec: ProbeSpec) -> _Drawn:
    kept = _drawn.get(spec.name)
    if kept is None or kept.spec != spec:
        kept = _drawn[spec.name] = _made(spec)
    return kept


def _made(spec: ProbeSpec) -> _Drawn:
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    around = [*probe_shapes.influence(spec), *probe_shapes.falloff(spec)]
    return _Drawn(
        spec,
        batch_for_shader(shader, "LINES", {"pos": probe_shapes.box(spec)}),
        batch_for_shader(shader, "LINES", {"pos": around}) if around else None,
        batch_for_shader(shader, "LINES", {"pos": probe_shapes.capture_point(spec)}),
    )


def _draw_choice(self: bpy.types.Panel, context: bpy.types.Context) -> None:
    self.layout.prop(context.window_manager, "pcc_show_probes")


def register() -> None:
    global _handle
    bpy.types.WindowManager.pcc_show_probes = bpy.props.BoolProperty(
        name="Parallax Probes",
        description="Draw the box, the influence with its falloff, and the capture point of selected parallax probes",
        default=True,
        update=lambda manager, context: redraw(),
    )
    bpy.types.VIEW3D_PT_overlay_object.append(_draw_choice)
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _drawn.clear()
    bpy.types.VIEW3D_PT_overlay_object.remove(_draw_choice)
    del bpy.types.WindowManager.pcc_show_probes
