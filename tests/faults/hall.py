"""The file that faults happen to, and what must hold of it afterwards."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import bpy

from pcc_addon.blender.read.probes import all_probes, bake_record
from pcc_addon.blender.status import statuses
from pcc_addon.cli import run_in_blender
from sample_blends.scenes import empty_scene
from tests.blender.helpers import bake, paint_wall, put_in, save, small_probe, small_room
from tests.rna_dump import difference, dump

BAKE = ("--inject", "--save")


@dataclass(frozen=True)
class Hall:
    """A folder with `files/hall.blend`, whose two probes were baked and whose wall was painted afterwards.

    Attributes:
        folder: it; `files` and `tmp` are all that is in it.
        old: the names of the files in `hall.pcc` as the .blend shows them.
        new: the same after another bake.
    """

    folder: Path
    old: frozenset[str]
    new: frozenset[str] = frozenset()

    @property
    def blend(self) -> Path:
        return self.folder / "files" / "hall.blend"

    @property
    def pictures(self) -> Path:
        return self.blend.with_suffix(".pcc")

    @property
    def temporary(self) -> Path:
        return self.folder / "tmp"

    def copied_to(self, folder: Path) -> Hall:
        shutil.copytree(self.folder, folder, dirs_exist_ok=True)
        return Hall(folder, self.old, self.new)

    def everything(self) -> dict[str, bytes]:
        """Every file by its path."""
        found = sorted(path for path in self.folder.rglob("*") if path.is_file())
        return {str(path.relative_to(self.folder)): path.read_bytes() for path in found}


def build(folder: Path) -> Hall:
    """Make a hall; afterwards no file is open."""
    (folder / "files").mkdir()
    (folder / "tmp").mkdir()
    place = Hall(folder, frozenset())
    empty_scene()
    probes = small_room(), small_probe("Second", half_extents=(1.0, 1.0, 1.0))
    for probe in probes:
        probe.pcc_probe.effects.levels = "AUTO"
        probe.pcc_probe.resolution = 8
    save(place.blend)
    assert [result.error for result in bake(*probes)] == [None, None]
    put_in()
    paint_wall()
    save(place.blend)
    old = _names(place)
    after = Hall(folder, old).copied_to(folder.with_name(f"{folder.name}-after"))
    assert run(after) == 0
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return Hall(folder, old, _names(after) - old | {name for name in old if name.endswith(".json")})


def run(place: Hall, *arguments: str) -> int:
    """`pcc bake` in this process, or what the arguments say; returns the exit code."""
    sub, *rest = arguments or ("bake", *BAKE)
    return run_in_blender([sub, str(place.blend), *rest])


def settings() -> dict[str, str]:
    """The open file's settings of renders and of all else that a bake changes for a while."""
    return dump(("scenes", "worlds", "cameras"))


def changed(before: dict[str, str]) -> list[str]:
    """Which of them are others now, but for what a bake is to change.

    How Cycles stores its settings does not count, as a first render adds empty groups: they are compared one by one.
    """
    found = difference(before, settings())
    return [
        line for line in found if "pcc" not in line and "['cycles']:" not in line and not line.endswith("None -> {}")
    ]


def check(place: Hall) -> bool:
    """The .blend is whole and so is a bake of each probe, old or new; then the next bake is fine and leaves nothing.

    Returns:
        Whether the .blend had the new bakes already.
    """
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    found = statuses(bpy.context.scene, bpy.context.view_layer)
    assert [status.probe for status in found] == ["Probe", "Second"]
    assert {status.state for status in found} <= {"stale", "baked"}, [str(status) for status in found]
    check_next_bake(place)
    return all(status.state == "baked" for status in found)


def check_next_bake(place: Hall) -> None:
    assert run(place) == 0
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    found = statuses(bpy.context.scene, bpy.context.view_layer)
    assert [status.state for status in found] == ["baked", "baked"], found
    shown = {level.file for probe in all_probes(bpy.context.scene) for level in bake_record(probe).levels}
    names = _names(place)
    assert shown <= names, "the saved file shows what is not there"
    assert names <= place.old | place.new, "something in the folder of the pictures belongs to nobody"
    beside = {path.name for path in place.blend.parent.iterdir()}
    assert beside <= {"hall.blend", "hall.blend1", "hall.pcc"}, "something beside the file belongs to nobody"
    assert [path for path in place.temporary.iterdir() if path.name.startswith("pcc-")] == []


def _names(place: Hall) -> frozenset[str]:
    return frozenset(path.name for path in place.pictures.iterdir())
