"""How probes' bakes stand, as far as that was asked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import Enum

import bpy

from ...blender.read.probes import all_probes
from ...blender.status import NO_BAKE, ProbeStatus
from . import running_bake


class State(Enum):
    """How a bake stands.

    Attributes:
        label: in a word or two.
        icon: of lists and panels.
    """

    def __init__(self, label: str, icon: str) -> None:
        self.label, self.icon = label, icon

    ERROR = "Faulty", "ERROR"
    STALE = "Stale", "FILE_REFRESH"
    UNBAKED = "Not baked", "RADIOBUT_OFF"
    UNASKED = "Not checked", "QUESTION"
    BAKING = "Being baked", "RENDER_STILL"
    BAKED = "Baked", "CHECKMARK"


@dataclass(frozen=True)
class Known:
    """What is known of a bake.

    Attributes:
        state: how it stands.
        words: why, and what else there is to say; may be empty.
        late: whether something may have changed since that was asked.
    """

    state: State
    words: str = ""
    late: bool = False

    @property
    def icon(self) -> str:
        """Of lists and panels: what was baked may be stale by now."""
        return State.UNASKED.icon if self.late and self.state is State.BAKED else self.state.icon

    @property
    def sentence(self) -> str:
        """All of it."""
        since = ". Not checked since the last change" if self.late else ""
        words = self.words.removeprefix(NO_BAKE) if self.state is State.UNBAKED else self.words
        between = ": " if words and words == self.words else ""  # else the sentence goes on
        return f"{self.state.label}{between}{words}{since}"


@dataclass(frozen=True)
class _Found:
    """The status of a probe, and the record of the bake that it is of."""

    status: ProbeStatus
    record: str


@dataclass(frozen=True)
class _Checked:
    """What was found in a scene.

    Attributes:
        found: by the probes' session uids.
        seconds: how long that took.
        times: how often the scene was checked since its file was opened.
        late: whether it was changed since.
    """

    found: Mapping[int, _Found]
    seconds: float
    times: int
    late: bool = False


_checked: dict[int, _Checked] = {}  # by the scene's session uid


def of(scene: bpy.types.Scene, probe: bpy.types.Object) -> Known:
    """How the bake of a probe stands."""
    last, record = _checked.get(scene.session_uid), probe.pcc_probe.bake_record
    found = last.found.get(probe.session_uid) if last is not None else None
    bake = running_bake.running()
    if bake is not None and probe.session_uid in bake.being_baked:
        return Known(State.BAKING)
    if found is None:
        return Known(State.UNASKED) if record else Known(State.UNBAKED)
    if found.record != record:
        return Known(State.BAKED, late=True) if record else Known(State.UNBAKED)
    return Known(State[found.status.state.upper()], found.status.words, last.late)


def all_late(scene: bpy.types.Scene) -> bool:
    """Whether something was changed since bakes were checked; they may never have been."""
    last = _checked.get(scene.session_uid)
    return last is None or last.late


def seconds(scene: bpy.types.Scene) -> float | None:
    """How long checking a scene takes; None where nobody knows: the first time, files and modules are read."""
    last = _checked.get(scene.session_uid)
    return last.seconds if last is not None and last.times > 1 else None


def keep(scene: bpy.types.Scene, found: Iterable[ProbeStatus], seconds: float) -> None:
    """Keep how the probes of a scene stand, and how long it took to find out."""
    probes = {probe.name: probe for probe in all_probes(scene)}
    each = ((probes[status.probe], status) for status in found)
    by_uid = {probe.session_uid: _Found(status, probe.pcc_probe.bake_record) for probe, status in each}
    before = _checked.get(scene.session_uid)
    _checked[scene.session_uid] = _Checked(by_uid, seconds, before.times + 1 if before is not None else 1)


def injected(scene: bpy.types.Scene) -> None:
    """All materials were brought up to date, so that none waits for an injection any more."""
    last = _checked.get(scene.session_uid)
    if last is not None:
        found = {uid: replace(each, status=replace(each.status, outdated=())) for uid, each in last.found.items()}
        _checked[scene.session_uid] = replace(last, found=found)


def call_late(scene: bpy.types.Scene) -> None:
    """Something was changed."""
    last = _checked.get(scene.session_uid)
    if last is not None and not last.late:
        _checked[scene.session_uid] = replace(last, late=True)


def forget() -> None:
    """Forget all."""
    _checked.clear()
