"""What a new bake of a probe is shown by."""

from __future__ import annotations

import bpy

from ...core.lookup_plan import Receivers
from ..shade import by_hand, interior
from ..shade.probe_group import refresh_group


def show(probe: bpy.types.Object, receivers: Receivers, shares: bool) -> None:
    """Let everything that shows a probe show its new bake; the arguments are those of its plan.

    Raises:
        PccError: the probe's transform, its record or a picture is faulty.
    """
    refresh_group(probe, receivers, shares or None)  # twins may choose until the next injection
    interior.follow_bake(probe)
    by_hand.refresh(probe)


def files_of(probe: bpy.types.Object) -> tuple[str, ...]:
    """The paths of a probe's pictures that are files, of a sequence the first of each level."""
    images = [level.image for level in probe.pcc_probe.levels]
    return tuple(bpy.path.abspath(image.filepath) for image in images if not image.packed_file)
