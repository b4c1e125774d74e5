"""Which of Blender's updates are changes of what plans and bakes depend on."""

from __future__ import annotations

import bpy


def may_matter(depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an update may change a plan or a bake; another selection does not.

    Whatever is deleted changes its collection.
    """
    return any(u.is_updated_geometry or u.is_updated_transform or u.is_updated_shading for u in depsgraph.updates)
