"""What may be asked for: subcommands, options, and paths that can be used."""

from __future__ import annotations

import argparse
import os
import stat
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from ..core.errors import PccError
from ..core.export.targets import TARGETS
from ..core.shares import Share
from .cost_options import add_cost_options

USAGE = 2
_LONGEST_NAME = 240  # bytes of a file name that every system allows, with some left for the backup's


class _Parser(argparse.ArgumentParser):
    """Wrong usage is one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(USAGE, f"{self.prog}: {' '.join(message.split())}; see {self.prog} --help\n")


def parser(file_is_open: bool) -> argparse.ArgumentParser:
    """The command line; the .blend may be left out where one is open."""
    whole = _Parser(prog="pcc", description="Bake parallax probes and put them into materials.")
    subs = whole.add_subparsers(dest="sub", required=True, metavar="SUB", parser_class=_Parser)

    def sub(name: str, text: str, saves: bool = True) -> argparse.ArgumentParser:
        command = subs.add_parser(name, help=text, description=text)
        several = {None: "+", "?": "*"} if name == "bake" else {}
        how_many = "?" if file_is_open else None
        command.add_argument("file", nargs=several.get(how_many, how_many), type=Path, metavar="FILE.blend")
        command.add_argument("--json", action="store_true", help="one JSON object a line on standard output")
        # Of a Blender that listens and shows the outcome: it ends with that one, and renders with the same devices.
        command.add_argument("--attended", default="", help=argparse.SUPPRESS)
        if saves:
            command.add_argument("--save", action="store_true", help="save the file in place")
            command.add_argument("--output", type=Path, metavar="OUT.blend", help="save to another file")
        return command

    bake = sub("bake", "render what the probes see")
    bake.add_argument("--probe", action="append", metavar="NAME", help="only this probe (may be repeated)")
    bake.add_argument("--stale", action="store_true", help="only probes whose bake is missing or out of date")
    bake.add_argument("--scene", metavar="NAME", help="whose probes (otherwise those of the file's scene)")
    bake.add_argument("--view-layer", metavar="NAME", help="what they see of it (otherwise the file's)")
    bake.add_argument("--folder", type=Path, metavar="DIR", help="write the pictures there (the scene's folder)")
    bake.add_argument("--inject", action="store_true", help="then let the materials show them")
    bake.add_argument("--engine", choices=["CYCLES", "EEVEE"], type=str.upper, help="set the probes' engine")
    bake.add_argument("--resolution", type=int, metavar="PX", help="set the probes' face width")
    bake.add_argument("--samples", type=int, metavar="N", help="set the probes' samples")
    bake.add_argument(
        "--frames",
        metavar="A-B[:STEP]",
        help="bake the probes for these frames, one picture for each thing that they see; 'still' for the file's "
        "frame alone (otherwise as each was last baked)",
    )
    bake.add_argument(
        "--picture", type=Path, metavar="FILE", help="let the probes show this cubemap (a file, or one of six faces)"
    )
    bake.add_argument(
        "--resume", action="store_true", help="go on where a bake was stopped or killed, and keep what has not changed"
    )
    bake.add_argument(
        "--jobs", type=int, default=1, metavar="N", help="let N processes share each file's probes (implies --resume)"
    )
    bake.add_argument(
        "--share", metavar="K/N", help="do the K-th of N shares alone; then --resume makes bakes of all (for farms)"
    )
    bake.add_argument("--manifest", type=Path, metavar="FILE", help="write there what was done, a line of JSON a probe")
    bake.add_argument(
        "--allow-missing-textures", action="store_true", help="missing image files, baked in pink, are no failure"
    )
    add_cost_options(sub("cost", "measure how good a probe is, what that costs in time, and what to set"))
    fit = sub("fit", "say how the probes' boxes fit the rooms around them, and make them fit")
    fit.add_argument("--probe", action="append", metavar="NAME", help="only this probe (may be repeated)")
    fit.add_argument(
        "--apply", action="store_true", help="give the probes the boxes and capture points that were found"
    )
    fit.add_argument(
        "--render",
        action="store_true",
        help="say what that does to the camera's picture, against path tracing (about a minute for each probe)",
    )
    sub("inject", "let the materials show the baked probes")
    sub("remove", "restore the materials")
    sub("plan", "say which materials show which probe, and why others do not", saves=False)
    status = sub("status", "say which probes are baked, stale or faulty", saves=False)
    status.add_argument(
        "--clean", action="store_true", help="remove leftovers of bakes that are surely ours and that no file shows"
    )
    lying = sub("misfit", "say how the probes' boxes lie to the room, and what they do not see", saves=False)
    lying.add_argument("--probe", action="append", metavar="NAME", help="only this probe (may be repeated)")
    lying.add_argument("--out", type=Path, metavar="DIR", help="write pictures of it into this folder")
    export = sub("export", "write baked probes for another engine", saves=False)
    export.add_argument("--to", type=Path, required=True, metavar="DIR", help="write into this folder")
    export.add_argument(
        "--target", required=True, choices=[target.key for target in TARGETS], type=str.lower, help="for which engine"
    )
    export.add_argument("--probe", action="append", metavar="NAME", help="only this probe (may be repeated)")
    export.add_argument(
        "--width", type=int, metavar="PX", help="of the cubemaps' faces, a power of two (otherwise the probe's)"
    )
    return whole


def parse(argv: Sequence[str] | None, file_is_open: bool) -> argparse.Namespace:
    """The options; `files` are those to work on, the largest first; None stands for the one that is open.

    Wrong usage ends the program.
    """
    whole = parser(file_is_open)
    options = whole.parse_args(argv)
    files = options.file if isinstance(options.file, list) else [options.file]
    options.files = sorted(dict.fromkeys(files), key=_size, reverse=True) or [None]
    options.file = options.files[0]
    if options.sub != "bake":
        return options
    if len(options.files) > 1 and options.output:
        whole.error("--output names one file; give one, or --save")
    if options.jobs < 1:
        whole.error(f"--jobs {options.jobs}: give 1 or more")
    if options.share is not None:
        try:
            Share.parse(options.share)
        except PccError as error:
            whole.error(str(error))
        if options.save or options.output or options.inject or options.jobs > 1:
            whole.error("--share leaves saving, injecting and other shares to others; do that with --resume afterwards")
    return options


def _size(path: Path | None) -> int:
    try:
        return path.stat().st_size if path else 0
    except (OSError, ValueError):
        return 0


def check_paths(options: argparse.Namespace) -> None:
    """Refuse files that cannot be opened or saved, before anything is done.

    Raises:
        PccError: names the path and what to do.
    """
    if options.file is not None and not _is(options.file, Path.is_file):
        if _is(options.file, Path.is_dir):
            raise PccError(f"'{options.file}' is a folder; name a .blend file in it")
        if _is(options.file, Path.exists):
            raise PccError(f"'{options.file}' is a pipe or a device; name a .blend file on a disk")
        raise PccError(f"file '{options.file}' does not exist; check the path")
    if options.file is not None and getattr(options, "save", False):
        _check_writable(options.file)
    output = getattr(options, "output", None)
    if output is None:
        return
    if len(os.fsencode(output.name)) > _LONGEST_NAME:
        raise PccError(f"output '{output}': its name is longer than {_LONGEST_NAME} bytes; choose a shorter one")
    if not _is(output.absolute().parent, Path.is_dir):
        raise PccError(f"folder '{output.absolute().parent}' does not exist; make it first")
    if _is(output, Path.is_dir):
        raise PccError(f"output '{output}' is a folder; name a file")
    if _is(output, Path.exists):
        if not _is(output, Path.is_file):
            raise PccError(f"output '{output}' is a pipe or a device; name a file")
        _check_writable(output)
    if output.suffix != ".blend":
        raise PccError(f"output '{output}' does not end in .blend; rename it")


def _check_writable(path: Path) -> None:
    """Refuse a file that its owner protects; another would be moved into its place all the same."""
    if not path.stat().st_mode & stat.S_IWUSR or not os.access(path, os.W_OK):
        raise PccError(f"'{path}' is write-protected; allow writing, or save elsewhere with --output")


def _is(path: Path, question: Callable[[Path], bool]) -> bool:
    try:
        return question(path)
    except (OSError, ValueError):  # a name that the system does not allow
        return False
