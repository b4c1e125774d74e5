"""The farm's job: `openjd` checks it, and four workers make the pictures of one process, even if one is killed."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest

from pcc_addon.cli import run_in_blender
from tests.blender.helpers import contents, small_probe, small_room

ROOT = Path(__file__).resolve().parents[2]
TEMPLATE = ROOT / "farm" / "template.yaml"
OPENJD = shutil.which("openjd", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
SHARES = 4
needs_openjd = pytest.mark.skipif(OPENJD is None, reason="needs openjd (pip install openjd-cli)")


@needs_openjd
def test_the_template_is_valid() -> None:
    run = subprocess.run([OPENJD, "check", str(TEMPLATE)], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr


def build(path: Path) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    small_room()
    for k in range(3):
        small_probe(f"Probe {k}", capture_offset=(0.3 * k, 0.0, 0.0))
    for item in bpy.data.objects:
        if item.pcc_probe.is_probe:
            item.pcc_probe.effects.levels = "AUTO"
    path.parent.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)


def pictures(folder: Path) -> dict[str, bytes]:
    return {name: data for name, data in contents(folder).items() if name.endswith(".exr")}


def session(blend: Path, step: str, *arguments: str) -> subprocess.Popen[str]:
    """A worker's session."""
    command = [OPENJD, "run", str(TEMPLATE), "--step", step, *arguments, "-p", f"BlendFile={blend}"]
    command += ["-p", f"Shares={SHARES}", "-p", f"Pcc={sys.executable} -m pcc_addon"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def children(process: int) -> list[int]:
    """All processes that one has started, and those have."""
    threads = Path(f"/proc/{process}/task").glob("*/children")
    found = [int(each) for path in threads for each in path.read_text().split()]
    return [*found, *(each for child in found for each in children(child))]


@needs_openjd
@pytest.mark.heavy
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds a worker's processes as Linux tells them")
def test_four_workers_make_the_pictures_of_one_process_though_one_dies(tmp_path: Path) -> None:
    alone, shared = tmp_path / "alone" / "hall.blend", tmp_path / "shared" / "hall.blend"
    build(alone)
    shutil.copytree(alone.parent, shared.parent)
    assert run_in_blender(["bake", str(alone), "--inject", "--save"]) == 0
    workers = [session(shared, "Bake", "-tp", f"Share={k + 1}") for k in range(SHARES)]
    victim = workers[1]
    end = time.monotonic() + 120.0
    while not children(victim.pid):
        assert victim.poll() is None and time.monotonic() < end
        time.sleep(0.02)
    for process in (*children(victim.pid), victim.pid):
        os.kill(process, signal.SIGKILL)
    said = [worker.communicate(timeout=300)[0] for worker in workers]
    assert [worker.returncode == 0 for worker in workers] == [True, False, True, True], said
    last = session(shared, "Assemble", "--no-run-dependencies")
    words = last.communicate(timeout=300)[0]
    assert last.returncode == 0, words
    assert pictures(shared.with_suffix(".pcc")) == pictures(alone.with_suffix(".pcc"))
    assert run_in_blender(["status", str(shared)]) == 0
