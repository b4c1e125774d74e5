"""A whole cost run in this process: what it finds, and that the file is afterwards what it was."""

from __future__ import annotations

import argparse
import io
import json
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.accuracy import job, truth
from pcc_addon.blender.accuracy.bench import apply, own_settings
from pcc_addon.blender.accuracy.job import CostJob
from pcc_addon.blender.accuracy.question import Question
from pcc_addon.cli import cost
from pcc_addon.cli.arguments import parser
from pcc_addon.cli.voice import Voice
from pcc_addon.core.accuracy import files
from pcc_addon.core.accuracy.advice import advice
from pcc_addon.core.accuracy.records import CostReport, Kind, Settings
from pcc_addon.core.errors import Cancelled, PccError
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM
from tests.blender.cost_scenes import HEIGHT, WIDTH, room_file
from tests.rna_dump import difference, dump


@dataclass
class StopAt:
    """Asks to stop when it is asked for the n-th time, or once so many rungs were told."""

    left: int
    out: io.StringIO
    rungs: int

    def check(self) -> None:
        self.left -= 1
        if self.left < 0 or self.out.getvalue().count('"event": "measured"') >= self.rungs:
            raise Cancelled("cancelled")


_BOX = Settings(Kind.PROBE, Engine.CYCLES, "BOX", 64, 1, frame_samples=4)
RUNGS = (
    Settings(Kind.PATH, Engine.CYCLES, "NONE", frame_samples=4),
    Settings(Kind.PATH, Engine.CYCLES, "NONE", frame_samples=16),
    replace(_BOX, correction="NONE"),
    _BOX,
    replace(_BOX, resolution=128, frame_samples=16),
)


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ladder with few rungs, and a truth that is soon good enough: runs end because all is done."""
    monkeypatch.setattr(job, "ladder", lambda *_, **__: RUNGS)
    monkeypatch.setattr(truth, "CLEAN", 0.02)


def asked(blend: Path, *arguments: str) -> argparse.Namespace:
    return parser(file_is_open=False).parse_args(["cost", str(blend), "--width", str(WIDTH), *arguments])


def shell(blend: Path, *arguments: str, stop: int = 10**9, rungs: int = 10**9) -> list[dict]:
    """What the shell's command says as JSON, on the file that is open."""
    out = io.StringIO()
    cost.run(asked(blend, *arguments), Voice(out, as_json=True), StopAt(stop, out, rungs))
    return [json.loads(line) for line in out.getvalue().splitlines()]


def state() -> dict[str, str]:
    dump()  # some properties come into being when they are first read
    return {path: value for path, value in dump().items() if not path.endswith("['levels']")}  # an address


def of(report: CostReport, kind: Kind, correction: str = "NONE") -> list[float]:
    """The errors of some rungs, without that of the probe as it was set: 16 pixels wide."""
    found = [m for m in report.measurements if (m.settings.kind, m.settings.correction) == (kind, correction)]
    return [m.rmse for m in found if m.settings.resolution != 16]


@pytest.mark.heavy
def test_a_box_that_does_not_fit_is_measured_as_a_fit_would_have_it(scene, tmp_path: Path, monkeypatch) -> None:
    """The box is drawn a tenth too large: the fit is what is recommended, and applying it gives the room's box."""
    blend = room_file(tmp_path)
    probe = bpy.data.objects["Room"]
    probe.scale *= 1.1
    bpy.ops.wm.save_mainfile()
    asked_for = []

    def short(*_: object, fits: bool, **__: object) -> tuple[Settings, ...]:
        asked_for.append(fits)
        return (RUNGS[0], _BOX, replace(_BOX, fitted=True))

    monkeypatch.setattr(job, "ladder", short)
    shell(blend, "--apply")
    assert set(asked_for) == {True}
    report = files.read(blend.with_suffix(".cost"))
    drawn, fitted = (
        next(m for m in report.measurements if m.settings == replace(_BOX, fitted=f)) for f in (False, True)
    )
    assert fitted.rmse < 0.5 * drawn.rmse
    assert np.allclose(bpy.data.objects["Room"].scale, EMISSIVE_ROOM.half_extents, rtol=1e-4)


@pytest.mark.heavy
def test_a_box_that_fits_is_not_fitted(scene, tmp_path: Path, monkeypatch) -> None:
    asked_for = []
    monkeypatch.setattr(job, "ladder", lambda *_, fits, **__: asked_for.append(fits) or RUNGS[:1])
    shell(room_file(tmp_path))
    assert set(asked_for) == {False}


def test_a_run_says_what_is_true_of_the_room_and_leaves_the_file_alone(scene: bpy.types.Scene, tmp_path: Path) -> None:
    blend = room_file(tmp_path)
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    before, bytes_before = state(), blend.read_bytes()
    events = shell(blend)
    assert difference(before, state()) == []
    assert blend.read_bytes() == bytes_before

    report = files.read(tmp_path / "room.cost")
    assert (report.file, report.probe, report.camera, report.engine) == ("room.blend", "Room", "Camera", Engine.CYCLES)
    assert (report.width, report.height, report.frames) == (WIDTH, HEIGHT, (1,))
    assert report.truth.noise < 0.02 and report.seconds < 60.0 and 0.3 < report.truth.served < 0.8
    assert {m.settings for m in report.measurements} >= set(RUNGS)
    assert of(report, Kind.PROBE, "NONE")[0] > 0.5 > 0.2 > max(of(report, Kind.PROBE, "BOX"))
    coarse, fine = of(report, Kind.PATH)
    assert fine < 0.7 * coarse
    for measurement in report.measurements:
        probe = measurement.settings.kind is Kind.PROBE
        assert (measurement.bake_seconds > 0.0) == probe and (measurement.megabytes > 0.01) == probe
        assert measurement.samplers == (3 if probe else 2)  # the mirror's one picture
        assert (tmp_path / "room.cost" / measurement.picture).read_bytes().startswith(b"\x89PNG")
        assert measurement.flicker is None and 0.0 < measurement.flip < 1.0

    chosen = report.measurements[advice(report).recommended]
    assert report.afresh.settings == chosen.settings
    assert report.afresh.rmse == pytest.approx(chosen.rmse, rel=0.1)
    assert (tmp_path / "room.cost" / report.heat_map).read_bytes().startswith(b"\x89PNG")
    best = np.load(tmp_path / "room.cost" / "truth.npy")
    assert best.shape == (HEIGHT, WIDTH, 3) and np.isfinite(best).all()
    assert "<img" in (tmp_path / "room.cost" / "cost.html").read_text(encoding="utf-8")
    kinds = [event["event"] for event in events]
    assert kinds.count("measured") == len(report.measurements)
    assert {"truth", "progress", "advice", "afresh", "results"} <= set(kinds)


@pytest.mark.heavy
def test_a_run_ends_in_time(scene: bpy.types.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rungs that would take minutes are not begun, and a bake that turns out to take too long is given up."""
    room_file(tmp_path)
    slow = replace(_BOX, resolution=1024, bake_samples=1024)
    monkeypatch.setattr(job, "ladder", lambda *_, **__: (*RUNGS[:1], slow))
    question = Question(width=WIDTH, budget=20.0)
    report = CostJob(bpy.context.scene, bpy.context.view_layer, question, tmp_path / "out", resume=False).run()
    assert slow not in {m.settings for m in report.measurements}
    assert report.seconds < 20.0

    slow = replace(slow, bake_samples=256)
    monkeypatch.setattr(job, "next_rung", lambda report, rungs, left: slow if left > 0.0 else None)
    question = Question(width=WIDTH, budget=12.0)
    hasty = CostJob(bpy.context.scene, bpy.context.view_layer, question, tmp_path / "out", resume=False)
    report = hasty.run()
    assert slow not in {m.settings for m in report.measurements}
    assert any("did not end in time" in note for note in hasty.notes)


@pytest.mark.parametrize("stop", [0, 3, 11, 18, 24, 30])
def test_cancelled_at_any_step_the_file_is_what_it_was(scene: bpy.types.Scene, tmp_path: Path, stop: int) -> None:
    blend = room_file(tmp_path)
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    before = state()
    with pytest.raises(Cancelled):
        shell(blend, stop=stop)
    assert difference(before, state()) == []


def test_a_run_goes_on_where_it_was_stopped(scene: bpy.types.Scene, tmp_path: Path) -> None:
    blend, out = room_file(tmp_path), tmp_path / "results"
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    with pytest.raises(Cancelled):
        shell(blend, f"--out={out}", rungs=2)
    first = files.read(out)
    assert len(first.measurements) == 2
    events = shell(blend, f"--out={out}", "--resume")
    second = files.read(out)
    assert second.measurements[: len(first.measurements)] == first.measurements
    assert len(second.measurements) > len(first.measurements)
    assert second.truth.samples >= first.truth.samples and second.seconds > first.seconds
    assert f"goes on with {len(first.measurements)} measurement" in events[0]["note"]


def test_another_scene_begins_anew_and_says_so(scene: bpy.types.Scene, tmp_path: Path) -> None:
    blend, out = room_file(tmp_path), tmp_path / "results"
    with pytest.raises(Cancelled):
        shell(blend, f"--out={out}", rungs=1)
    bpy.data.materials["Glow +X"].node_tree.nodes["Checker Texture"].inputs["Color1"].default_value = (0, 0, 0, 1)
    again = CostJob(bpy.context.scene, bpy.context.view_layer, Question(width=WIDTH), out, resume=True)
    again.step()
    again.cancel()
    assert again.report is None
    assert again.notes == ["the scene, the probe or what is asked has changed since: begins anew"]


def test_moving_cameras_show_flicker(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    camera = bpy.context.scene.camera
    for frame, z in ((1, 14.0), (2, 14.2)):
        camera.location.z = z
        camera.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_mainfile()
    question = Question(width=WIDTH, frames=2)
    report = CostJob(bpy.context.scene, bpy.context.view_layer, question, tmp_path / "out", resume=False).run()
    assert report.frames == (1, 2)
    flickers = [m.flicker for m in report.measurements if m.settings.correction != "NONE"]
    assert len(flickers) >= 2 and all(0.0 < flicker < 1.0 for flicker in flickers)  # one that stands still has 1
    assert not np.array_equal(*(np.load(tmp_path / "out" / f"served_{k}.npy") for k in (0, 1)))


def words(question: Question, folder: Path) -> str:
    with pytest.raises(PccError) as caught:
        CostJob(bpy.context.scene, bpy.context.view_layer, question, folder, resume=False).run()
    return str(caught.value)


def test_what_cannot_be_measured_is_said_in_words(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    scene, out = bpy.context.scene, tmp_path / "out"
    assert words(Question(probe="Hall"), out).startswith("no probe is called 'Hall' in scene 'Scene'")
    assert words(Question(camera="Eye"), out) == ("no camera is called 'Eye' in scene 'Scene'; its cameras: 'Camera'")
    scene.camera.rotation_euler.rotate_axis("X", np.pi)
    bpy.context.view_layer.update()
    assert words(Question(width=WIDTH), out).startswith("probe 'Room' serves no pixel that camera 'Camera' sees; turn")
    scene.render.engine = "BLENDER_WORKBENCH"
    assert "renders with BLENDER_WORKBENCH, which shows no probes" in words(Question(), out)
    scene.camera = None
    assert words(Question(engine=Engine.CYCLES), out).startswith("scene 'Scene' has no camera; add one")
    bpy.ops.pcc.probe_add(name="Second")
    assert words(Question(), out).endswith("has 2 probes; say which is to be measured: 'Room', 'Second'")
    (tmp_path / "file").write_text("x")
    question = Question(probe="Room", camera="Camera", engine=Engine.CYCLES)
    assert "cannot make the folder" in words(question, tmp_path / "file" / "below")


def test_own_settings_are_a_rung_that_applies_as_it_was_read(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    probe = bpy.data.objects["Room"]
    own = own_settings(probe, Engine.CYCLES, 16)
    assert own == Settings(Kind.PROBE, Engine.CYCLES, "BOX", 16, 1, frame_samples=16)
    apply(probe, Settings(Kind.PROBE, Engine.CYCLES, "NONE", 128, 64, True, frame_samples=4))
    changed = own_settings(probe, Engine.CYCLES, 4)
    assert (changed.correction, changed.resolution, changed.bake_samples) == ("NONE", 128, 64)
    assert changed.bake_denoise
