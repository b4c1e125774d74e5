"""Ended without a chance to tidy up, as by a power cut: kill −9 at moments drawn from a seed."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest

from .hall import Hall, check
from .processes import Victim, seconds_of
from .tally import fault

SEED = 12
_AT_ONCE = 2  # that start while one is killed and looked at

pytestmark = pytest.mark.skipif(os.name != "posix", reason="kill −9 is of POSIX systems")


@pytest.mark.parametrize("kills", [2, pytest.param(50, marks=pytest.mark.heavy)])
def test_a_bake_may_be_killed_at_any_moment(built: Hall, tmp_path: Path, monkeypatch, kills: int) -> None:
    moments = random.Random(SEED)
    victims = _starting(tmp_path)
    first = next(victims)
    whole = seconds_of(first[1], built.copied_to(tmp_path / "whole"))
    done = saved = 0
    while done < kills:
        folder, victim = next(victims)
        place = built.copied_to(folder)
        monkeypatch.setattr("tempfile.tempdir", str(place.temporary))
        victim.go(place)
        moment = moments.uniform(0.0, whole)
        if not victim.kill_after(moment):
            whole = moment  # it was quicker than the first
            continue
        with fault("kill −9 during a bake"):
            done += 1
            saved += check(place)
    print(f"{done} bakes of {whole:.2f} s killed, {saved} of them after they had saved")
    victims.close()


def _starting(tmp_path: Path) -> Iterator[tuple[Path, Victim]]:
    """Folders and processes, of which the next ones start meanwhile."""
    folders = (tmp_path / f"kill-{k}" for k in count())
    waiting = [(folder, Victim(folder / "tmp")) for folder, _ in zip(folders, range(_AT_ONCE), strict=False)]
    try:
        while True:
            folder = next(folders)
            waiting.append((folder, Victim(folder / "tmp")))
            yield waiting.pop(0)
    finally:
        for _, victim in waiting:
            victim.process.kill()
            victim.process.communicate()
