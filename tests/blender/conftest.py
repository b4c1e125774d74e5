"""These tests run where bpy can be imported; no window is needed."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender as a module (pip install bpy)")


@pytest.fixture(autouse=True)
def _registered(addon: None) -> None:
    """Every test here has the add-on."""


@pytest.fixture
def probe(scene: bpy.types.Scene) -> bpy.types.Object:
    """A probe that has pictures without having rendered them."""
    from tests.blender.helpers import pretend_bake, small_probe

    probe = small_probe()
    pretend_bake(probe)
    return probe


@pytest.fixture
def renders(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The probe names of the faces that were rendered."""
    from pcc_addon.blender.bake.capture import Stage

    seen: list[str] = []
    face = Stage.face

    def counted(self: Stage, spec: object, index: int) -> object:
        seen.append(spec.name)
        return face(self, spec, index)

    monkeypatch.setattr(Stage, "face", counted)
    return seen


@pytest.fixture(scope="session")
def _room_file(addon: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from tests.blender.filing import build

    blend = tmp_path_factory.mktemp("home") / "room.blend"
    build(blend)
    return blend


@pytest.fixture
def home(_room_file: Path, tmp_path: Path) -> Path:
    """The open file of `filing.build` in a folder of its own."""
    from tests.blender.filing import opened

    shutil.copytree(_room_file.parent, tmp_path / "home")
    return opened(tmp_path / "home" / _room_file.name)
