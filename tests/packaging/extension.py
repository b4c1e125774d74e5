"""Build and validate the extension's zip with Blender's own tool, from the bpy wheel or a real Blender.

`python -m tests.packaging.extension FOLDER` (what `dev.py build` runs) leaves the zip in FOLDER, and in `manual` the
pages for artists that are in it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from . import manual
from .plain_zip import make_plain, moment

ROOT = Path(__file__).resolve().parents[2]


def tool() -> Path:
    """Blender's extension tool.

    Raises:
        FileNotFoundError: this Blender does not carry it.
    """
    import bpy

    path = Path(bpy.utils.resource_path("LOCAL")) / "scripts" / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    if not path.is_file():
        raise FileNotFoundError(f"{path}: this Blender comes without its extension tool")
    return path


def build(folder: Path, *, pages: bool = True) -> Path:
    """Build the extension into `folder`, validate it, and return the zip's path.

    Without its `pages` it is what takes the pictures for these.

    Raises:
        subprocess.CalledProcessError: Blender's tool refused it; its message is printed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("parallax_probes-*.zip"):
        old.unlink()
    command = [sys.executable, str(tool())]
    with tempfile.TemporaryDirectory() as place:
        source = _gathered(Path(place) / "source", pages)
        subprocess.run([*command, "build", "--source-dir", str(source), "--output-dir", str(folder)], check=True)
    path = next(folder.glob("parallax_probes-*.zip"))
    make_plain(path, moment(ROOT))
    subprocess.run([*command, "validate", str(path)], check=True)
    return path


def _gathered(source: Path, pages: bool) -> Path:
    """All that goes into the zip, in a folder of its own: the sources, and the pages, which are rendered there now."""
    shutil.copytree(ROOT / "pcc_addon", source / "pcc_addon", ignore=shutil.ignore_patterns("__pycache__", "manual"))
    for name in ("blender_manifest.toml", "__init__.py", "LICENSE"):
        shutil.copy(ROOT / name, source)
    if pages:
        manual.render(source / "pcc_addon" / "manual")
    return source


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    print(build(folder))
    manual.render(folder / "manual")  # panels of an add-on that runs from here open it
