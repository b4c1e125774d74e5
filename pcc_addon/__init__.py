"""Parallax Probes: box probes whose one bake reflects a room with the right parallax, in Cycles and in EEVEE."""


def register() -> None:
    """Add the add-on's types, operators, menus and shell command to Blender."""
    from .blender import properties

    properties.register()


def unregister() -> None:
    """Take everything back that `register` added."""
    from .blender import properties

    properties.unregister()
