"""The same jobs from a shell: `pcc SUB FILE.blend …`.

Runs as `python -m pcc_addon` where bpy is installed, and as `blender FILE.blend --command pcc` where the add-on is.
Exit codes: 0 done, 1 some work failed, 2 wrong usage, 130 cancelled.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TextIO

from ..core.errors import Cancelled, PccError
from ..quiet import quiet_blender
from ..stopping import Stop, hold
from .arguments import USAGE, check_paths, parse
from .voice import Voice

DONE, FAILED, CANCELLED = 0, 1, 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run with Blender as a module; returns the exit code."""
    hold()
    options = parse(argv, file_is_open=False)
    with quiet_blender() as out:
        try:
            import bpy  # noqa: F401 — the first import writes to standard output
        except ImportError:
            print("pcc: this Python has no bpy module; install the one for its version with pip", file=sys.stderr)
            return USAGE
        from .. import register, unregister

        register()
        with Stop() as stop:
            try:
                return _run(options, _voice(out, options), stop)
            finally:
                unregister()  # Blender 4.5 as a module crashes at exit where types are left registered


def run_in_blender(argv: list[str]) -> int:
    """Run as a command of a Blender that may have a file open; returns the exit code."""
    import bpy

    try:
        options = parse(argv, file_is_open=bool(bpy.data.filepath))
    except SystemExit as stop:  # Blender must end its own way
        return int(stop.code or 0)
    with quiet_blender() as out, Stop() as stop:
        return _run(options, _voice(out, options), stop)


def _voice(out: TextIO, options: argparse.Namespace) -> Voice:
    return Voice(out, options.json, attended=bool(options.attended))


def _run(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    """Do a command on one file after the other; whatever goes wrong with one, the others have their turn."""
    worst = DONE
    for file in options.files:
        options.file = file
        if len(options.files) > 1:
            voice.begin_file(str(options.file))
        code = _run_on_file(options, voice, stop)
        if code == CANCELLED:
            return code
        worst = max(worst, code)
    return worst


def _run_on_file(options: argparse.Namespace, voice: Voice, stop: Stop) -> int:
    from . import commands

    try:
        stop.check()
        check_paths(options)
        if options.attended:
            commands.attend(options.attended)
        if options.file is not None:
            commands.open_file(options.file)
        stop.check()
        failures = commands.COMMANDS[options.sub](options, voice, stop)
        stop.check()
        if options.sub not in commands.WORK or voice.said(commands.WORK[options.sub]):
            commands.save(options, voice)
        stop.check()
    except (Cancelled, KeyboardInterrupt):
        voice.error(commands.words_of_cancelling(voice))
        return CANCELLED
    except PccError as error:
        voice.error(str(error))
        return FAILED
    if voice.lost is not None:
        voice.error(f"standard output cannot be written ({voice.lost}); what it should have told is lost")
        return FAILED
    return FAILED if failures else DONE
