"""Clicks and seconds from an opened file to a correct reflection, in a real Blender.

PCC_BLENDER="blender" python3 dev.py run benchmarks/tour.py [FILE.blend]
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import bpy

from benchmarks.measure import ROOT, start, table, write_between
from tests.packaging.extension import build
from tests.window.real import BLENDER, driven, install
from tests.window.touring import seconds, two_rooms_without_probes

MARKER = "figures: written by benchmarks/tour.py"
OUTPUT = ROOT / "tests" / "output" / "tour"


def toured(name: str, given: Path | None) -> list[tuple[str, ...]]:
    """Rows of the table: what was done in two rooms, or in a file that is given."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        install(build(place), place)
        if given is None:
            two_rooms_without_probes()
            bpy.ops.wm.save_as_mainfile(filepath=str(place / "room.blend"))
        else:
            shutil.copyfile(given, place / "room.blend")
        found = driven(place, "tour", OUTPUT / name)
    if found["skipped"]:
        raise SystemExit(found["skipped"])
    steps = [step for step in found["steps"] if step["clicks"] or step["keys"]]
    rows = [(name, step["name"], step["clicks"], step["keys"], f"{seconds(step):.1f}") for step in steps]
    clicks, keys = (sum(step[kind] for step in steps) for kind in ("clicks", "keys"))
    return [*rows, (name, "**all of it**", f"**{clicks}**", f"**{keys}**", f"**{sum(map(seconds, steps)):.0f}**")]


def main() -> None:
    if not BLENDER:
        raise SystemExit("set PCC_BLENDER to the command of a real Blender with a screen")
    start()
    rows = toured("two rooms", None)
    if len(sys.argv) > 1:
        rows += toured(Path(sys.argv[1]).stem, Path(sys.argv[1]))
    head = ("file", "step", "clicks", "keys", "a person's seconds")
    write_between(ROOT / "docs" / "tour.md", MARKER, table(head, rows))


main()
