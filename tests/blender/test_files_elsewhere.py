"""A file where the add-on is not, after a restart, and in other Blenders: it shows the same and loses nothing."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

import pcc_addon
from tests.blender.filing import check, kept, opened, seen, shown, status, works_again
from tests.blender.helpers import contents, save
from tests.blender.materials import show

SCRIPT = Path(__file__).with_name("other_blender.py")
ALL = sorted(SCRIPT.parents[2].glob(".venvs/bpy-*/bin/python"))
"""The Pythons of Blenders for which `dev.py` has made environments."""
OTHERS = [
    pytest.param(python, id=python.parents[1].name, marks=[] if python in (ALL[0], ALL[-1]) else [pytest.mark.heavy])
    for python in ALL
    if python != Path(sys.executable)
]
"""Those of others than this one; the oldest and the newest are tried always."""


@contextlib.contextmanager
def without_addon() -> Iterator[None]:
    pcc_addon.unregister()
    try:
        yield
    finally:
        pcc_addon.register()


def ask(python: Path, act: str, blend: Path) -> dict[str, object]:
    done = subprocess.run([str(python), str(SCRIPT), act, str(blend)], capture_output=True, text=True, timeout=120)
    told = [line for line in done.stdout.splitlines() if line.startswith("{")]
    assert told, done.stdout[-2000:] + done.stderr[-2000:]
    return json.loads(told[-1])


def test_without_the_add_on_a_file_renders_the_same_and_loses_nothing_when_saved(home: Path) -> None:
    before, had, files = seen(), kept(), contents(home.with_suffix(".pcc"))
    with without_addon():
        opened(home)
        assert not hasattr(bpy.data.objects["Probe"], "pcc_probe") and np.array_equal(seen(), before)
        for _ in range(2):
            save(home)
            opened(home)
            assert np.array_equal(seen(), before)
    opened(home)
    assert kept() == had and np.array_equal(seen(), before) and contents(home.with_suffix(".pcc")) == files
    check()
    works_again()


def test_what_was_edited_without_the_add_on_is_followed_when_it_is_there_again(home: Path) -> None:
    with without_addon():
        opened(home)
        bpy.data.objects["Probe"].name = "Hall"
        show(bpy.data.materials["Wood"], "Shelf")
        bpy.data.materials["Floor"].node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = 1.0
        save(home)
    opened(home)
    assert shown() == ["Hall"] and status("Hall").state == "stale"
    assert not status("Hall").outdated
    works_again()


def test_a_probe_that_was_deleted_without_the_add_on_leaves_no_trace_in_materials(home: Path) -> None:
    with without_addon():
        opened(home)
        bpy.data.objects.remove(bpy.data.objects["Probe"])
        save(home)
    opened(home)
    assert shown() == shown("Wood") == []
    assert [len(bpy.data.materials[name].node_tree.nodes) for name in ("Floor", "Wood")] == [2, 2]


def test_after_a_restart_all_is_as_it_was(home: Path) -> None:
    had, mean = kept(), float(seen(16).mean())
    told = ask(Path(sys.executable), "save", home)
    assert told.pop("mean") == pytest.approx(mean, rel=1e-4) and told == had
    assert ask(Path(sys.executable), "look", home) == {"mean": pytest.approx(mean, rel=1e-4)}


@pytest.mark.parametrize("python", OTHERS)
def test_other_blenders_keep_what_this_one_saved_and_the_other_way_round(home: Path, python: Path) -> None:
    theirs = home.with_name("theirs.blend")
    built = ask(python, "build", theirs)
    opened(theirs)
    assert float(seen(16).mean()) == pytest.approx(built.pop("mean"), rel=1e-3) and kept() == built
    found = status()
    assert found.state == "baked" or "since its bake by Blender" in found.why
    save(theirs)
    told = ask(python, "save", theirs)
    assert told.pop("mean") == pytest.approx(float(seen(16).mean()), rel=1e-3) and told == built
    opened(theirs)
    works_again()
