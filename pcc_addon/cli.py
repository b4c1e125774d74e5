"""The same jobs from a shell: `pcc SUB FILE.blend …`.

Runs as `python -m pcc_addon` where bpy is installed, and as `blender FILE.blend --command pcc` where the add-on is.
Exit codes: 0 done, 1 some work failed, 2 wrong usage, 130 cancelled.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NoReturn, TextIO

from .core.errors import Cancelled, PccError
from .quiet import quiet_blender

DONE, FAILED, USAGE, CANCELLED = 0, 1, 2, 130
_LONGEST_NAME = 240  # bytes of a file name that every system allows, with some left for temporary names


class _Parser(argparse.ArgumentParser):
    """Wrong usage is one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(USAGE, f"{self.prog}: {message}; see {self.prog} --help\n")


def _parser(file_is_open: bool) -> argparse.ArgumentParser:
    parser = _Parser(prog="pcc", description="Bake parallax probes and put them into materials.")
    subs = parser.add_subparsers(dest="sub", required=True, metavar="SUB", parser_class=_Parser)

    def sub(name: str, text: str, saves: bool = True) -> argparse.ArgumentParser:
        command = subs.add_parser(name, help=text, description=text)
        how_many = "?" if file_is_open else None
        command.add_argument("file", nargs=how_many, type=Path, metavar="FILE.blend")
        command.add_argument("--json", action="store_true", help="one JSON object a line on standard output")
        if saves:
            command.add_argument("--save", action="store_true", help="save the file in place")
            command.add_argument("--output", type=Path, metavar="OUT.blend", help="save to another file")
        return command

    bake = sub("bake", "render what the probes see")
    bake.add_argument("--probe", action="append", metavar="NAME", help="only this probe (may be repeated)")
    bake.add_argument("--stale", action="store_true", help="only probes whose bake is missing or out of date")
    bake.add_argument("--inject", action="store_true", help="then let the materials show them")
    bake.add_argument("--engine", choices=["CYCLES", "EEVEE"], type=str.upper, help="set the probes' engine")
    bake.add_argument("--resolution", type=int, metavar="PX", help="set the probes' face width")
    bake.add_argument("--samples", type=int, metavar="N", help="set the probes' samples")
    bake.add_argument(
        "--allow-missing-textures", action="store_true", help="missing image files, baked in pink, are no failure"
    )
    sub("inject", "let the materials show the baked probes")
    sub("remove", "restore the materials")
    sub("plan", "say which materials show which probe, and why others do not", saves=False)
    sub("status", "say which probes are baked, stale or faulty", saves=False)
    return parser


class _Voice:
    """What the command says: sentences for people, or JSON lines; never Blender's own chatter."""

    def __init__(self, out: TextIO, as_json: bool) -> None:
        self._out, self._as_json = out, as_json
        self._kinds: set[str] = set()

    def said(self, kind: str) -> bool:
        """Whether such an event has been told."""
        return kind in self._kinds

    def event(self, kind: str, text: str, **details: object) -> None:
        """Something happened: a line of JSON, or `text`."""
        self._kinds.add(kind)
        line = json.dumps({"event": kind, **details}) if self._as_json else text
        print(line, file=self._out, flush=True)

    def progress(self, fraction: float, message: str) -> None:
        self.event("progress", f"{fraction:4.0%} {message}", progress=round(fraction, 4), message=message)

    def error(self, text: str) -> None:
        """A failure, in one line, on standard error too where standard output is for machines."""
        line = " ".join(text.split())
        if self._as_json:
            self.event("error", line, error=line)
        print(f"pcc: {line}", file=sys.stderr, flush=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Run with Blender as a module; returns the exit code."""
    options = _parser(file_is_open=False).parse_args(argv)
    with quiet_blender() as out:
        try:
            import bpy  # noqa: F401 — the first import writes to standard output
        except ImportError:
            print("pcc: this Python has no bpy module; install the one for its version with pip", file=sys.stderr)
            return USAGE
        from . import register, unregister

        register()
        try:
            return _run(options, _Voice(out, options.json))
        finally:
            unregister()  # Blender 4.5 as a module crashes at exit where types are left registered


def run_in_blender(argv: list[str]) -> int:
    """Run as a command of a Blender that may have a file open; returns the exit code."""
    import bpy

    try:
        options = _parser(file_is_open=bool(bpy.data.filepath)).parse_args(argv)
    except SystemExit as stop:  # Blender must end its own way
        return int(stop.code or 0)
    with quiet_blender() as out:
        return _run(options, _Voice(out, options.json))


def _run(options: argparse.Namespace, voice: _Voice) -> int:
    try:
        _check_paths(options)
        if options.file is not None:
            _open(options.file)
        failures = _COMMANDS[options.sub](options, voice)
        if options.sub != "bake" or voice.said("baked"):
            _save(options, voice)
    except (Cancelled, KeyboardInterrupt):
        voice.error("cancelled; nothing was saved")
        return CANCELLED
    except PccError as error:
        voice.error(str(error))
        return FAILED
    return FAILED if failures else DONE


def _check_paths(options: argparse.Namespace) -> None:
    if options.file is not None and not _is_file(options.file):
        raise PccError(f"file '{options.file}' does not exist; check the path")
    output = getattr(options, "output", None)
    if output is not None and len(os.fsencode(output.name)) > _LONGEST_NAME:
        raise PccError(f"output '{output}': its name is longer than {_LONGEST_NAME} bytes; choose a shorter one")
    if output is not None and not output.resolve().parent.is_dir():
        raise PccError(f"folder '{output.resolve().parent}' does not exist; make it first")
    if output is not None and output.suffix != ".blend":
        raise PccError(f"output '{output}' does not end in .blend; rename it")


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name that the system does not allow
        return False


def _open(path: Path) -> None:
    import bpy

    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False)
    except RuntimeError as error:
        raise PccError(
            f"'{path}' cannot be opened: it is damaged or no .blend file; give a file that Blender opens"
        ) from error


def _save(options: argparse.Namespace, voice: _Voice) -> None:
    import bpy

    from .blender.saving import save_whole

    if not getattr(options, "save", False) and not getattr(options, "output", None):
        return
    path = options.output.resolve() if options.output else Path(bpy.data.filepath)
    save_whole(path)
    voice.event("saved", f"saved {path}", file=str(path))


def _bake(options: argparse.Namespace, voice: _Voice) -> int:
    import bpy

    from .blender.bake.job import BakeJob
    from .blender.read.probes import all_probes, named_probes
    from .blender.status import stale_probes
    from .blender.store.levels import bake_folder

    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    probes = named_probes(scene, options.probe) if options.probe else all_probes(scene)
    if not probes:
        raise PccError(f"scene '{scene.name}' has no parallax probe; add one with Add > Light Probe > Parallax Probe")
    _apply_settings(options, probes)
    if options.stale:
        probes = stale_probes(scene, view_layer, probes)
    folder = bake_folder(scene, str(options.output.resolve()) if options.output else None)
    job = BakeJob(scene, view_layer, probes, folder)
    with _interruptible() as interrupted:
        while job.step():
            if interrupted:
                job.cancel()
                raise Cancelled("cancelled")
            voice.progress(job.progress, job.message)
    failures = 0
    for line in job.missing_textures:
        failures += not options.allow_missing_textures
        voice.error(f"{line}, and bake again; until then it is baked in pink")
    for result in job.results:
        if result.error is None:
            text = f"baked '{result.probe}' in {result.seconds:.1f} s"
            voice.event("baked", text, **asdict(result))
            for line in (*result.replaced_pixels, *result.warnings):
                voice.event("note", f"probe '{result.probe}': {line}", probe=result.probe, note=line)
        else:
            failures += 1
            voice.error(result.error)
    if options.inject and any(result.error is None for result in job.results):
        failures += _inject(options, voice)
    return failures


def _apply_settings(options: argparse.Namespace, probes: Sequence) -> None:
    from .core.probe import MAXIMUM_RESOLUTION, MINIMUM_RESOLUTION, MOST_SAMPLES

    if options.resolution is not None and not MINIMUM_RESOLUTION <= options.resolution <= MAXIMUM_RESOLUTION:
        raise PccError(
            f"--resolution {options.resolution}: choose between {MINIMUM_RESOLUTION} and {MAXIMUM_RESOLUTION} pixels"
        )
    if options.samples is not None and not 1 <= options.samples <= MOST_SAMPLES:
        raise PccError(f"--samples {options.samples}: choose between 1 and {MOST_SAMPLES}")
    for name in ("engine", "resolution", "samples"):
        value = getattr(options, name)
        if value is not None:
            for probe in probes:
                setattr(probe.pcc_probe, name, value)


@contextlib.contextmanager
def _interruptible() -> Iterator[list[int]]:
    """A list that fills when the user interrupts, so that work stops between two steps."""
    seen: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: seen.append(number))
    try:
        yield seen
    finally:
        # None: Blender's own C code had it, and Python cannot give it back.
        signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)


def _inject(options: argparse.Namespace, voice: _Voice) -> int:
    import bpy

    from .blender.shade.injection import inject

    report = inject(bpy.context.scene, bpy.context.view_layer)
    for material, probe in report.materials:
        voice.event("injected", f"material '{material}' shows '{probe}'", material=material, probe=probe)
    for note in report.notes:
        voice.event("note", note, note=note)
    return 0


def _remove(options: argparse.Namespace, voice: _Voice) -> int:
    from .blender.shade.injection import remove

    for name in remove():
        voice.event("restored", f"material '{name}' restored", material=name)
    return 0


def _plan(options: argparse.Namespace, voice: _Voice) -> int:
    import bpy

    from .blender.planning import plan_scene
    from .core.plan_report import lines, records

    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    if options.json:
        for record in records(plan):
            voice.event("plan", "", **record)
    else:
        for line in lines(plan):
            voice.event("plan", line)
    return 0


def _status(options: argparse.Namespace, voice: _Voice) -> int:
    import bpy

    from .blender.status import statuses

    found = statuses(bpy.context.scene, bpy.context.view_layer)
    if not found:
        raise PccError(f"scene '{bpy.context.scene.name}' has no parallax probe; add one")
    for status in found:
        why = f": {status.why}" if status.why else ""
        voice.event("status", f"{status.probe}: {status.state}{why}", **asdict(status))
    return sum(status.state == "error" for status in found)


_COMMANDS = {"bake": _bake, "inject": _inject, "remove": _remove, "plan": _plan, "status": _status}
