"""A shell command that another Blender does on a snapshot of the open file, which may be worked on meanwhile."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import bpy

from ..core.errors import PccError
from ..core.workplace import aside, discard
from . import devices
from .overrides import override

PACKAGE = Path(__file__).resolve().parents[1]
_NICE = 10  # by how much POSIX systems prefer this Blender; threads that are begun later inherit it
_BELOW_NORMAL = getattr(subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0)  # and to Windows
_LONGEST_WORD = 300  # letters of what a second Blender says as it ends


def snapshot(stack: ExitStack, place: Path) -> Path:
    """A copy of the open file as it is now, with all that is edited and not saved, until `stack` closes.

    It lies beside the file, so that all that is named by relative paths is found.

    Args:
        stack: what removes it.
        place: a folder for that of a file that was never saved.

    Raises:
        PccError: it cannot be saved.
    """
    blend = Path(bpy.data.filepath) if bpy.data.filepath else None
    copy = aside(blend) if blend else place / "unsaved.blend"
    stack.callback(discard, copy)
    preferences = bpy.context.preferences
    try:
        with ExitStack() as quickly:
            quickly.callback(setattr, preferences, "is_dirty", preferences.is_dirty)
            override(quickly, preferences.filepaths, "file_preview_type", "NONE")  # which would be rendered
            override(quickly, bpy.data, "use_autopack", False)  # it would pack the open file
            bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False, compress=False)
    except RuntimeError as error:
        why = " ".join(str(error).split())[:200]
        beside = f"beside '{blend}'" if blend else f"in '{place}'"
        raise PccError(f"no copy of the file can be saved {beside} ({why}); make the folder writable") from error
    return copy


class SecondBlender:
    """Does `pcc SUB` on a .blend; ask for `news` until it has ended.

    Attributes:
        code: its exit code once it has ended and all its news were taken; below 0 that of a signal.
    """

    def __init__(
        self, blend: Path, sub: str, arguments: Sequence[str], place: Path, *, gives_way: bool = False
    ) -> None:
        """Begin.

        Args:
            blend: the file.
            sub: the subcommand.
            arguments: of it; that it is to write JSON is said here.
            place: a folder for all that it leaves; who stops it removes that.
            gives_way: whether it runs at a lower priority, so that windows are drawn as if it were not there.

        Raises:
            PccError: no Blender can be started.
        """
        self.code: int | None = None
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._words = place / "words.txt"
        environment = {**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(place))}
        given = [str(blend), "--json", f"--attended={devices.chosen().to_json()}", *arguments]
        if bpy.app.binary_path:  # the add-on may be on in this session only
            command = [bpy.app.binary_path, "--background", "--addons", _module(), given.pop(0)]
            command += ["--command", "pcc", sub, *given]
        else:
            command = [sys.executable, "-m", PACKAGE.name, sub, *given]
            known = environment.get("PYTHONPATH")
            environment["PYTHONPATH"] = os.pathsep.join([str(PACKAGE.parent), *([known] if known else [])])
        try:
            with self._words.open("w", encoding="utf-8") as words:
                self._process = subprocess.Popen(
                    command,
                    env=environment,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=words,
                    encoding="utf-8",
                    errors="replace",
                    creationflags=_BELOW_NORMAL if gives_way else 0,
                )
        except OSError as error:
            raise PccError(f"no second Blender can be started ({error.strerror})") from error
        if gives_way and hasattr(os, "setpriority"):
            with suppress(OSError):  # it may have ended already
                own = os.getpriority(os.PRIO_PROCESS, 0)
                os.setpriority(os.PRIO_PROCESS, self._process.pid, own + _NICE)
        threading.Thread(target=self._collect, daemon=True).start()

    def news(self, patience: float = 0.0) -> Iterator[Mapping[str, Any]]:
        """What it has told since this was last asked, as the shell's JSON; waits for `patience` seconds at most."""
        if self.code is not None:
            return
        try:
            line = self._lines.get(timeout=patience) if patience else self._lines.get_nowait()
            while line is not None:
                if event := _event(line):
                    yield event
                line = self._lines.get_nowait()
        except queue.Empty:
            return
        self.code = self._process.wait()

    def stop(self, grace: float = 0.0) -> None:
        """End it, by force where it does not end by itself within `grace` seconds."""
        if grace:
            self._process.terminate()
        try:
            self._process.wait(grace)
        except subprocess.TimeoutExpired:  # in the middle of a render
            self._process.kill()
            self._process.wait()

    @property
    def last_words(self) -> str:
        """The last line that it wrote on standard error; empty: none."""
        try:
            lines = self._words.read_text(encoding="utf-8", errors="replace").split("\n")
        except OSError:
            return ""
        said = [" ".join(line.split()) for line in lines if line.strip()]
        return said[-1][:_LONGEST_WORD] if said else ""

    def _collect(self) -> None:
        """Collect its lines, the last of them None."""
        with self._process.stdout as lines:
            for line in lines:
                self._lines.put(line)
        self._lines.put(None)


def _event(line: str) -> Mapping[str, Any] | None:
    try:
        event = json.loads(line)
    except ValueError:  # of Blender itself
        return None
    return event if isinstance(event, dict) else None


def _module() -> str:
    """What Blender calls the add-on: an installed extension has the package in a module of its own."""
    package = __package__.rpartition(".")[0]
    return package.rpartition(".")[0] or package
