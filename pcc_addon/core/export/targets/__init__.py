"""The engines, a file each."""

from __future__ import annotations

from ..target import Target
from . import babylon, generic, godot, playcanvas, three, unity, unreal

TARGETS: tuple[Target, ...] = tuple(
    module.TARGET for module in (three, babylon, playcanvas, godot, unity, unreal, generic)
)


def target_of(key: str) -> Target:
    """The engine of a name in commands."""
    return next(target for target in TARGETS if target.key == key)
