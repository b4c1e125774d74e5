"""The bake that runs beside an open window, its timer's ticks made by hand."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest

from pcc_addon.blender import devices, handlers, planning, writing
from pcc_addon.blender.bake import background
from pcc_addon.blender.devices import Devices
from pcc_addon.blender.shade import injection
from pcc_addon.blender.shade.preparing import Preparation
from pcc_addon.ui.kept import idle, running_bake
from pcc_addon.ui.kept import showing as kept_showing
from pcc_addon.ui.kept import states as kept_states
from pcc_addon.ui.kept.showing import Showing
from pcc_addon.ui.kept.states import State
from tests.blender.background_bakes import PATIENCE, Tape, begin, play
from tests.blender.filing import shown
from tests.blender.helpers import save, small_probe
from tests.blender.test_adoption import blend, tape, the_probe  # noqa: F401
from tests.blender.test_background import states


@pytest.fixture(autouse=True)
def _stopped() -> None:
    yield
    running_bake.cancel()
    running_bake.forget()


def ticks() -> int:
    """Tick until the bake has ended."""
    end, count = time.monotonic() + PATIENCE, 0
    while running_bake._tick() is not None:
        assert time.monotonic() < end, "it never ends"
        count += 1
        time.sleep(0.001)
    return count


def test_each_probe_is_an_undo_step_of_its_own(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.ed.undo_push(message="opened")
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe(), the_probe("Second")))
    assert not bpy.ops.pcc.bake.poll() and bpy.ops.pcc.bake_cancel.poll()
    assert ticks() > 2
    assert running_bake.running() is None and bpy.ops.pcc.bake.poll() and not bpy.ops.pcc.bake_cancel.poll()
    assert states() == {"Probe": "baked", "Second": "baked"}
    bpy.ops.ed.undo()
    assert states() == {"Probe": "baked", "Second": "unbaked"}
    bpy.ops.ed.undo()
    assert states() == {"Probe": "stale", "Second": "unbaked"}
    for _ in range(2):
        bpy.ops.ed.redo()
    assert states() == {"Probe": "baked", "Second": "baked"}


def test_what_became_of_it_is_told_until_it_is_hidden(blend, monkeypatch, tape) -> None:  # noqa: F811
    play(monkeypatch, tape, [("Second", -11)])
    running_bake.begin(begin(the_probe(), the_probe("Second")))
    ticks()
    told = running_bake.outcome()
    assert told.done.startswith("Baked 'Probe' in ") and len(told.errors) == 1 and "'Second'" in told.errors[0]
    bpy.ops.pcc.bake_forget()
    assert running_bake.outcome() is None


def showing() -> Showing:
    return Showing.of(bpy.context.scene, bpy.context.view_layer)


def test_each_probe_is_shown_by_the_step_after_the_one_that_bakes_it(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.remove()
    bpy.ops.ed.undo_push(message="opened")
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()), showing())
    ticks()
    assert shown() == ["Probe"] and "Probes show in 1 material" in running_bake.outcome().done
    bpy.ops.ed.undo()
    assert shown() == [] and states()["Probe"] == "baked"
    bpy.ops.ed.undo()
    assert shown() == [] and states()["Probe"] == "stale"
    for _ in range(2):
        bpy.ops.ed.redo()
    assert shown() == ["Probe"] and states()["Probe"] == "baked"


def nothing() -> None:
    """What is planned holds."""


def rename() -> None:
    bpy.data.materials["Floor"].name = "Ground"


def hide() -> None:
    floor = bpy.data.materials["Floor"]
    next(item for item in bpy.data.objects if item.active_material == floor).hide_render = True
    bpy.context.view_layer.update()


@pytest.mark.parametrize(("change", "again"), [(nothing, 0), (rename, 1), (hide, 1)])
def test_a_plan_is_obeyed_in_the_next_round_unless_something_changed(
    blend,  # noqa: F811
    monkeypatch,
    tape,  # noqa: F811
    change: Callable[[], None],
    again: int,
) -> None:
    bpy.ops.pcc.remove()
    floor = bpy.data.materials["Floor"]
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()), showing())
    while running_bake._planned is None:
        assert running_bake._tick() is not None
    assert shown(floor) == []
    change()
    asked = []
    monkeypatch.setattr(injection, "read_and_plan", lambda *of: asked.append(True) or planning.read_and_plan(*of))
    ticks()
    assert len(asked) == again
    assert shown(floor) == ([] if change is hide else ["Probe"])


def begin_showing(monkeypatch: pytest.MonkeyPatch, tape: Tape) -> bpy.types.Material:  # noqa: F811
    """A bake that has begun to be shown, by one step in each round; returns the floor's material."""
    bpy.ops.pcc.remove()
    bpy.ops.ed.undo_push(message="opened")
    play(monkeypatch, tape)
    monkeypatch.setattr(running_bake, "AT_ONCE", 1e-9)
    running_bake.begin(begin(the_probe()), showing())
    while running_bake._steps is None:
        assert running_bake._tick() is not None
    return bpy.data.materials["Floor"]


def test_materials_show_it_a_few_in_each_round_and_are_one_undo_step(blend, monkeypatch, tape) -> None:  # noqa: F811
    floor = begin_showing(monkeypatch, tape)
    assert shown(floor) == []
    assert ticks() > 2
    assert shown(floor) == ["Probe"]
    bpy.ops.ed.undo()
    assert shown() == [] and states()["Probe"] == "baked"
    bpy.ops.ed.redo()
    assert shown() == ["Probe"]


def test_an_undo_while_it_is_being_shown_calls_that_off(blend, monkeypatch, tape) -> None:  # noqa: F811
    begin_showing(monkeypatch, tape)
    bpy.ops.ed.undo()
    ticks()
    assert shown() == [] and states()["Probe"] == "stale"
    bpy.ops.ed.redo()
    assert shown() == [] and states()["Probe"] == "baked"


def test_what_is_removed_while_it_is_being_shown_is_not_missed(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.data.materials.remove(begin_showing(monkeypatch, tape))
    ticks()
    assert running_bake.outcome().errors == () and states()["Probe"] != "unbaked"


def test_a_bake_that_is_undone_before_it_was_shown_may_be_redone(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.remove()
    bpy.ops.ed.undo_push(message="opened")
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()), showing())
    while states()["Probe"] != "baked":
        assert running_bake._tick() is not None
    bpy.ops.ed.undo()
    ticks()
    assert shown() == [] and states()["Probe"] == "stale"
    bpy.ops.ed.redo()
    assert states()["Probe"] == "baked"


def test_how_bakes_stand_is_asked_again_once_one_is_shown(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.status()
    bpy.context.view_layer.update()
    bpy.ops.pcc.status()
    assert not kept_states.all_late(bpy.context.scene)
    play(monkeypatch, tape)
    asked = []
    monkeypatch.setattr(idle, "expect", lambda: asked.append(True))
    running_bake.begin(begin(the_probe()), showing())
    ticks()
    assert kept_states.all_late(bpy.context.scene) and asked


def test_no_probe_has_its_bake_before_what_shows_it_is_ready(blend, monkeypatch, tape) -> None:  # noqa: F811
    """Also after an undo, which may take away what was."""
    bpy.ops.pcc.remove()
    bpy.ops.ed.undo_push(message="opened")
    bpy.ops.ed.undo_push(message="something")
    play(monkeypatch, tape)
    ready, asked = [False], []
    monkeypatch.setattr(Preparation, "step", lambda self: asked.append(self) or not ready[0])
    running_bake.begin(begin(the_probe()), showing())
    for _ in range(40):
        assert running_bake._tick() is not None
    assert running_bake.running().waiting and states()["Probe"] == "stale"
    ready[0] = True
    running_bake._tick()
    bpy.ops.ed.undo()
    count = len(asked)
    ticks()
    assert len(asked) > count and states()["Probe"] == "baked" and shown() == ["Probe"]


def test_what_needs_no_bake_is_shown_too_and_is_undone(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.remove()
    bpy.ops.ed.undo_push(message="opened")
    play(monkeypatch, Tape((), tape.files))
    running_bake.begin(begin(the_probe()), showing())
    ticks()
    assert shown() == ["Probe"] and "nothing has changed since. Probes show in" in running_bake.outcome().done
    bpy.ops.ed.undo()
    assert shown() == []


def test_nothing_is_shown_while_somebody_else_works(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.remove()
    play(monkeypatch, Tape((), tape.files))
    running_bake.begin(begin(the_probe()), showing())
    with handlers.paused():
        ticks()
    assert shown() == [] and "until the end of another job" in running_bake.outcome().errors[0]


def test_what_cannot_be_shown_says_why(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.remove()
    the_probe().pcc_probe.bake_record = ""
    play(monkeypatch, Tape((), tape.files))
    running_bake.begin(begin(the_probe()), showing())
    ticks()
    assert shown() == [] and "'Probe'" in running_bake.outcome().errors[0] and not running_bake.outcome().done


def test_a_scene_that_is_gone_is_not_shown(scene) -> None:
    small_probe()
    gone = showing()
    bpy.ops.scene.new(type="EMPTY")
    bpy.data.scenes.remove(scene)
    assert gone.in_materials() == ""
    gone.in_viewport()


@pytest.mark.parametrize(
    ("engine", "before", "after"),
    [
        ("CYCLES", "SOLID", "RENDERED"),
        ("CYCLES", "WIREFRAME", "RENDERED"),
        ("CYCLES", "MATERIAL", "MATERIAL"),
        ("BLENDER_WORKBENCH", "SOLID", "MATERIAL"),
    ],
)
def test_a_viewport_without_materials_shows_what_renders_show(monkeypatch, engine, before, after) -> None:
    def view(width: int) -> SimpleNamespace:
        space = SimpleNamespace(shading=SimpleNamespace(type=before))
        return SimpleNamespace(type="VIEW_3D", width=width, height=10, spaces=SimpleNamespace(active=space))

    scene = SimpleNamespace(render=SimpleNamespace(engine=engine))
    small, large = view(5), view(10)
    here = SimpleNamespace(scene=scene, screen=SimpleNamespace(areas=[small, large, SimpleNamespace(type="INFO")]))
    other = SimpleNamespace(scene=None, screen=SimpleNamespace(areas=[elsewhere := view(20)]))
    manager = SimpleNamespace(windows=[here, other])
    monkeypatch.setattr(kept_showing, "bpy", SimpleNamespace(context=SimpleNamespace(window_manager=manager)))
    kept_showing.show_rendered(scene)
    assert [each.spaces.active.shading.type for each in (small, large, elsewhere)] == [before, after, before]


def known(name: str) -> State:
    return kept_states.of(bpy.context.scene, the_probe(name)).state


def test_what_was_found_of_the_bake_before_is_told_no_more(blend, monkeypatch, tape) -> None:  # noqa: F811
    bpy.ops.pcc.status()
    assert known("Probe") is State.STALE and known("Second") is State.UNBAKED
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()))
    ticks()
    assert known("Probe") is State.BAKED and known("Second") is State.UNBAKED


def test_cancelled_by_its_button_it_says_so(blend, monkeypatch, tape) -> None:  # noqa: F811
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()))
    running_bake._tick()
    bpy.ops.pcc.bake_cancel()
    assert running_bake.running() is None and running_bake._tick() is None
    assert running_bake.outcome().done.startswith("Bake cancelled") and states()["Probe"] == "stale"


def test_opening_a_file_ends_it(blend, monkeypatch, tape) -> None:  # noqa: F811
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()))
    running_bake._tick()
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert running_bake.running() is None and running_bake.outcome() is None and states()["Probe"] == "stale"
    assert not [path for path in blend.parent.rglob("*") if "unfinished" in path.name]


def test_it_waits_while_somebody_else_works(blend, monkeypatch, tape) -> None:  # noqa: F811
    play(monkeypatch, tape)
    running_bake.begin(begin(the_probe()))
    with handlers.paused():
        for _ in range(40):
            assert running_bake._tick() is not None
        assert running_bake.words() == "'Probe' is baked and waits for the end of another job"
        assert states()["Probe"] == "stale"
    ticks()
    assert states()["Probe"] == "baked"


def window(active: bpy.types.Object | None = None, *tools: object) -> SimpleNamespace:
    layer = SimpleNamespace(objects=SimpleNamespace(active=active))
    return SimpleNamespace(windows=[SimpleNamespace(view_layer=layer, modal_operators=tools)])


def tool(idname: str, *options: str) -> SimpleNamespace:
    return SimpleNamespace(bl_idname=idname, name=idname, bl_options=set(options))


@pytest.mark.parametrize(
    ("found", "why"),
    [
        (window(), ""),
        (window(SimpleNamespace(mode="OBJECT", name="Cube")), ""),
        (window(SimpleNamespace(mode="POSE", name="Rig")), ""),
        (window(SimpleNamespace(mode="EDIT", name="Cube")), "Edit Mode of 'Cube'"),
        (window(SimpleNamespace(mode="TEXTURE_PAINT", name="Cube")), "Texture Paint of 'Cube'"),
        (window(None, tool("TRANSFORM_OT_translate")), "'TRANSFORM_OT_translate'"),
        (window(None, tool("PCC_OT_cost", "UNDO")), ""),  # on a copy
        (window(None, tool("PCC_OT_fit", "UNDO")), "'PCC_OT_fit'"),
        (window(None, tool("PCC_OT_plan", "REGISTER")), ""),  # of an add-on, and may run for ever
    ],
)
def test_what_has_to_end_before_data_may_be_changed(scene, found: SimpleNamespace, why: str) -> None:
    assert writing.why_not_now(found) == why


def test_a_render_has_to_end_before(scene, monkeypatch) -> None:
    running = SimpleNamespace(app=SimpleNamespace(is_job_running=lambda kind: kind == "RENDER"), types=bpy.types)
    monkeypatch.setattr(writing, "bpy", running)
    assert writing.why_not_now(window()) == "a render"


def test_a_painted_image_is_named_since_a_copy_cannot_have_it(scene, tmp_path: Path, monkeypatch, tape) -> None:  # noqa: F811
    from tests.blender.test_adoption import two_probes

    two_probes()
    save(tmp_path / "room.blend")
    play(monkeypatch, tape)
    assert begin(the_probe()).notes == []
    image = bpy.data.images.new("Rug", 4, 4)
    image.pixels[0] = 1.0
    [note] = begin(the_probe()).notes
    assert note.startswith("image 'Rug' was painted and is not saved")


def test_devices_are_those_of_the_blender_that_asks(scene) -> None:
    here = devices.chosen()
    assert Devices.from_json(here.to_json()) == here
    devices.choose(Devices("NO SUCH KIND", ("a",)))
    assert devices.chosen() == here
    settings = bpy.context.preferences.addons["cycles"].preferences
    kinds = [kind for kind, *_ in settings.get_device_types(bpy.context)]
    try:
        for kind in kinds:
            devices.choose(Devices(kind, ()))
            assert devices.chosen() == Devices(kind, ())
    finally:
        devices.choose(here)


@pytest.mark.parametrize(
    ("left", "said"),
    [
        (None, "face +X"),
        (0.3, "face +X"),
        (5.4, "face +X, about 5.0 s left"),
        (204.0, "face +X, about 3 min 20 s left"),
    ],
)
def test_the_time_that_is_left_is_said_in_steps_that_one_can_read(monkeypatch, left: float | None, said: str) -> None:
    job = SimpleNamespace(waiting=[], seconds_left=left, message="face +X", cancel=lambda: None, results=[], notes=[])
    monkeypatch.setattr(running_bake, "_running", job)
    assert running_bake.words() == said


def test_what_is_left_follows_from_how_long_pieces_took(monkeypatch) -> None:
    clock, now = background._Clock(), [0.0]
    monkeypatch.setattr(background.time, "monotonic", lambda: now[0])
    assert clock.seconds_left is None
    clock.reached(0.2)  # of five pieces the first is begun
    assert clock.seconds_left is None
    now[0] = 10.0
    clock.reached(0.4)
    assert clock.seconds_left == pytest.approx(40.0), "the second is begun, and four are not done"
    now[0] = 15.0
    assert clock.seconds_left == pytest.approx(35.0)
    now[0] = 99.0
    assert clock.seconds_left == 0.0
