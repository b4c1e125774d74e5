"""Parallax Probes: box probes whose one bake reflects a room with the right parallax, in Cycles and in EEVEE."""

from __future__ import annotations


def register() -> None:
    """Add the add-on's types, operators, menus, handlers and shell command to Blender."""
    from .blender import handlers, judging, properties
    from .ui import registering

    properties.register()
    registering.register()
    handlers.register()
    judging.register()
    _shell_command(register=True)


def unregister() -> None:
    """Take everything back that `register` added."""
    from .blender import handlers, judging, properties
    from .ui import registering

    _shell_command(register=False)
    judging.unregister()
    handlers.unregister()
    registering.unregister()
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
