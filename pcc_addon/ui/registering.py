"""Adds all that artists see to Blender, and takes it away again."""

from __future__ import annotations

import bpy

from . import manual, menus
from .kept import idle, last_misfit, last_plan, running_bake, thumbnails
from .operators import (
    bake,
    by_hand,
    copy_settings,
    cost,
    cost_show,
    drag,
    export,
    fit,
    hidden,
    inject,
    interior,
    judge,
    misfit,
    picture,
    plan,
    presets,
    probe_add,
    select,
    state,
)
from .operators import manual as manual_operator
from .panels import (
    accuracy,
    box,
    capture,
    influence,
    judging,
    material,
    probe,
    probe_effects,
    probe_list,
    progress,
    result,
    scene,
    scene_accuracy,
    scene_materials,
    scene_settings,
    scene_windows,
)
from .panels import fit as fit_panel
from .panels import hidden as hidden_panel
from .panels import interior as interior_panel
from .panels import object as object_panel
from .panels import presets as presets_panel
from .viewport import handles, probes
from .viewport import misfit as misfit_view

_OPERATORS = (
    probe_add, drag, bake, inject, hidden, fit, picture, presets, plan, interior, by_hand, cost, cost_show, misfit,
    copy_settings, select, state, judge, export, manual_operator
)  # fmt: skip
_PANELS = (
    presets_panel, probe, box, capture, hidden_panel, influence, result, probe_list, scene, scene_materials,
    scene_accuracy, scene_windows, judging, interior_panel, probe_effects, material, object_panel, accuracy,
    fit_panel, scene_settings
)  # fmt: skip
"""In the order in which they are shown."""


def _classes() -> list[type]:
    return [cls for module in (*_OPERATORS, menus, *_PANELS, handles) for cls in module.CLASSES]


def register() -> None:
    for cls in _classes():
        bpy.utils.register_class(cls)
    menus.register()
    manual.register()
    probe_list.register()
    last_plan.register()
    idle.register()
    thumbnails.register()
    last_misfit.register()
    running_bake.register()
    progress.register()
    misfit_view.register()
    probes.register()
    judging.register()


def unregister() -> None:
    judging.unregister()
    probes.unregister()
    misfit_view.unregister()
    progress.unregister()
    running_bake.unregister()
    last_misfit.unregister()
    thumbnails.unregister()
    idle.unregister()
    last_plan.unregister()
    probe_list.unregister()
    manual.unregister()
    menus.unregister()
    for cls in reversed(_classes()):
        bpy.utils.unregister_class(cls)
