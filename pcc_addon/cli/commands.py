"""The subcommands: each does one job on the open file, says what it did, and returns how much of it failed."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import bpy

from ..blender import devices
from ..blender.devices import Devices
from ..blender.planning import plan_scene
from ..blender.saving import save_whole
from ..blender.shade import injection
from ..blender.status import statuses
from ..blender.store import leftovers
from ..core.errors import PccError
from ..core.plan_report import lines, records
from ..core.workplace import real
from ..stopping import Stop
from . import bake, cost, export, fit, misfit
from .injecting import let_show
from .voice import Voice


def attend(by: str) -> None:
    """Work for a Blender that listens, with its devices.

    Args:
        by: its devices, as text.
    """
    devices.choose(Devices.from_json(by))


def open_file(path: Path) -> None:
    """Open a .blend without its windows.

    Raises:
        PccError: Blender cannot open it.
    """
    try:
        bpy.ops.wm.open_mainfile(filepath=str(real(path)), load_ui=False)
    except RuntimeError as error:
        raise PccError(
            f"'{path}' cannot be opened: it is damaged or no .blend file; give a file that Blender opens"
        ) from error


def save(options: argparse.Namespace, voice: Voice) -> None:
    """Save the open file where that was asked for.

    Raises:
        PccError: it could not be written whole.
    """
    if not getattr(options, "save", False) and not getattr(options, "output", None):
        return
    path = real(options.output) if options.output else Path(bpy.data.filepath)
    save_whole(path)
    voice.event("saved", f"saved {path}", file=str(path))


def words_of_cancelling(voice: Voice) -> str:
    """What was and was not done when the user stopped a command."""
    if voice.said("saved"):
        return "cancelled, but the file had been saved already"
    unused = leftovers.unsaved()
    folders = ", ".join(sorted({f"'{path.parent}'" for path in unused}))
    pictures = f"; {len(unused)} new pictures in {folders} belong to no saved file" if unused else ""
    return f"cancelled; nothing was saved{pictures}"


def _inject(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    return let_show(bpy.context.scene, bpy.context.view_layer, voice)


def _remove(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    for name in injection.remove():
        voice.event("restored", f"material '{name}' restored", material=name)
    return 0


def _plan(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    if options.json:
        for record in records(plan):
            voice.event("plan", "", **record)
    else:
        for line in lines(plan):
            voice.event("plan", line)
    return 0


def _status(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    found = statuses(bpy.context.scene, bpy.context.view_layer)
    if not found:
        raise PccError(f"scene '{bpy.context.scene.name}' has no parallax probe; add one")
    for status in found:
        why = f": {status.words}" if status.words else ""
        voice.event("status", f"{status.probe}: {status.state}{why}", **asdict(status))
    if options.clean:
        gone = leftovers.clean()
        for path in gone:
            voice.event("removed", f"removed {path}", file=str(path))
    return sum(status.state == "error" for status in found)


COMMANDS: dict[str, Callable[[argparse.Namespace, Voice, Stop], int]] = {
    "bake": bake.run,
    "fit": fit.run,
    "inject": _inject,
    "remove": _remove,
    "plan": _plan,
    "status": _status,
    "cost": cost.run,
    "misfit": misfit.run,
    "export": export.run,
}
# What must have happened before a file is saved, by command; others save whatever they did.
WORK = {"bake": "baked", "fit": "applied"}
