"""All rows: each file of them fills the table."""

from __future__ import annotations

from tests.blender.stale import images, lights, materials, meshes, modifiers, names, objects, settings, shapes, unseen
from tests.blender.stale.rows import ROWS, Row

FILES = (meshes, modifiers, shapes, objects, materials, images, lights, settings, names, unseen)

__all__ = ["FILES", "ROWS", "Row"]
