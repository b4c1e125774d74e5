"""These tests run node groups in Blender as a module; no window is needed."""

from __future__ import annotations

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")
