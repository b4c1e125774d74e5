"""Changes to a scene that make a bake stale, and changes that do not: a row each, for tests and for docs/staleness.md.

A row is a generator: it builds what it needs, yields while the scene is looked at, and then makes its change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pcc_addon.core.probe import Engine

Steps = Iterator[None]


@dataclass(frozen=True)
class Row:
    """One change.

    Attributes:
        subject: what of a scene it is about, for the page.
        name: in words.
        steps: builds the scene in a folder, yields, and changes it.
        counts: whether a bake is stale then.
        engine: of the probe.
        settings: of the probe, that differ from those of others.
    """

    subject: str
    name: str
    steps: Callable[[Path], Steps]
    counts: bool
    engine: Engine = Engine.CYCLES
    settings: tuple[tuple[str, object], ...] = ()

    def __str__(self) -> str:
        return f"{self.subject}: {self.name}" + (" (EEVEE)" if self.engine is Engine.EEVEE else "")


ROWS: list[Row] = []


def row(subject: str, name: str, counts: bool, engine: Engine = Engine.CYCLES, **settings: object):
    """Let a generator be a row."""

    def add(steps: Callable[[Path], Steps]) -> Callable[[Path], Steps]:
        ROWS.append(Row(subject, name, steps, counts, engine, tuple(settings.items())))
        return steps

    return add


def stale(subject: str, name: str, engine: Engine = Engine.CYCLES, **settings: object):
    return row(subject, name, True, engine, **settings)


def fresh(subject: str, name: str, engine: Engine = Engine.CYCLES, **settings: object):
    return row(subject, name, False, engine, **settings)


def scene_setting(owner: Callable[[], object], name: str, value: object) -> Callable[[Path], Steps]:
    """A row that sets a property to a value which it does not have."""

    def steps(folder: Path) -> Steps:
        assert getattr(owner(), name) != value, f"{name} is {value} already"
        yield
        setattr(owner(), name, value)

    return steps


def settings_rows(
    counts: bool, subject: str, owner: Callable[[], object], words: str, engine: Engine, /, **values
) -> None:
    """A row for each of some properties."""
    for name, value in values.items():
        row(subject, words.format(name.replace("_", " ")), counts, engine)(scene_setting(owner, name, value))
