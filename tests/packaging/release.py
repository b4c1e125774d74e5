"""What a release is made of: the zip, its checksum, and an index from which Blender installs and updates.

`python -m tests.packaging.release FOLDER` (what `dev.py release` runs) leaves them in FOLDER, which any web server
hosts as it is.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
from pathlib import Path

from .extension import ROOT, build, tool

CHECKSUM = ".sha256"
_HEADING = re.compile(r"^## (\S+)(?: \((.*)\))?$", re.MULTILINE)


def release(folder: Path) -> Path:
    """Make all of it in `folder`, where earlier zips go; returns the zip's path.

    Raises:
        subprocess.CalledProcessError: Blender's tool refused something; its message is printed.
    """
    archive = build(folder)
    checksum = archive.with_name(archive.name + CHECKSUM)
    for old in folder.glob(f"*.zip{CHECKSUM}"):
        old.unlink()
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    checksum.write_text(f"{digest}  {archive.name}\n", encoding="ascii")  # as `sha256sum --check` reads it
    index(folder)
    return archive


def index(folder: Path) -> None:
    """Let Blender's tool list the zips of a folder in `index.json`, for Blender, and in `index.html`, for people.

    Raises:
        subprocess.CalledProcessError: it refused one.
    """
    subprocess.run([sys.executable, str(tool()), "server-generate", "--repo-dir", str(folder), "--html"], check=True)


def state() -> str:
    """The version and what the changelog says of it: the day of its release, or that it is none yet."""
    found = _HEADING.search((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    return f"{found[1]} ({found[2]})" if found else "unknown"


if __name__ == "__main__":
    print(release(Path(sys.argv[1])))
    print(f"version {state()}")
