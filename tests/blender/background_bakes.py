"""A bake in a second Blender, taken down once and told again by a stand-in that starts none."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import pytest

from pcc_addon.blender.bake import background
from pcc_addon.blender.bake.background import BackgroundBake
from pcc_addon.blender.bake.job import BakedProbe
from pcc_addon.blender.second_blender import SecondBlender

PATIENCE = 300.0  # seconds, after which a test fails instead of waiting on


@dataclass(frozen=True)
class Tape:
    """What a second Blender told, and the files that it left."""

    events: tuple[Mapping[str, Any], ...]
    files: Path


def begin(*probes: bpy.types.Object, **options: object) -> BackgroundBake:
    return BackgroundBake(bpy.context.scene, bpy.context.view_layer, probes, **options)


def until(job: BackgroundBake, what: Callable[[], bool]) -> None:
    """Take its news until something is so."""
    end = time.monotonic() + PATIENCE
    while not what():
        assert job.step() and time.monotonic() < end
        time.sleep(0.01)


def finish(job: BackgroundBake) -> list[BakedProbe]:
    """Take its news and let probes have their bakes until it has ended."""
    end = time.monotonic() + PATIENCE
    while job.step():
        if job.waiting:
            job.adopt_next()
        assert time.monotonic() < end
        time.sleep(0.01)
    return job.results


def record(monkeypatch: pytest.MonkeyPatch, place: Path, *probes: bpy.types.Object) -> Tape:
    """Let a second Blender bake probes of the open file, and take down what it tells; nobody adopts it."""
    told: list[Mapping[str, Any]] = []
    news = SecondBlender.news

    def heard(self: SecondBlender, patience: float = 0.0) -> Iterator[Mapping[str, Any]]:
        for event in news(self, patience):
            told.append(event)
            yield event

    monkeypatch.setattr(SecondBlender, "news", heard)
    job = begin(*probes)
    until(job, lambda: len(job.waiting) == len(probes))
    shutil.copytree(Path(job.waiting[0].sidecar).parent, place)
    job.cancel()
    return Tape(tuple(told), place)


def play(monkeypatch: pytest.MonkeyPatch, tape: Tape, ends: Sequence[tuple[str, int]] = ()) -> list[list[str]]:
    """Let background bakes get what a tape holds; returns the arguments that each second Blender was given.

    Args:
        monkeypatch: puts the stand-in in place.
        tape: what is told.
        ends: for each of the first ones the probe that it ends at, in the middle of its faces, and its exit code.
    """
    given: list[list[str]] = []
    endings = list(ends)

    class Player:
        """Looks like a second Blender."""

        def __init__(self, blend: Path, sub: str, arguments: Sequence[str], place: Path, *, gives_way: bool) -> None:
            assert blend.is_file() and place.is_dir() and sub == "bake" and gives_way
            given.append(list(arguments))
            options = [argument.partition("=")[::2] for argument in arguments]
            [folder] = [Path(value) for name, value in options if name == "--folder"]
            wanted = {value for name, value in options if name == "--probe"}
            shutil.copytree(tape.files, folder, dirs_exist_ok=True)
            self.code: int | None = None
            self.last_words = "MemoryError"
            self._events = [dict(event) for event in tape.events if event.get("probe", "") in {*wanted, ""}]
            self._stop, self._code = endings.pop(0) if endings else ("", 0)
            for event in self._events:
                if event["event"] == "baked":
                    event["sidecar"] = str(folder / Path(event["sidecar"]).name)
                if event["event"] == "baking":
                    event["probes"] = [name for name in event["probes"] if name in wanted]

        def news(self, patience: float = 0.0) -> Iterator[Mapping[str, Any]]:
            """One thing at a time."""
            if self.code is None and self._events:
                event = self._events.pop(0)
                yield event
                if self._stop and event.get("probe") == self._stop and event["event"] == "progress":
                    self.code = self._code
            elif self.code is None:
                self.code = self._code

        def stop(self, grace: float = 0.0) -> None:
            self.code = -9

    monkeypatch.setattr(background, "SecondBlender", Player)
    return given
