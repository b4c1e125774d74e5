"""Whether a recommended setting meets the target that it was recommended for, once it is baked and rendered afresh.

python3 dev.py run benchmarks/targets.py [ROOM.blend …]

Files are furnished rooms of others, which get a fitted probe where they have none. Writes into docs/accuracy.md.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy

from benchmarks.measure import ROOT, open_room, start, table, write_between
from pcc_addon.core.accuracy import files, labels
from pcc_addon.core.accuracy.advice import advice
from pcc_addon.core.probe import Engine
from sample_blends import scenes
from sample_blends.build import SAMPLES

PAGE = ROOT / "docs" / "accuracy.md"


@dataclass(frozen=True)
class Case:
    """A room, and the error that is asked for in it."""

    name: str
    build: Callable[[], object]
    engine: Engine
    target: float


def main() -> None:
    start()
    emissive = SAMPLES["emissive_room.blend"]
    cases = [
        Case("emissive room", emissive, Engine.CYCLES, 0.1),
        Case("emissive room", emissive, Engine.EEVEE, 0.1),
        Case("gallery", scenes.gallery, Engine.CYCLES, 0.3),
    ]
    for path in map(Path, sys.argv[1:]):
        name, build = path.stem.replace("_", " "), partial(open_room, path, fit=True)
        cases += [Case(name, build, Engine.CYCLES, 0.6), Case(name, build, Engine.EEVEE, 0.6)]
    head = ["scene", "engine", "target", "recommended", "error", "afresh", "bake", "afresh", "frame", "afresh"]
    text = table(head, [_row(case) for case in cases])
    write_between(PAGE, "targets: written by benchmarks/targets.py", text)


def _row(case: Case) -> list[str]:
    case.build()
    with TemporaryDirectory() as place:
        path, folder = Path(place, "room.blend"), Path(place, "results")
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        command = [sys.executable, "-m", "pcc_addon", "cost", str(path), "--engine", case.engine.value, "--quick"]
        subprocess.run([*command, "--target-error", str(case.target), "--out", str(folder)], cwd=ROOT, check=False)
        report = files.read(folder)
    engine = "Cycles" if case.engine is Engine.CYCLES else "EEVEE"
    start_of_row = [case.name, engine, labels.error(case.target)]
    chosen = advice(report).recommended if report is not None else None
    if report is None or chosen is None or report.afresh is None:
        return [*start_of_row, "none in time", *["–"] * 6]
    before, after = report.measurements[chosen], report.afresh
    return [
        *start_of_row,
        labels.label(before.settings),
        labels.error(before.rmse),
        labels.error(after.rmse),
        labels.seconds(before.bake_seconds),
        labels.seconds(after.bake_seconds),
        labels.seconds(before.frame_seconds),
        labels.seconds(after.frame_seconds),
    ]


if __name__ == "__main__":
    main()
