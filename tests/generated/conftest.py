"""These tests run where bpy can be imported; no window is needed."""

from __future__ import annotations

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")


@pytest.fixture(autouse=True)
def _registered(addon: None) -> None:
    """Every test here has the add-on."""
