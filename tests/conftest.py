"""Fixtures and markers that all tests share."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    import bpy

# Property tests draw the same examples in every run and leave no files. `--hypothesis-profile thorough` looks longer.
settings.register_profile("default", deadline=None, derandomize=True, database=None)
settings.register_profile("thorough", deadline=None, derandomize=True, database=None, max_examples=100_000)
settings.load_profile("default")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--heavy", action="store_true", help="run the tests that take minutes too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--heavy"):
        return
    skip = pytest.mark.skip(reason="takes minutes: run with --heavy, as CI does")
    for item in items:
        if "heavy" in item.keywords:
            item.add_marker(skip)


_exit_status = 0


def pytest_sessionfinish(exitstatus: int) -> None:
    global _exit_status
    _exit_status = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure() -> None:
    """Blender 4.5 as a module can wait for itself for ever when it frees what hundreds of renders left: leave first."""
    bpy = sys.modules.get("bpy")
    if bpy is not None and bpy.app.version < (5, 0):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_exit_status)


@pytest.fixture(scope="session")
def addon() -> Iterator[None]:
    """The add-on, registered in this process's Blender."""
    import pcc_addon

    pcc_addon.register()
    yield
    pcc_addon.unregister()


@pytest.fixture
def scene(addon: None) -> bpy.types.Scene:
    """An empty scene in a new, unsaved file."""
    from sample_blends.scenes import empty_scene

    return empty_scene()
