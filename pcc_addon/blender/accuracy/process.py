"""A cost run in a second Blender, on a snapshot of the open file."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import bpy

from ...core.accuracy import files
from ...core.accuracy.records import CostReport
from ...core.errors import Cancelled, PccError
from ...core.workplace import workplace
from ..second_blender import SecondBlender, snapshot
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
        with ExitStack() as stack:
            place = workplace(stack)
            copy = snapshot(stack, place)
            asked = _arguments(question, blend, self.folder, resume=resume)
            self._blender = SecondBlender(copy, "cost", asked, place)
            self._stack = stack.pop_all()

    def step(self) -> bool:
        """Take the news; False once the run has ended.

        Raises:
            PccError: it failed; says why.
            Cancelled: somebody stopped it.
        """
        for event in self._blender.news(_PATIENCE):
            self._heed(event)
        code = self._blender.code
        if code is None:
            return True
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
        self._blender.stop(_GRACE)
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

    def _heed(self, event: Mapping[str, Any]) -> None:
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
    return [f"--frames={question.frames}", f"--out={folder}", f"--called={blend.name}", *found]
