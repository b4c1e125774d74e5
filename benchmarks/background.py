"""How long a window stands still while its probes are baked in the background, in a real Blender.

PCC_BLENDER="blender" python3 dev.py run benchmarks/background.py [ROOM.blend]
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy

from benchmarks.measure import ROOT, open_room, start, table, write_between
from pcc_addon.blender.read.probes import all_probes
from sample_blends.two_rooms import two_rooms
from tests.packaging.extension import build

BLENDER = shlex.split(os.environ.get("PCC_BLENDER", ""))
RESOLUTION, SAMPLES = 512, 1
MARKER = "figures: written by benchmarks/background.py"


PHASES = (
    ("nothing baked, panels drawn as often", "nothing baked", None),
    ("a bake runs, nothing adopted", "bake", "baking"),
    ("a probe takes its new bake, undo step included", "bake", "adopting"),
    ("what shows it is drawn", "bake", "drawing what is new"),
    ("*Bake and Show*: a bake runs", "bake and show", "baking"),
    ("*Bake and Show*: a probe takes its bake, or materials show it", "bake and show", "adopting"),
    ("*Bake and Show*: what shows it is drawn", "bake and show", "drawing what is new"),
)
COLUMNS = ("ours", "Blender's", "of its thread", "longest")
HEAD = ("rounds in which …", "how many", "ours at most", "Blender's at most", "both at most", "with waiting at most")


def rows(found: dict[str, dict]) -> list[tuple[str, ...]]:
    """The table's: milliseconds."""
    made = []
    for what, name, part in PHASES:
        phase = found[name] if part is None else found[name][part]
        made.append((what, str(phase["rounds"]), *(f"{1000.0 * phase[column]:.0f}" for column in COLUMNS)))
    starting = max(found[name]["starting"] for name in ("bake", "bake and show"))
    return [*made, ("a bake is started, with its snapshot", "2", f"{1000.0 * starting:.0f}", "", "", "")]


def measured(folder: Path) -> dict[str, dict]:
    """What `background_drive.py` found of `folder / room.blend`."""
    shutil.copy(ROOT / "benchmarks" / "background_drive.py", folder)
    run(
        "-b", "--command", "extension", "install-file", "-r", "user_default", "--enable", str(build(folder)), cwd=folder
    )
    result = folder / "result.json"
    run("-p", "0", "0", "1600", "900", "room.blend", "--python", "background_drive.py", "--", str(result), cwd=folder)
    found = json.loads(result.read_text(encoding="utf-8"))
    if "error" in found:
        raise SystemExit(found["error"])
    return found


def run(*arguments: str, cwd: Path) -> None:
    subprocess.run([*BLENDER, *arguments], cwd=cwd, check=True, capture_output=True, timeout=1800)


def main() -> None:
    if not BLENDER:
        raise SystemExit("set PCC_BLENDER to the command of a real Blender with a screen")
    start()
    scene = open_room(Path(sys.argv[1]), fit=True) if len(sys.argv) > 1 else two_rooms()
    for probe in all_probes(scene):
        probe.pcc_probe.resolution, probe.pcc_probe.samples, probe.pcc_probe.denoise = RESOLUTION, SAMPLES, False
    with tempfile.TemporaryDirectory() as name:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(name) / "room.blend"))
        found = measured(Path(name))
    write_between(ROOT / "docs" / "background.md", MARKER, table(HEAD, rows(found)))


main()
