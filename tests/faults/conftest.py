"""These tests run where bpy can be imported; the sum of all faults is printed at the end."""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")

from . import hall, tally


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    told = tally.lines()
    if told:
        terminalreporter.section("faults")
    for line in told:
        terminalreporter.line(line)


@pytest.fixture(autouse=True)
def _registered(addon: None) -> None:
    """Every test here has the add-on."""


@pytest.fixture(scope="session")
def built(addon: None, tmp_path_factory: pytest.TempPathFactory) -> hall.Hall:
    """A saved, baked and injected hall whose wall was painted since; not to be changed."""
    return hall.build(tmp_path_factory.mktemp("hall"))


@pytest.fixture
def place(built: hall.Hall, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> hall.Hall:
    """A copy of it for one test, with a folder for temporary files of its own."""
    copy = built.copied_to(tmp_path / "place")
    monkeypatch.setattr(tempfile, "tempdir", str(copy.temporary))
    return copy


@pytest.fixture
def mounted(tmp_path: Path) -> Iterator[object]:
    """`mounted(options)` is a small disk in memory; only root on Linux can make one."""
    disks: list[Path] = []

    def mount(options: str) -> Path:
        if os.name != "posix" or os.geteuid() != 0:
            pytest.skip("mounting a small disk needs root on Linux")
        disk = tmp_path / f"disk-{len(disks)}"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(disk)]
        if subprocess.run(command, capture_output=True).returncode:
            pytest.skip("this system does not let us mount a tmpfs")
        disks.append(disk)
        return disk

    yield mount
    for disk in disks:
        subprocess.run(["umount", str(disk)], check=True)
