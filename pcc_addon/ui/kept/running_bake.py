"""The bake that runs in a second Blender: a timer takes its news and lets probes have what is whole, panels show it.

Where materials are to show it, what they need is made ready meanwhile, and no probe has its bake before.
"""

from __future__ import annotations

import atexit
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy

from ...blender import handlers, unrecorded
from ...blender.bake.background import BackgroundBake
from ...blender.bake.job import BakedProbe
from ...blender.listening import listen, stop_listening
from ...blender.shade.preparing import AT_ONCE
from ...blender.writing import why_not_now
from ...core.accuracy import labels
from ...core.errors import PccError
from ...core.words import named
from .redrawing import redraw_panels

if TYPE_CHECKING:
    from ...blender.planning import PlannedScene
    from ...blender.shade.preparing import Preparation
    from ...blender.stepping import Steps
    from .showing import Showing

_BETWEEN = 0.25  # seconds
_BETWEEN_STEPS = 0.05  # of a preparation, which are shorter
_MOST_NAMES = 4  # that fit a panel
_NOTHING_TO_DO = "All probes that anything shows are baked, and nothing has changed since"


@dataclass(frozen=True)
class Outcome:
    """What became of the last bake.

    Attributes:
        done: in words; empty: nothing was baked.
        errors, notes: sentences for the user.
    """

    done: str
    errors: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


_running: BackgroundBake | None = None
_more = False  # whether it has not ended
_showing: Showing | None = None
_preparation: Preparation | None = None
_prepared = False
_unseen: list[str] = []  # probes that have their bakes and are to be shown next
_planned: PlannedScene | None = None  # what materials are to show of these, unless something changes before they do
_steps: Steps[str] | None = None  # what lets them, as soon as it has begun
_shown, _unshown = "", ""  # in words: what materials show of this bake, or why they do not
_outcome: Outcome | None = None
_waits_for = ""
_drawn = ""


def running() -> BackgroundBake | None:
    """The bake that runs, or None."""
    return _running


def outcome() -> Outcome | None:
    """What became of the last bake of the open file, until another begins; None: there was none."""
    return _outcome


def begin(bake: BackgroundBake, showing: Showing | None = None) -> None:
    """Let a bake run; there is no other one.

    Args:
        bake: it.
        showing: shows each probe as soon as it has its new bake, and in the end those that needed none; None: nobody.
    """
    global _running, _more, _showing, _preparation, _prepared, _planned, _steps, _shown, _unshown, _outcome
    _running, _more, _showing, _shown, _unshown, _outcome = bake, True, showing, "", "", None
    _preparation, _prepared, _planned, _steps = None, showing is None, None, None
    _unseen.clear()
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.0, persistent=True)
    _redraw()


def cancel() -> None:
    """Stop the bake that runs; probes that have their new bakes keep them."""
    if _running is not None:
        _running.cancel()
        _end("Bake cancelled; probes that were not finished keep their old bakes")


def forget() -> None:
    """Forget what became of the last bake."""
    global _outcome
    _outcome = None
    _redraw()


def words() -> str:
    """What the bake that runs is doing."""
    if _running.waiting and _waits_for:
        return f"'{_running.waiting[0].probe}' is baked and waits for the end of {_waits_for}"
    left = _running.seconds_left
    if left is None or left < 1.0:
        return _running.message
    step = 1.0 if left < 60.0 else 10.0  # panels are drawn whenever it changes
    return f"{_running.message}, about {labels.seconds(step * round(left / step))} left"


def _tick() -> float | None:
    """Take the news and adopt a bake that is whole, where nobody is disturbed by it."""
    global _more, _waits_for
    if _running is None:
        return None
    try:
        _more = _more and _running.step()
        if _running.waiting or _unseen or not _prepared:
            _waits_for = why_not_now(bpy.context.window_manager)
            if not _waits_for:
                _go_on()
    except PccError as error:
        _end("", (str(error),))
        return None
    except BaseException:
        _running.cancel()
        _end("")
        raise
    if not _more and not _unseen and (_prepared or _waits_for):
        _show_all()
        _end("", [_unshown] * bool(_unshown))
        return None
    if words() != _drawn:
        _redraw()
    return _BETWEEN if _prepared or _waits_for else _BETWEEN_STEPS


def _go_on() -> None:
    """Do one thing in this window, so that it does not stand still for two."""
    if not _prepared:
        _prepare()
    elif _steps is not None:
        _show_more()
    elif _running.waiting:
        _adopt_next()
    elif _planned is None:
        _plan()
    else:
        _begin_to_show()
        _show_more()


def _prepare() -> None:
    """Make ready a little more of what materials will call, in the first step find out what that is."""
    global _preparation, _prepared
    if _preparation is None:
        _preparation = _showing.preparation()
        _prepared = _preparation is None
    else:
        _prepared = not _preparation.step()


def _plan() -> None:
    """Find out what materials are to show of the probes that have just got their bakes."""
    global _planned
    _planned = _showing.plan()
    if _planned is None:  # the scene is gone
        _unseen.clear()


def _adopt_next() -> None:
    """Let a probe have its bake, as an undo step of its own."""
    global _planned
    _planned = None
    window = bpy.context.window_manager.windows[0]
    window.view_layer.update()  # what a script has just changed is followed; what is changed here need not be
    with bpy.context.temp_override(window=window), handlers.paused():
        result = _running.adopt_next()
        if result.error is None:
            bpy.ops.ed.undo_push(message=f"Bake '{result.probe}'")
            if _showing is not None:
                _unseen.append(result.probe)
    _redraw()


def _begin_to_show() -> None:
    """Let materials show the probes that have just got their bakes, as an undo step of its own."""
    global _planned, _steps
    _steps, _planned = _showing.steps(_planned), None


def _show_more() -> None:
    """Let a few more materials show them."""
    global _steps
    end = time.monotonic() + AT_ONCE
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window), handlers.paused(), unrecorded.following():
        try:
            while (more := _goes_on()) and time.monotonic() < end:
                pass
        except ReferenceError:  # somebody removed what was next: all is planned again
            _steps = None
            return
        window.view_layer.update()  # what is changed here need not be followed
    if not more:
        names = named(_unseen)
        _unseen.clear()
        _record(f"Show {names}")
        _redraw()


def _goes_on() -> bool:
    """Do the next piece of what `_steps` does; False where that was the last one."""
    global _steps, _shown, _unshown
    try:
        next(_steps)
    except StopIteration as end:
        _steps, _shown, _unshown = None, end.value, ""
    except PccError as error:
        _steps, _shown, _unshown = None, "", str(error)
    return _steps is not None


def _record(step: str) -> None:
    """Take an undo step of that name, where anything is shown."""
    if _shown:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.ed.undo_push(message=step)


def _show_all() -> None:
    """The bake has ended: what it left as it was is shown too, and the viewport shows all of it."""
    global _shown, _unshown
    if _showing is None:
        return
    if not any(result.error is None for result in _running.results):
        if busy := why_not_now(bpy.context.window_manager):
            _unshown = f"materials are left as they are until the end of {busy}: press Inject into Materials then"
            return
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            try:
                _shown, _unshown = _showing.in_materials(), ""
            except PccError as error:
                _shown, _unshown = "", str(error)
        _record("Show Probes")
    if _shown:
        _showing.in_viewport()


def _end(done: str, errors: Sequence[str] = ()) -> None:
    """Tell what became of the bake, and let it go."""
    global _running, _showing, _preparation, _steps, _outcome, _waits_for
    results, notes = _running.results, _running.notes
    _running, _showing, _preparation, _steps, _waits_for = None, None, None, None, ""
    _unseen.clear()
    _outcome = _outcome_of(results, notes, done, errors)
    _redraw()


def _outcome_of(results: Sequence[BakedProbe], notes: Sequence[str], done: str, errors: Sequence[str]) -> Outcome:
    baked = [result for result in results if result.error is None]
    said = f"Baked {_named(baked)}" if baked else ""
    found = [f"probe '{r.probe}': {line}" for r in baked for line in (*r.replaced_pixels, *r.warnings)]
    failed = [result.error for result in results if result.error is not None]
    nothing = "" if baked or failed or errors else _NOTHING_TO_DO
    what = "; ".join(filter(None, (done, said))) or nothing
    return Outcome(". ".join(filter(None, (what, _shown))), (*errors, *failed), (*notes, *found))


def _named(baked: Sequence[BakedProbe]) -> str:
    if len(baked) <= _MOST_NAMES:
        return ", ".join(map(str, baked))
    return f"{len(baked)} probes in {labels.seconds(sum(result.seconds for result in baked))}"


def _redraw() -> None:
    global _drawn
    _drawn = words() if _running is not None else ""
    redraw_panels()


def _stop() -> None:
    """End the second Blender; nothing is shown any more."""
    global _running
    if _running is not None:
        _running.cancel()
        _running = None


@bpy.app.handlers.persistent
def before_undo(*_: object) -> None:
    """What was made ready may be gone."""
    global _prepared, _steps
    _steps = None
    if _preparation is not None:
        _preparation.start_over()
        _prepared = False
    _unseen.clear()  # another step now would take the way forward again


@bpy.app.handlers.persistent
def on_load(*_: object) -> None:
    """Another file is open, which has none of the probes."""
    cancel()
    forget()


_HANDLERS = (("undo_pre", before_undo), ("redo_pre", before_undo), ("load_post", on_load))


def register() -> None:
    listen(_HANDLERS)
    atexit.register(_stop)


def unregister() -> None:
    _stop()
    atexit.unregister(_stop)
    stop_listening(_HANDLERS)
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
