"""`pcc cost` as a program, and the operator that starts one: killed, resumed, applied, misused."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from pcc_addon.core.accuracy import files
from pcc_addon.core.accuracy.advice import Winner, advice
from tests.blender.cost_scenes import ENOUGH, WIDTH, room_file
from tests.rna_dump import difference, dump

ROOT = Path(__file__).resolve().parents[2]
posix = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX systems")


@pytest.fixture
def blend(scene: bpy.types.Scene, tmp_path: Path) -> Path:
    return room_file(tmp_path)


def start(blend: Path, *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "pcc_addon", "cost", str(blend), "--width", str(WIDTH), *arguments]
    return subprocess.Popen(command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


@posix
@pytest.mark.heavy
def test_a_killed_run_loses_nothing_and_goes_on(blend: Path) -> None:
    before, out, out_blend = blend.read_bytes(), blend.with_suffix(".cost"), blend.with_name("out.blend")
    process = start(blend, "--budget=60")
    told = 0
    for line in process.stdout:
        told += "a frame" in line
        if told == 2:
            break
    process.send_signal(signal.SIGKILL)
    process.communicate()
    kept = files.read(out)
    assert len(kept.measurements) >= 2
    assert blend.read_bytes() == before

    process = start(
        blend, f"--budget={kept.seconds + ENOUGH}", "--resume", "--json", "--apply", "--output", str(out_blend)
    )
    lines, errors = process.communicate(timeout=120)
    assert (process.returncode, errors) == (0, "")
    events = [json.loads(line) for line in lines.splitlines()]
    report = files.read(out)
    assert report.measurements[: len(kept.measurements)] == kept.measurements
    assert len(report.measurements) > len(kept.measurements)
    assert not [path for path in blend.parent.rglob("*") if "unfinished" in path.name or path.suffix == ".part"]
    assert blend.read_bytes() == before
    chosen = report.measurements[advice(report).recommended].settings
    assert next(e for e in events if e["event"] == "applied")["settings"]["resolution"] == chosen.resolution
    bpy.ops.wm.open_mainfile(filepath=str(out_blend))
    own = bpy.data.objects["Room"].pcc_probe
    assert (own.correction, own.resolution, own.samples, own.denoise) == (
        chosen.correction, chosen.resolution, chosen.bake_samples, chosen.bake_denoise,
    )  # fmt: skip


@pytest.mark.heavy
@posix
def test_a_stopped_run_says_what_is_kept(blend: Path) -> None:
    process = start(blend, "--budget=60")
    for line in process.stdout:
        if "a frame" in line:
            break
    process.send_signal(signal.SIGINT)
    lines, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert errors == "pcc: cancelled; nothing was saved\n"
    assert "--resume goes on with it" in lines


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--budget=0"], "'0' is no number above 0"),
        (["--budget=nan"], "'nan' is no number above 0"),
        (["--target-error=oops"], "'oops' is no number above 0"),
        (["--frames=1.5"], "'1.5' is no whole number above 0"),
        (["--budget=5", "--target-error=0.1"], "not allowed with argument"),
        (["--engine=LUX"], "invalid choice"),
    ],
)
def test_wrong_usage_ends_with_2(blend: Path, arguments: list[str], words: str) -> None:
    process = start(blend, *arguments)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert words in errors and len(errors.splitlines()) == 1


@pytest.mark.heavy
def test_the_operator_measures_a_copy_and_applies_to_the_file(blend: Path) -> None:
    bpy.data.objects["Room"].pcc_probe.samples = 2  # not saved, and measured all the same
    dump()
    before, bytes_before = dump(), blend.read_bytes()
    assert bpy.ops.pcc.cost(width=WIDTH, budget=ENOUGH) == {"FINISHED"}
    assert difference(before, dump()) == []
    assert blend.read_bytes() == bytes_before
    assert sorted(path.name for path in blend.parent.iterdir()) == [
        "room.blend",
        "room.blend1",
        "room.cost",
        "room.pcc",
    ]
    report = files.read(blend.with_suffix(".cost"))
    assert report.file == "room.blend" and report.measurements
    assert bpy.ops.pcc.cost(width=WIDTH, budget=ENOUGH, resume=True, apply=True) == {"FINISHED"}
    resumed = files.read(blend.with_suffix(".cost"))
    assert resumed.measurements[: len(report.measurements)] == report.measurements
    own, chosen = bpy.data.objects["Room"].pcc_probe, resumed.measurements[advice(resumed).recommended].settings
    assert (own.resolution, own.samples) == (chosen.resolution, chosen.bake_samples)
    found = advice(resumed)
    assert own.advice == (found.sentences[0] if found.winner is Winner.PATH else "")


def test_the_operator_says_why_it_cannot(blend: Path) -> None:
    bpy.context.scene.camera = None
    with pytest.raises(RuntimeError, match="has no camera; add one"):
        bpy.ops.pcc.cost(width=WIDTH)
