"""A release: the same zip each time, its checksum, an index from which Blender installs and updates."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")

from .extension import ROOT, build, tool
from .release import release, state
from .repositories import EARLIER, served, two_releases

try:
    tool()
except FileNotFoundError as missing:
    pytest.skip(str(missing), allow_module_level=True)

SCRIPT = Path(__file__).with_name("update_from_repository.py")


@pytest.fixture(scope="module")
def releases(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return two_releases(tmp_path_factory.mktemp("releases"))


def test_a_release_has_its_zip_its_checksum_and_the_index(releases: tuple[Path, Path]) -> None:
    folder = releases[1]
    [archive] = folder.glob("*.zip")
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    assert (folder / f"{archive.name}.sha256").read_text() == f"{digest}  {archive.name}\n"
    [entry] = json.loads((folder / "index.json").read_text())["data"]
    assert (entry["id"], entry["archive_url"]) == ("parallax_probes", f"./{archive.name}")
    assert (entry["archive_hash"], entry["archive_size"]) == (f"sha256:{digest}", archive.stat().st_size)
    assert archive.name == f"parallax_probes-{entry['version']}.zip" and entry["blender_version_min"] == "4.5.0"


def test_the_index_is_what_blenders_own_tool_lists(releases: tuple[Path, Path]) -> None:
    address = (releases[1] / "index.json").as_uri()
    command = [sys.executable, str(tool()), "list", "--remote-url", address, "--local-dir", str(releases[1])]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and "parallax_probes" in done.stdout, done.stdout + done.stderr


def test_the_same_sources_make_the_same_zip(releases: tuple[Path, Path], tmp_path: Path) -> None:
    for path in (ROOT / "pcc_addon" / "core").glob("w*.py"):
        os.utime(path)
    [archive] = releases[1].glob("*.zip")
    assert build(tmp_path).read_bytes() == archive.read_bytes()
    entries = zipfile.ZipFile(archive).infolist()
    assert [entry.filename for entry in entries] == sorted(entry.filename for entry in entries)
    assert len({(entry.date_time, entry.external_attr, entry.create_system) for entry in entries}) == 1


def test_another_release_takes_the_place_of_the_one_before(releases: tuple[Path, Path], tmp_path: Path) -> None:
    for path in releases[0].iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / f"parallax_probes-{EARLIER}.zip.sha256").write_text("old")
    archive = release(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        archive.name, f"{archive.name}.sha256", "index.json", "index.html"
    }  # fmt: skip


@pytest.mark.without_blender
def test_the_changelog_says_the_day_of_each_release() -> None:
    assert re.fullmatch(r"\S+ \((release candidate, )?\d{4}-\d\d-\d\d\)", state())


@pytest.mark.sweep
@pytest.mark.parametrize("by", ["file", "http"])
def test_blender_installs_from_a_repository_and_updates(releases: tuple[Path, Path], tmp_path: Path, by: str) -> None:
    (tmp_path / "served").mkdir()
    with served(tmp_path / "served", by) as address:
        arguments = [address, tmp_path / "served", *releases, tmp_path]
        command = [sys.executable, SCRIPT, "--", *arguments]
        environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert done.returncode == 0 and done.stdout.rstrip().endswith("OK"), done.stdout[-2000:] + done.stderr[-2000:]
    assert f"from {EARLIER} to {state().split()[0]}" in done.stdout
