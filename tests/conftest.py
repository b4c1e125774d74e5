"""Fixtures and markers that all tests share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import settings

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


@pytest.fixture(scope="session")
def addon() -> Iterator[None]:
    """The add-on, registered in this process's Blender."""
    import pcc_addon

    pcc_addon.register()
    yield
    pcc_addon.unregister()
