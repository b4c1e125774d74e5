"""Other processes that bake, and the moments at which something happens to them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from .hall import BAKE, Hall

ROOT = Path(__file__).resolve().parents[2]


class Victim:
    """A process with Blender in it, which waits until it is told what to do."""

    def __init__(self, temporary: Path, **settings: object) -> None:
        """Begin to start it.

        Args:
            temporary: its folder for temporary files, which is made here.
            settings: for `Popen`.
        """
        temporary.mkdir(parents=True, exist_ok=True)
        environment = {**os.environ, "TMPDIR": str(temporary), "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-m", "tests.faults.victim"]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        self.process = subprocess.Popen(command, cwd=ROOT, env=environment, text=True, **{**pipes, **settings})

    def go(self, place: Hall, *arguments: str) -> None:
        """Let it do `pcc bake` on the hall's file, or what the arguments say, once it has started."""
        sub, *rest = arguments or ("bake", *BAKE)
        self.tell(sub, str(place.blend), *rest)

    def tell(self, *arguments: str) -> None:
        """Let it do `pcc` with these arguments, once it has started."""
        assert self.process.stdout.readline().startswith("ready"), self.process.communicate()[1]
        print(json.dumps(arguments), file=self.process.stdin, flush=True)

    def wait_for(self, words: str) -> None:
        """Read what it says until it has said something."""
        for line in self.process.stdout:
            if words in line:
                return
        raise AssertionError(f"it never said '{words}': {self.process.communicate()[1]}")

    def kill_after(self, seconds: float) -> bool:
        """End it as a power cut would; returns whether it was still at work."""
        try:
            self.process.communicate(timeout=seconds)
            return False
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.communicate()
            return True

    def ended(self) -> tuple[int, list[str]]:
        """Its exit code and the lines on standard error, none of which may be a traceback."""
        _, errors = self.process.communicate(timeout=120)
        assert "Traceback" not in errors, errors
        return self.process.returncode, errors.splitlines()


def seconds_of(victim: Victim, place: Hall) -> float:
    """How long an undisturbed bake takes."""
    victim.go(place)
    begin = time.monotonic()
    assert victim.ended()[0] == 0
    return time.monotonic() - begin
