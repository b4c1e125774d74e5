"""A cost run in a Blender of its own, on a copy of the open file: that one stays as it is, and its window alive."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import bpy

from ...core.accuracy import files
from ...core.accuracy.records import CostReport
from ...core.errors import Cancelled, PccError
from ...core.workplace import WORKPLACE, aside, temporary_folder
from .applying import results_folder
from .question import Question

_PATIENCE = 0.05  # seconds that a step waits for news
_GRACE = 10.0  # seconds that a run has for ending by itself once it is cancelled
_CANCELLED = 130


class CostProcess:
    """Runs `pcc cost` on the open file as it is now. Call `step` until it returns False, or `cancel`.

    Attributes:
        progress: 0 … 1.
        message: what is being done.
        notes: what the user should know, in words.
        folder: where results are.
        report: what was found out; once all is done.
    """

    def __init__(self, question: Question, folder: Path | None, *, resume: bool) -> None:
        """Begin.

        Args:
            question: what is asked.
            folder: for results; None: beside the .blend, or with Blender's temporary files where it is not saved.
            resume: whether to go on with what was kept there.

        Raises:
            PccError: the copy cannot be saved.
        """
        self.progress, self.message = 0.0, "Starting Blender"
        self.notes: list[str] = []
        self.report: CostReport | None = None
        blend = Path(bpy.data.filepath) if bpy.data.filepath else Path(bpy.app.tempdir, "unsaved.blend")
        self.folder = folder or results_folder(blend)
        self._errors: list[str] = []
        self._told_results = False
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._stack = ExitStack()
        with ExitStack() as unless_begun:
            unless_begun.callback(self._stack.close)
            copy = self._saved_copy(blend)
            self._process = self._started(copy, _arguments(question, blend, self.folder, resume=resume))
            unless_begun.pop_all()

    def step(self) -> bool:
        """Take the news; False once the run has ended.

        Raises:
            PccError: it failed; says why.
            Cancelled: somebody stopped it.
        """
        try:
            line = self._lines.get(timeout=_PATIENCE)
            while line is not None:
                self._heed(line)
                line = self._lines.get_nowait()
        except queue.Empty:
            return True
        code = self._process.wait()
        self._stack.close()
        if code == _CANCELLED:
            raise Cancelled("the measurements were stopped; what was measured is kept")
        self.report = files.read(self.folder) if code == 0 or self._told_results else None
        if self.report is None:
            said = "; ".join(self._errors) or f"Blender ended with code {code}"
            raise PccError(said)
        self.notes += self._errors
        self.progress, self.message = 1.0, "Done"
        return False

    def cancel(self) -> None:
        """Stop; what was measured is kept."""
        self._process.terminate()
        try:
            self._process.wait(_GRACE)
        except subprocess.TimeoutExpired:  # in the middle of a render
            self._process.kill()
            self._process.wait()
        self._stack.close()
        self.message = "Cancelled"

    def run(self) -> CostReport:
        """All steps at once."""
        try:
            while self.step():
                pass
        except KeyboardInterrupt:
            self.cancel()
            raise
        return self.report

    def _saved_copy(self, blend: Path) -> Path:
        """A copy of the open file, beside it so that all that it names is found; removed in the end."""
        if bpy.data.filepath:
            copy = aside(blend)
        else:
            copy = self._stack.enter_context(temporary_folder(WORKPLACE)) / blend.name
        self._stack.callback(copy.unlink, missing_ok=True)
        try:
            bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False)
        except RuntimeError as error:
            why = " ".join(str(error).split())[:200]
            raise PccError(f"no copy can be saved beside '{blend}' ({why}); make the folder writable") from error
        return copy

    def _started(self, blend: Path, arguments: Sequence[str]) -> subprocess.Popen[str]:
        """The run, whose lines a thread collects, the last of them None."""
        package = Path(__file__).resolve().parents[2]
        environment = dict(os.environ)
        if bpy.app.binary_path:
            command = [bpy.app.binary_path, "--background", str(blend), "--command", "pcc", "cost"]
        else:
            command = [sys.executable, "-m", package.name, "cost", str(blend)]
            known = environment.get("PYTHONPATH")
            environment["PYTHONPATH"] = os.pathsep.join([str(package.parent), *([known] if known else [])])
        try:
            process = subprocess.Popen(
                [*command, *arguments],
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                encoding="utf-8",
                errors="replace",
            )
        except OSError as error:
            raise PccError(f"no second Blender can be started ({error.strerror})") from error
        threading.Thread(target=self._collect, args=(process,), daemon=True).start()
        return process

    def _collect(self, process: subprocess.Popen[str]) -> None:
        with process.stdout as lines:
            for line in lines:
                self._lines.put(line)
        self._lines.put(None)

    def _heed(self, line: str) -> None:
        try:
            event = json.loads(line)
        except ValueError:  # of Blender itself
            return
        match event:
            case {"event": "progress", "progress": progress, "message": message}:
                self.progress, self.message = progress, message
            case {"event": "note", "note": note}:
                self.notes.append(note)
            case {"event": "error", "error": error}:
                self._errors.append(error)
            case {"event": "results"}:
                self._told_results = True


def _arguments(question: Question, blend: Path, folder: Path, *, resume: bool) -> list[str]:
    """What the shell is asked, in its own words."""
    given = {
        "--probe": question.probe,
        "--camera": question.camera,
        "--engine": question.engine.value if question.engine else "",
        "--target-error": question.target,
        "--budget": question.budget,
        "--width": question.width,
    }
    found = [f"{name}={value}" for name, value in given.items() if value]
    flags = {"--quick": question.quick, "--resume": resume}
    found += [name for name, is_set in flags.items() if is_set]
    return ["--json", f"--frames={question.frames}", f"--out={folder}", f"--called={blend.name}", *found]
