"""These tests run node groups in Blender as a module."""

from __future__ import annotations

import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")


@pytest.fixture(autouse=True)
def _registered(addon: None) -> None:
    """Every test here has the add-on."""


@pytest.fixture
def scene() -> bpy.types.Scene:
    """An empty scene in a new, unsaved file."""
    from sample_blends.scenes import empty_scene

    return empty_scene()
