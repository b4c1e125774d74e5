"""Bakes on a disk that is full from the k-th change on, or at that alone: `python -m tests.faults.full_disk`.

Arguments: the library, the folder of a hall with `names.json` beside it, one for copies, and which changes are tried:
from, and each how many-th. Of these every third is also tried alone, with a disk that has space again afterwards.
What came of it is one line of JSON a try; the last says how many changes there were. Blender is started once for all.
"""

from __future__ import annotations

import ctypes
import io
import json
import os
import subprocess
import sys
import tempfile
import traceback
from contextlib import redirect_stderr
from pathlib import Path

SOURCE = Path(__file__).with_suffix(".c")


def compiled(folder: Path, compiler: str) -> Path:
    """The library that lets changes fail."""
    library = folder / "full_disk.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-Wall", "-Werror", "-o", library, SOURCE, "-ldl"], check=True)
    return library


class Disk:
    """Lets changes of files below a folder fail; `compiled`'s library must be preloaded."""

    def __init__(self, library: Path) -> None:
        self._library = ctypes.CDLL(str(library))
        self._library.disk_seen.restype = self._library.disk_failed.restype = ctypes.c_long

    def fails(self, folder: Path, change: int, *, for_good: bool) -> None:
        """Let one fail, counted from 1, and all after it where it is for good; 0: none."""
        self._library.disk_arm(os.fsencode(folder), ctypes.c_long(change), int(for_good))

    @property
    def seen(self) -> int:
        """How many changes there were since."""
        return self._library.disk_seen()

    @property
    def failed(self) -> int:
        """How many of them failed."""
        return self._library.disk_failed()


def main(library: Path, built: Path, copies: Path, start: int, each: int) -> None:
    import bpy

    import pcc_addon
    from tests.faults import hall

    pcc_addon.register()
    disk = Disk(library)
    record = json.loads((built.parent / "names.json").read_text(encoding="utf-8"))
    whole = hall.Hall(built, frozenset(record["old"]), frozenset(record["new"]))

    def tried(change: int, for_good: bool) -> tuple[int, int]:
        """Exit code and number of changes."""
        place = whole.copied_to(copies / f"{change}-{for_good:d}")
        tempfile.tempdir = str(place.temporary)
        bpy.ops.wm.open_mainfile(filepath=str(place.blend))
        before = hall.settings()
        words = io.StringIO()
        disk.fails(place.folder, change, for_good=for_good)
        with redirect_stderr(words):
            code = hall.run(place)
        seen, failed = disk.seen, disk.failed
        disk.fails(Path("/nowhere"), 0, for_good=False)
        if not change:
            assert code == 0 and not failed
            return code, seen
        assert not hall.changed(before), hall.changed(before)
        lines = [line for line in words.getvalue().splitlines() if line.startswith("pcc")]
        assert "Traceback" not in words.getvalue(), words.getvalue()
        if code:
            assert lines and all("free space" in line for line in lines), lines
        hall.check(place)
        return code, seen

    changes = tried(0, False)[1]
    for number, change in enumerate(range(start, changes + 1, each)):
        for for_good in (True, False) if number % 3 == 0 else (True,):
            said = {"change": change, "for_good": for_good}
            try:
                code, _ = tried(change, for_good)
                told({**said, "survived": True, "code": code})
            except AssertionError as error:
                why = traceback.format_exception(error)[-3:]
                told({**said, "survived": False, "why": "".join(why)[:1000]})
    told({"changes": changes})


def told(event: dict[str, object]) -> None:
    print(json.dumps(event), flush=True)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:4]), *map(int, sys.argv[4:]))
    os._exit(0)  # Blender 4.5 as a module crashes at exit where types are left registered
