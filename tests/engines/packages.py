"""The engines as npm packages, in a folder that is kept for the next run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

VERSIONS = {"three": "0.187.0", "babylonjs": "9.31.0", "playcanvas": "2.23.3", "gltf-validator": "2.0.0-dev.3.10"}


def cache() -> Path:
    """Where they are kept; `PCC_ENGINES` says otherwise."""
    chosen = os.environ.get("PCC_ENGINES")
    return Path(chosen) if chosen else Path.home() / ".cache" / "parallax-probes-engines"


def installed(*names: str) -> Path:
    """The node_modules folder with some packages; skips the test where npm is not there or cannot install them."""
    modules = cache() / "node_modules"
    lacking = [name for name in names if _version(modules / name) != VERSIONS[name]]
    if not lacking:
        return modules
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("needs npm, to install " + ", ".join(lacking))
    cache().mkdir(parents=True, exist_ok=True)
    (cache() / "package.json").touch()
    if not (cache() / "package.json").read_text():
        (cache() / "package.json").write_text("{}")
    wanted = [f"{name}@{VERSIONS[name]}" for name in lacking]
    command = [npm, "install", "--ignore-scripts", "--no-audit", "--no-fund", "--save-exact", *wanted]
    done = subprocess.run(command, cwd=cache(), capture_output=True, text=True, timeout=600)
    if done.returncode:
        pytest.skip(f"npm cannot install {', '.join(wanted)}: {done.stderr.strip().splitlines()[-1:]}")
    return modules


def _version(package: Path) -> str:
    try:
        return str(json.loads((package / "package.json").read_text())["version"])
    except (OSError, ValueError, KeyError):
        return ""
