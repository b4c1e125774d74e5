"""Keeps shaders right while an artist moves probes."""

from __future__ import annotations

import bpy

from ..core.errors import PccError
from .read.probes import bake_record, probe_spec
from .shade import probe_group


@bpy.app.handlers.persistent
def on_depsgraph_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Give a probe that was moved the lookup that holds wherever it is now; the next injection specialises it again.

    Drivers follow the box; what they cannot follow is that it was unrotated, held all surfaces or was captured from its
    centre, and how far from the origin it stands. Animation does not call this: `ProbeSpec.effects` knows of it.
    """
    for update in depsgraph.updates:
        probe = update.id.original
        if not update.is_updated_transform or not isinstance(probe, bpy.types.Object):
            continue
        if not probe.pcc_probe.is_probe or probe.library or probe.pcc_probe.group is None:
            continue
        if not probe_group.was_moved(probe):
            continue
        try:
            record, spec = bake_record(probe), probe_spec(probe)
            if record is None:
                continue
            needed = spec.effects(all_inside=False, captured_at=record.capture_point)
            if probe_group.shown_effects(probe.pcc_probe.group) != needed.label:
                probe_group.refresh_group(probe)
            else:
                probe_group.set_padding(probe.pcc_probe.group, spec.influence_padding)
        except PccError:  # a transform in passing, such as a scale of 0; the bake reports one that stays
            continue


def register() -> None:
    bpy.app.handlers.depsgraph_update_post.append(on_depsgraph_update)


def unregister() -> None:
    bpy.app.handlers.depsgraph_update_post.remove(on_depsgraph_update)
