"""Stopped, killed, or talking to nobody: nothing half done stays, and the exit code says what happened."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import pytest

from pcc_addon.cli import run_in_blender
from pcc_addon.stopping import Stop
from sample_blends.scenes import empty_scene

from .tally import fault

ROOT = Path(__file__).resolve().parents[2]
LONG = ["--resolution", "256", "--samples", "64"]
posix = pytest.mark.skipif(os.name != "posix", reason="signals and descriptors of POSIX systems")


@pytest.fixture
def blend(tmp_path: Path) -> Path:
    """A saved file with two probes in the dark; afterwards no file is open."""
    empty_scene()
    for name in ("First", "Second"):
        bpy.ops.pcc.probe_add(name=name, half_extents=(2, 2, 2))
        bpy.data.objects[name].pcc_probe.resolution = 16
        bpy.data.objects[name].pcc_probe.samples = 1
    (tmp_path / "tmp").mkdir()
    (tmp_path / "files").mkdir()
    path = tmp_path / "files" / "hall.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def start(blend: Path, *arguments: str, **settings: object) -> subprocess.Popen[str]:
    """The program, with a folder for temporary files of its own."""
    command = [sys.executable, "-m", "pcc_addon", arguments[0], str(blend), *arguments[1:]]
    environment = {**os.environ, "TMPDIR": str(blend.parents[1] / "tmp")}
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **settings}
    return subprocess.Popen(command, cwd=ROOT, env=environment, text=True, **streams)


def wait_for(process: subprocess.Popen[str], words: str) -> None:
    for line in process.stdout:
        if words in line:
            return
    pytest.fail(f"it never said '{words}'")


def ended(process: subprocess.Popen[str]) -> tuple[int, list[str]]:
    """Exit code and the lines on standard error, none of which may be a traceback."""
    _, errors = process.communicate(timeout=120)
    assert "Traceback" not in errors and "Exception" not in errors, errors
    return process.returncode, errors.splitlines()


@pytest.mark.sweep
@posix
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_stopped_bake_ends_with_130_and_leaves_nothing_but_faces_to_go_on_from(blend: Path, name: str) -> None:
    before = blend.read_bytes()
    process = start(blend, "bake", *LONG, "--save")
    wait_for(process, "face -X")
    process.send_signal(getattr(signal, name))
    with fault("signals"):
        assert ended(process) == (130, ["pcc: cancelled; nothing was saved"])
        assert blend.read_bytes() == before
        faces = blend.with_suffix(".pcc") / ".faces"
        left = {path for path in blend.parents[1].rglob("*") if path.parent != faces}
        assert left == {blend.parent, blend, blend.parents[1] / "tmp", faces.parent, faces}
        assert {path.suffix for path in faces.iterdir()} == {".npz"}


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="looks at what a process has loaded, as Linux tells")
def test_a_signal_while_blender_starts_ends_with_130(blend: Path) -> None:
    process = start(blend, "status")
    maps = Path(f"/proc/{process.pid}/maps")
    while "/bpy/" not in maps.read_text():
        time.sleep(0.005)
    process.send_signal(signal.SIGINT)
    assert ended(process) == (130, ["pcc: cancelled; nothing was saved"])


@pytest.mark.sweep
@pytest.mark.parametrize("sub", ["inject", "remove", "status", "plan", "bake"])
def test_every_subcommand_answers_a_signal_before_it_saves(
    capfd: pytest.CaptureFixture[str], blend: Path, monkeypatch: pytest.MonkeyPatch, sub: str
) -> None:
    from pcc_addon.cli import commands

    command = commands.COMMANDS[sub]

    def interrupted(options: object, voice: object, stop: Stop) -> int:
        signal.raise_signal(signal.SIGTERM)
        return command(options, voice, stop)

    run_in_blender(["bake", str(blend), "--save"])
    before = blend.read_bytes()
    monkeypatch.setitem(commands.COMMANDS, sub, interrupted)
    capfd.readouterr()
    assert run_in_blender([sub, str(blend), *(["--save"] if sub in ("bake", "inject", "remove") else [])]) == 130
    assert capfd.readouterr().err.startswith("pcc: cancelled; nothing was saved")
    assert blend.read_bytes() == before


def test_what_was_baked_before_the_signal_is_told(capfd: pytest.CaptureFixture[str], blend: Path, monkeypatch) -> None:
    from pcc_addon.blender.store import levels

    store = levels.store

    def stored(*arguments: object, **options: object) -> None:
        store(*arguments, **options)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(levels, "store", stored)
    assert run_in_blender(["bake", str(blend), "--save", "--json"]) == 130
    out = capfd.readouterr()
    assert [json.loads(line)["probe"] for line in out.out.splitlines() if '"baked"' in line] == ["First"]
    assert f"new pictures in '{blend.with_suffix('.pcc')}' belong to no saved file" in out.err


def test_a_signal_after_saving_is_answered_truthfully(
    capfd: pytest.CaptureFixture[str], blend: Path, monkeypatch
) -> None:
    from pcc_addon.cli import commands

    save = commands.save

    def saved(*arguments: object) -> None:
        save(*arguments)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(commands, "save", saved)
    assert run_in_blender(["bake", str(blend), "--save"]) == 130
    assert "saved already" in capfd.readouterr().err


def test_a_second_signal_does_not_wait() -> None:
    with Stop() as stop:
        signal.raise_signal(signal.SIGINT)
        assert stop.asked
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


@posix
def test_a_closed_terminal_stops_what_nobody_told_to_outlive_it() -> None:
    before = signal.getsignal(signal.SIGHUP)
    try:
        for handler, asked in ((signal.SIG_DFL, True), (signal.SIG_IGN, False)):
            signal.signal(signal.SIGHUP, handler)
            with Stop() as stop:
                signal.raise_signal(signal.SIGHUP)
                assert stop.asked is asked
            assert signal.getsignal(signal.SIGHUP) == handler
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.heavy
@posix
def test_what_a_killed_bake_left_is_removed_by_the_next(blend: Path) -> None:
    process = start(blend, "bake", *LONG)
    wait_for(process, "face -X")
    process.kill()
    process.communicate()
    tmp = blend.parents[1] / "tmp"
    assert len(list(tmp.glob("pcc-*"))) == 1
    running = start(blend, "bake", *LONG)
    wait_for(running, "face -X")
    [theirs] = tmp.glob("pcc-*")
    assert ended(start(blend, "bake"))[0] == 0
    assert list(tmp.glob("pcc-*")) == [theirs], "a bake that runs keeps its own"
    running.terminate()
    assert ended(running)[0] == 130


def closed_pipe() -> int:
    read, write = os.pipe()
    os.close(read)
    return write


OUTPUTS: dict[str, Callable[[], int]] = {
    "a closed pipe": closed_pipe,
    "a full disk": lambda: os.open("/dev/full", os.O_WRONLY),
}


@pytest.mark.sweep
@posix
@pytest.mark.parametrize("output", OUTPUTS)
@pytest.mark.parametrize("arguments", [("bake", "--save", "--json"), ("status",)], ids=lambda a: a[0])
def test_where_nobody_can_be_told_the_work_is_done_and_the_exit_code_says_so(
    blend: Path, output: str, arguments: tuple[str, ...]
) -> None:
    if output == "a full disk" and not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    descriptor = OUTPUTS[output]()
    code, lines = ended(start(blend, *arguments, stdout=descriptor))
    os.close(descriptor)
    assert code == 1 and len(lines) == 1 and "standard output cannot be written" in lines[0]
    assert arguments[0] == "status" or len(list(blend.with_suffix(".pcc").glob("*.json"))) == 2


@pytest.mark.sweep
@posix
@pytest.mark.parametrize("closed", [(1,), (0, 1, 2)])
def test_closed_streams_are_no_fault(blend: Path, closed: tuple[int, ...]) -> None:
    def close() -> None:
        for number in closed:
            os.close(number)

    code, lines = ended(start(blend, "bake", "--save", preexec_fn=close))
    assert (code, lines) == (0, [])
    assert len(list(blend.with_suffix(".pcc").glob("*.json"))) == 2
