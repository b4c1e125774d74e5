"""Tests of the shell command: in this process where only answers matter, in one of its own where exits do."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")


@pytest.fixture(scope="session", autouse=True)
def addon() -> Iterator[None]:
    """The add-on, registered for the whole session."""
    import pcc_addon

    pcc_addon.register()
    yield
    pcc_addon.unregister()


@pytest.fixture
def scene() -> bpy.types.Scene:
    """An empty scene in a new, unsaved file."""
    from sample_blends.scenes import empty_scene

    return empty_scene()
