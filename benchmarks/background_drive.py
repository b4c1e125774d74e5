"""Runs inside a real Blender: how long its window stands still while probes are baked in the background, and by what.

`blender FILE --python background_drive.py -- RESULT.json` writes what it measured and ends Blender.
"""

from __future__ import annotations

import json
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
PACKAGE = next(name for name in sys.modules if name.endswith("pcc_addon"))
RUNNING = sys.modules[f"{PACKAGE}.ui.kept.running_bake"]
REDRAWING = sys.modules[f"{PACKAGE}.ui.kept.redrawing"]
OFTEN = 0.25  # seconds: as often as the bake's timer may let panels be drawn
QUIET_FOR = 20.0  # seconds
TICK = 1e-4  # seconds that sums of moments may be off
SHORTLY = 1.0  # seconds, in which what shows a new bake is drawn


@dataclass
class Round:
    """One round of the event loop.

    Attributes:
        begin: a moment, seconds.
        wall: how long it took, seconds.
        cpu: processor time of the interface's thread in it.
        ours: the same, of the add-on's own code alone.
        adopts: whether a probe was given its new bake, or it was planned or shown.
    """

    begin: float = 0.0
    wall: float = 0.0
    cpu: float = 0.0
    ours: float = 0.0
    adopts: bool = False


_rounds: list[Round] = []
_now = Round()
_inside = False
_before = (0.0, 0.0)


def beat() -> float:
    """A round ends and another begins; this waits for nothing in between."""
    global _now, _before
    at = (time.perf_counter(), time.thread_time())
    _now.begin, _now.wall, _now.cpu = _before[0], at[0] - _before[0], at[1] - _before[1]
    _rounds.append(_now)
    _now, _before = Round(), at
    return 0.0


def measured(work: Callable[..., object]) -> Callable[..., object]:
    """A function of ours whose processor time is noted, unless another one of ours calls it."""

    def called(*arguments: object, **named: object) -> object:
        global _inside
        if _inside:
            return work(*arguments, **named)
        _inside, begin = True, time.thread_time()
        try:
            return work(*arguments, **named)
        finally:
            _inside = False
            _now.ours += time.thread_time() - begin

    return called


def adopting(work: Callable[[], None]) -> Callable[[], None]:
    """A function in whose rounds probes take their bakes or are shown."""

    def called() -> None:
        _now.adopts = True
        work()

    return called


def measure_ours() -> None:
    """Note the time of all that Blender calls of ours while a file lies open: timers, handlers, panels, lists."""
    for kind in (bpy.types.Panel, bpy.types.UIList, bpy.types.Header, bpy.types.Menu, bpy.types.GizmoGroup):
        for cls in kind.__subclasses__():
            for name in ("draw", "draw_item", "filter_items", "draw_header_preset", "refresh", "draw_prepare"):
                if cls.__module__.startswith(PACKAGE) and name in cls.__dict__:
                    setattr(cls, name, measured(cls.__dict__[name]))
    for handlers in (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.undo_post):
        for index, handler in enumerate(handlers):
            if handler.__module__.startswith(PACKAGE):
                handlers[index] = bpy.app.handlers.persistent(measured(handler))
    for name in ("_adopt_next", "_plan", "_show_more"):
        setattr(RUNNING, name, adopting(getattr(RUNNING, name)))
    RUNNING._tick = measured(RUNNING._tick)


def summary(rounds: list[Round]) -> dict[str, float]:
    """Of some rounds: how many, the longest in seconds, and what was at most whose in any."""
    return {
        "rounds": len(rounds),
        "longest": max(each.wall for each in rounds),
        "of its thread": max(each.cpu for each in rounds),
        "Blender's": max(each.cpu - each.ours for each in rounds),
        "ours": max(each.ours for each in rounds),
    }


def baked(show: bool) -> Iterator[float]:
    """Bake; returns what starting took, and the rounds."""
    begin = time.thread_time()
    bpy.ops.pcc.bake("INVOKE_DEFAULT", scope="ALL", show=show)
    starting = time.thread_time() - begin
    yield 0.0  # the round of the start itself is no part of it
    yield 0.0
    _rounds.clear()
    while RUNNING.running() is not None:
        yield 0.1
    yield SHORTLY
    assert not RUNNING.outcome().errors, RUNNING.outcome()
    rounds = list(_rounds)
    adopting = [each for each in rounds if each.adopts]
    assert adopting, "no probe was baked"
    ends = [each.begin + each.wall for each in adopting]
    drawing = [e for e in rounds if not e.adopts and any(-TICK < e.begin - end < SHORTLY for end in ends)]
    rest = [each for each in rounds if each not in adopting and each not in drawing]
    return {
        "starting": starting,
        "baking": summary(rest),
        "adopting": summary(adopting),
        "drawing what is new": summary(drawing),
    }


def steps() -> Iterator[float]:
    """What is done; each yields after how many seconds it goes on."""
    preferences = bpy.context.preferences
    preferences.view.show_splash, preferences.use_preferences_save = False, False
    area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")
    area.spaces.active.show_region_ui = True
    yield 1.0
    for region in area.regions:
        if region.type == "UI":
            region.active_panel_category = "Probes"
    measure_ours()
    bpy.app.timers.register(beat)
    yield 3.0
    found: dict[str, object] = {}
    _rounds.clear()
    for _ in range(round(QUIET_FOR / OFTEN)):
        REDRAWING.redraw_panels()
        yield OFTEN
    found["nothing baked"] = summary(list(_rounds))
    found["bake"] = yield from baked(show=False)
    found["bake and show"] = yield from baked(show=True)
    RESULT.write_text(json.dumps(found), encoding="utf-8")


def main() -> None:
    going = steps()

    def step() -> float | None:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            try:
                return next(going)
            except StopIteration:
                pass
            except Exception:
                RESULT.write_text(json.dumps({"error": traceback.format_exc()}), encoding="utf-8")
            bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(step, first_interval=1.0)


main()
