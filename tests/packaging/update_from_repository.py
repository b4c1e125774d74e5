"""Run inside a Blender of its own: install from a repository, update from it, and find one's probes again. Prints OK.

Arguments after `--`: the address of the repository; the folder that is served there; folders with what is in it first
and what is put there later; a folder for what Blender installs and saves.
"""

from __future__ import annotations

import importlib
import shutil
import sys
from pathlib import Path

import bpy

MODULE = "bl_ext.studio.parallax_probes"


def publish(release: str, served: str) -> None:
    """Let the repository hold a release and nothing else."""
    for old in Path(served).iterdir():
        old.unlink()
    for path in Path(release).iterdir():
        shutil.copy(path, served)


def installed() -> str:
    """The version of the add-on that is at work."""
    assert MODULE in {addon.module for addon in bpy.context.preferences.addons}
    return importlib.import_module(f"{MODULE}.pcc_addon.version").ADDON_VERSION


def found(blend: Path) -> list[tuple[str, int, bool]]:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    probes = [item for item in bpy.data.objects if item.pcc_probe.is_probe]
    return [(probe.name, probe.pcc_probe.resolution, bool(probe.pcc_probe.bake_record)) for probe in probes]


def main(address: str, served: str, first: str, later: str, place: str) -> None:
    blend = Path(place) / "room.blend"
    preferences = bpy.context.preferences
    preferences.system.use_online_access = True
    publish(first, served)
    repository = preferences.extensions.repos.new(
        name="Studio", module="studio", custom_directory=str(Path(place) / "extensions"), remote_url=address
    )
    index = list(preferences.extensions.repos).index(repository)
    bpy.ops.extensions.repo_sync(repo_index=index)
    bpy.ops.extensions.package_install(repo_index=index, pkg_id="parallax_probes", enable_on_install=True)
    before = installed()
    bpy.ops.pcc.probe_add(name="Room", location=(0, 0, 1), half_extents=(3, 3, 2))
    probe = bpy.data.objects["Room"].pcc_probe
    probe.resolution, probe.samples = 16, 1
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"}
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    probes = found(blend)
    assert probes == [("Room", 16, True)], probes
    publish(later, served)
    bpy.ops.extensions.repo_sync(repo_index=index)
    bpy.ops.extensions.package_upgrade_all()
    after = installed()
    print(f"from {before} to {after}")
    assert found(blend) == probes, "the file has its probes after the update"
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"}
    print("OK")


main(*sys.argv[sys.argv.index("--") + 1 :])
