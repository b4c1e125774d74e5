"""Tries the tests: python3 dev.py run -m tests.mutation [--module core/plan.py …] [--each N] [--seed S] [--jobs J]

For each module a sample of its one-line changes is made, one at a time, and the tests that matter for it are run.
Prints the changes that no test noticed, and a table. A module whose tests fail without a change is named and passed
over; the end is then 1.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from .child import PACKAGE
from .equivalent import EQUIVALENT
from .mutants import Mutant, mutants, sample
from .suites import SUITES

_ALL_PASSED = 0  # what pytest ends with
_HEAD = "| module | mutants | killed | equivalent | rate |\n| --- | --- | --- | --- | --- |"


@dataclass
class Tally:
    """One module's results; `survivors` are those that a test could have noticed."""

    module: str
    tried: int
    equivalent: int
    survivors: list[Mutant]

    @property
    def row(self) -> str:
        killed = self.tried - self.equivalent - len(self.survivors)
        rate = f"{100.0 * killed / max(self.tried - self.equivalent, 1):.0f} %"
        return f"| {self.module} | {self.tried} | {killed} | {self.equivalent} | {rate} |"


def main() -> int:
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--module", action="append", choices=SUITES, help="only this one; may be repeated")
    parser.add_argument("--each", type=int, default=12, help="how many changes of each module")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="how many at the same time")
    options = parser.parse_args()
    modules = options.module or list(SUITES)
    found = [try_module(module, options.each, options.seed, options.jobs) for module in modules]
    tallies = [tally for tally in found if tally is not None]
    print(_HEAD, *(tally.row for tally in tallies), sep="\n")
    tried, equivalent = sum(t.tried for t in tallies), sum(t.equivalent for t in tallies)
    print(Tally("all", tried, equivalent, [m for t in tallies for m in t.survivors]).row)
    return 0 if len(tallies) == len(modules) else 1


def try_module(module: str, each: int, seed: int, jobs: int) -> Tally | None:
    """The results of a module's sample, or None where its tests fail as it is."""
    source = (PACKAGE / module).read_text(encoding="utf-8")
    lines = [line.strip() for line in source.splitlines()]
    files = list(SUITES[module])
    start = time.monotonic()
    code = run(module, "none", files, 900.0)
    if code != _ALL_PASSED:
        print(f"{module}: its tests fail without a change ({code}): {' '.join(files)}", flush=True)
        return None
    patience = 20.0 + 4.0 * (time.monotonic() - start)
    chosen = sample(mutants(source), each, seed)
    known = [m for m in chosen if (module, lines[m.line - 1], m.before, m.after) in EQUIVALENT]
    tried = [m for m in chosen if m not in known]
    with ThreadPoolExecutor(jobs) as pool:
        codes = list(pool.map(lambda mutant: run(module, str(mutant.number), files, patience), tried))
    survivors = [mutant for mutant, code in zip(tried, codes, strict=True) if code == _ALL_PASSED]
    for m in survivors:
        print(
            f"{module}:{m.line}: {m.kind}: {m.before} -> {m.after or 'nothing'}    in: {lines[m.line - 1]}", flush=True
        )
    tally = Tally(module, len(chosen), len(known), survivors)
    print(tally.row, flush=True)
    return tally


def run(module: str, number: str, files: list[str], patience: float) -> int | None:
    """What pytest ended with under a change; None where it took longer than `patience` seconds."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as scratch:
        command = [sys.executable, "-m", "tests.mutation.child", module, number, f"--basetemp={scratch}/tests", *files]
        environment = {**os.environ, "TMPDIR": scratch}
        try:
            done = subprocess.run(
                command, cwd=PACKAGE.parent, env=environment, capture_output=True, text=True, timeout=patience
            )
        except subprocess.TimeoutExpired:
            return None
    return done.returncode


if __name__ == "__main__":
    raise SystemExit(main())
