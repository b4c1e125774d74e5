"""The zip that artists get: built and validated by Blender's tool, holding the add-on and nothing else."""

from __future__ import annotations

import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")


from .extension import ROOT, build, tool
from .manual import pages

try:
    tool()
except FileNotFoundError as missing:
    pytest.skip(str(missing), allow_module_level=True)


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("extension"))


def test_zip_holds_the_add_on_and_nothing_else(archive: Path) -> None:
    names = {name for name in zipfile.ZipFile(archive).namelist() if not name.endswith("/")}
    sources = {str(p.relative_to(ROOT).as_posix()) for p in (ROOT / "pcc_addon").rglob("*.py")}
    beside = (ROOT / "pcc_addon" / "core" / "export" / "beside").rglob("*.*")
    data = {"pcc_addon/core/effect_costs.json", *(path.relative_to(ROOT).as_posix() for path in beside)}
    manual = {name for name in names if name.startswith("pcc_addon/manual/")}
    assert {f"pcc_addon/manual/{page.stem}.html" for page in pages()} < manual
    names -= manual
    assert names == sources | data | {"blender_manifest.toml", "__init__.py", "LICENSE"}


@pytest.mark.without_blender
def test_manifest_asks_for_what_the_issue_names() -> None:
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text())
    assert manifest["id"] == "parallax_probes"
    assert manifest["blender_version_min"] == "4.5.0"
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert set(manifest["permissions"]) == {"files"}


@pytest.mark.without_blender
def test_the_changelog_begins_with_the_version_of_the_manifest() -> None:
    version = tomllib.loads((ROOT / "blender_manifest.toml").read_text())["version"]
    sections = [
        line.split()[1]
        for line in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").splitlines()
        if line[:3] == "## "
    ]
    assert sections[0] == version and len(set(sections)) == len(sections) > 1


def test_installed_zip_bakes_a_probe_and_leaves_nothing_when_disabled(archive: Path, tmp_path: Path) -> None:
    script = Path(__file__).with_name("install_and_bake.py")
    command = [sys.executable, str(script), str(archive), str(tmp_path / "user")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0 and done.stdout.rstrip().endswith("OK"), done.stdout[-2000:] + done.stderr[-2000:]
