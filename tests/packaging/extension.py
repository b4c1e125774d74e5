"""Build and validate the extension's zip with Blender's own tool, from the bpy wheel or a real Blender.

`python -m tests.packaging.extension FOLDER` (what `dev.py build` runs) leaves the zip in FOLDER.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

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


def build(folder: Path) -> Path:
    """Build the extension into `folder`, validate it, and return the zip's path.

    Raises:
        subprocess.CalledProcessError: Blender's tool refused it; its message is printed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("parallax_probes-*.zip"):
        old.unlink()
    command = [sys.executable, str(tool())]
    subprocess.run([*command, "build", "--source-dir", str(ROOT), "--output-dir", str(folder)], check=True)
    path = next(folder.glob("parallax_probes-*.zip"))
    subprocess.run([*command, "validate", str(path)], check=True)
    return path


if __name__ == "__main__":
    print(build(Path(sys.argv[1])))
