"""Installed from a repository and updated from it, in a real Blender: without a window, and without its preferences."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.packaging.release import state
from tests.packaging.repositories import EARLIER, served, two_releases
from tests.window.real import MARKS, run

pytestmark = MARKS
SCRIPT = Path(__file__).parents[1] / "packaging" / "update_from_repository.py"


@pytest.fixture(scope="module")
def releases(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return two_releases(tmp_path_factory.mktemp("releases"))


@pytest.mark.parametrize("by", ["file", "http"])
def test_a_real_blender_installs_from_a_repository_and_updates(
    releases: tuple[Path, Path], tmp_path: Path, by: str
) -> None:
    (tmp_path / "served").mkdir()
    shutil.copy(SCRIPT, tmp_path)
    with served(tmp_path / "served", by) as address:
        arguments = [address, *map(str, (tmp_path / "served", *releases, tmp_path))]
        started = ("-b", "--factory-startup", "--online-mode", "--python-exit-code", "1", "--python")
        done = run(*started, str(tmp_path / SCRIPT.name), "--", *arguments, cwd=tmp_path)
    assert done.returncode == 0 and "OK" in done.stdout.splitlines(), done.stdout + done.stderr
    assert f"from {EARLIER} to {state().split()[0]}" in done.stdout
