"""Fixtures and markers that all tests share."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from zlib import crc32

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    import bpy

# Property tests draw the same examples in every run and leave no files. `--hypothesis-profile thorough` looks longer.
settings.register_profile("default", deadline=None, derandomize=True, database=None)
settings.register_profile("thorough", deadline=None, derandomize=True, database=None, max_examples=100_000)
settings.load_profile("default")


WITHOUT_BLENDER = ("core", "glsl", "mutation", "vectors")  # folders; elsewhere the marker says it
ONE_OF = 4  # cases of a sweep is run, unless all are asked for


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--heavy", action="store_true", help="run the tests that take minutes too")
    parser.addoption(
        "--sweeps",
        metavar="K|all",
        help="which cases of sweeps: every fourth from the K-th on; default 0, or with --heavy all",
    )
    parser.addoption("--part", default="0/1", metavar="K/N", help="the K-th of N parts of the tests")
    parser.addoption("--only-with-blender", action="store_true", help="leave out what every Blender answers alike")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        if _folder(item) in WITHOUT_BLENDER:
            item.add_marker("without_blender")
        if "without_blender" in item.keywords and "addon" in item.fixturenames:
            raise pytest.UsageError(f"{item.nodeid} has Blender's add-on and says that it needs no Blender")
    if config.getoption("--only-with-blender"):
        left_out = [item for item in items if "without_blender" in item.keywords]
        items[:] = [item for item in items if "without_blender" not in item.keywords]
        config.hook.pytest_deselected(items=left_out)
    part, parts = map(int, config.getoption("--part").split("/"))
    sweeps = config.getoption("--sweeps") or ("all" if config.getoption("--heavy") else "0")
    cases: Counter[str] = Counter()
    for item in items:
        test = item.nodeid.partition("[")[0]
        is_case = "sweep" in item.keywords and sweeps != "all"
        another = is_case and (cases[test] - int(sweeps)) % ONE_OF != 0
        cases[test] += is_case
        if "heavy" in item.keywords and not config.getoption("--heavy"):
            item.add_marker(pytest.mark.skip(reason="is heavy: run with --heavy, as CI does"))
        elif another:
            item.add_marker(pytest.mark.skip(reason="is another case of a sweep: run with --sweeps all"))
        elif crc32(item.nodeid.encode()) % parts != part % parts:
            item.add_marker(pytest.mark.skip(reason=f"is not in part {part} of {parts}"))


def _folder(item: pytest.Item) -> str:
    return item.path.relative_to(Path(__file__).parent).parts[0]


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Name what failed at once: where Blender itself ends, nothing sums it up."""
    if report.failed:
        print(f"\nFAILED {report.nodeid} ({report.when})", flush=True)


_exit_status = 0


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    global _exit_status
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and session.config.getoption("--only-with-blender"):
        session.exitstatus = exitstatus = 0  # `dev.py test --all tests/core`: another Blender runs them
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
