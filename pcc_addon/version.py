"""The add-on's version; the manifest is where it is written down."""

import tomllib
from pathlib import Path

_MANIFEST = Path(__file__).resolve().parent.parent / "blender_manifest.toml"
ADDON_VERSION: str = tomllib.loads(_MANIFEST.read_text(encoding="utf-8"))["version"]
