"""Parallax Probes: box probes whose one bake reflects a room with the right parallax, in Cycles and in EEVEE."""

from __future__ import annotations


def register() -> None:
    """Add the add-on's types, operators, menus, handlers and shell command to Blender."""
    import bpy

    from .blender import handlers, properties
    from .ui import (
        by_hand,
        cost,
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

    properties.register()
    for cls in (
        *operators.CLASSES,
        *fitting.CLASSES,
        *picture.CLASSES,
        *presets.CLASSES,
        *plan.CLASSES,
        *interior.CLASSES,
        *by_hand.CLASSES,
        *panels.CLASSES,
        *effects.CLASSES,
        *cost.CLASSES,
        *misfit.CLASSES,
    ):
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_lightprobe_add.append(panels.draw_add_menu)
    bpy.types.VIEW3D_MT_lightprobe_add.append(interior.draw_add_menu)
    bpy.types.NODE_MT_shader_node_add_all.append(by_hand.draw_add_menu)
    handlers.register()
    last_plan.register()
    last_misfit.register()
    misfit_view.register()
    _shell_command(register=True)


def unregister() -> None:
    """Take everything back that `register` added."""
    import bpy

    from .blender import handlers, properties
    from .ui import (
        by_hand,
        cost,
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

    _shell_command(register=False)
    misfit_view.unregister()
    last_misfit.unregister()
    last_plan.unregister()
    handlers.unregister()
    bpy.types.NODE_MT_shader_node_add_all.remove(by_hand.draw_add_menu)
    bpy.types.VIEW3D_MT_lightprobe_add.remove(interior.draw_add_menu)
    bpy.types.VIEW3D_MT_lightprobe_add.remove(panels.draw_add_menu)
    for cls in reversed(
        (
            *operators.CLASSES,
            *fitting.CLASSES,
            *picture.CLASSES,
            *presets.CLASSES,
            *plan.CLASSES,
            *interior.CLASSES,
            *by_hand.CLASSES,
            *panels.CLASSES,
            *effects.CLASSES,
            *cost.CLASSES,
            *misfit.CLASSES,
        )
    ):
        bpy.utils.unregister_class(cls)
    properties.unregister()


_command: object = None


def _shell_command(*, register: bool) -> None:
    """Add or remove `blender --command pcc`."""
    import bpy

    from . import cli

    global _command
    if register:
        _command = bpy.utils.register_cli_command("pcc", cli.run_in_blender)
    else:
        bpy.utils.unregister_cli_command(_command)
        _command = None
