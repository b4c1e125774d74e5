"""How each engine shows an export."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from . import browser, godot_program, packages


def _in_browser(key: str, package: str, export: Path, scene: dict) -> np.ndarray:
    browser.chromium()  # without it nothing need be installed
    return browser.picture_of(f"{key}.html", export, packages.installed(package), scene)


ENGINES: dict[str, Callable[[Path, dict], np.ndarray]] = {
    "three": partial(_in_browser, "three", "three"),
    "babylon": partial(_in_browser, "babylon", "babylonjs"),
    "playcanvas": partial(_in_browser, "playcanvas", "playcanvas"),
    "godot": godot_program.picture_of,
}
