"""Adds all that artists see to Blender, and takes it away again."""

from __future__ import annotations

import bpy

from . import (
    by_hand,
    cost,
    cost_results,
    effects,
    fitting,
    interior,
    last_misfit,
    last_plan,
    misfit,
    misfit_view,
    operators,
    panels,
    picture,
    plan,
    presets,
)

_WITH_CLASSES = (
    operators, fitting, picture, presets, plan, interior, by_hand, panels, effects, cost, cost_results, misfit
)  # fmt: skip
"""In this order, which is that of panels."""


def _classes() -> list[type]:
    return [cls for module in _WITH_CLASSES for cls in module.CLASSES]


def register() -> None:
    for cls in _classes():
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_lightprobe_add.append(panels.draw_add_menu)
    bpy.types.VIEW3D_MT_lightprobe_add.append(interior.draw_add_menu)
    bpy.types.NODE_MT_shader_node_add_all.append(by_hand.draw_add_menu)
    last_plan.register()
    last_misfit.register()
    misfit_view.register()


def unregister() -> None:
    misfit_view.unregister()
    last_misfit.unregister()
    last_plan.unregister()
    bpy.types.NODE_MT_shader_node_add_all.remove(by_hand.draw_add_menu)
    bpy.types.VIEW3D_MT_lightprobe_add.remove(interior.draw_add_menu)
    bpy.types.VIEW3D_MT_lightprobe_add.remove(panels.draw_add_menu)
    for cls in reversed(_classes()):
        bpy.utils.unregister_class(cls)
