"""What is shown to judge by: it changes what is looked at and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import judging
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.judging import View
from pcc_addon.blender.shade import groups
from pcc_addon.blender.shade.injection import remove
from pcc_addon.blender.status import statuses
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.core.effects.lookup import lookup_formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.ui.kept import last_misfit
from pcc_addon.ui.operators.judge import Judged, judged
from tests.blender.helpers import bake, picture, put_in, save, small_room
from tests.rna_dump import difference, dump
from tests.shader_harness import evaluate_group

JUDGED = [View.UNCORRECTED, View.OFF]


@pytest.fixture(autouse=True)
def _corrected_again(_registered: None) -> Iterator[None]:
    yield
    judging.show(View.CORRECTED)


@pytest.fixture
def probe(scene) -> bpy.types.Object:
    """Baked, and shown by the floor of its room."""
    probe = small_room()
    bake(probe)
    put_in()
    return probe


def everything(*kinds: str) -> dict[str, str]:
    """A dump of all data, or of some kinds, read twice: some properties come into being when they are first read."""
    wanted = [kinds] if kinds else []
    dump(*wanted)
    return dump(*wanted)


def seen() -> View:
    """What the open file shows."""
    nodes = bpy.data.materials["Floor"].node_tree.nodes
    active = next(n for n in nodes if n.bl_idname == "ShaderNodeOutputMaterial" and n.is_active_output)
    if active.name == "Material Output":
        return View.OFF
    [corrects] = groups.parallax_nodes()
    return View.UNCORRECTED if corrects.mute else View.CORRECTED


@pytest.mark.parametrize("view", JUDGED)
def test_each_view_is_shown_and_taken_back_exactly(probe, view: View) -> None:
    before = everything()
    judging.show(view)
    assert judging.view() is view and seen() is view and difference(before, everything())
    judging.show(View.CORRECTED)
    assert seen() is View.CORRECTED and difference(before, everything()) == []


def test_outputs_for_each_engine_are_taken_back_exactly(probe) -> None:
    material = bpy.data.materials["Floor"]
    remove()
    nodes = material.node_tree.nodes
    [first] = [node for node in nodes if node.bl_idname == "ShaderNodeOutputMaterial"]
    second = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(first.inputs["Surface"].links[0].from_socket, second.inputs["Surface"])
    first.target, second.target = "CYCLES", "EEVEE"
    put_in()
    before = everything()
    judging.show(View.OFF)
    assert [material.node_tree.get_output_node(engine) for engine in ("CYCLES", "EEVEE")] == [first, second]
    judging.show(View.CORRECTED)
    assert difference(before, everything()) == []
    assert material.node_tree.get_output_node("CYCLES") not in (first, second)


@pytest.mark.parametrize("view", JUDGED)
def test_saved_files_are_corrected_and_viewports_go_on(probe, tmp_path: Path, view: View, without_mending) -> None:
    judging.show(view)
    save(tmp_path / "room.blend")
    assert seen() is view
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    assert seen() is View.CORRECTED


@pytest.fixture
def without_mending() -> Iterator[None]:
    """What is opened stays as it is."""
    bpy.app.handlers.load_post.remove(judging.on_load)
    yield
    bpy.app.handlers.load_post.append(judging.on_load)


@pytest.mark.parametrize("view", JUDGED)
def test_what_a_crash_left_is_corrected_when_it_is_opened(probe, tmp_path: Path, view: View) -> None:
    judging.show(view)
    bpy.app.handlers.save_pre.remove(judging.before_save)  # as a file that Blender writes by itself
    try:
        save(tmp_path / "room.blend")
    finally:
        bpy.app.handlers.save_pre.append(judging.before_save)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    assert seen() is View.CORRECTED and judging.view() is View.CORRECTED


@pytest.mark.parametrize("view", JUDGED)
def test_renders_are_corrected(probe, view: View) -> None:
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 8
    judging.show(view)
    rendered = []
    look = lambda *_: rendered.append(seen())  # noqa: E731
    bpy.app.handlers.render_pre.append(look)
    try:
        bpy.ops.render.render()
    finally:
        bpy.app.handlers.render_pre.remove(look)
    assert rendered == [View.CORRECTED] and seen() is view


@pytest.mark.parametrize("view", JUDGED)
def test_bakes_are_corrected(probe, view: View) -> None:
    before = picture(probe).copy()
    judging.show(view)
    job = BakeJob(bpy.context.scene, bpy.context.view_layer, [probe], bake_folder(bpy.context.scene))
    while job.step():
        assert seen() is View.CORRECTED
    assert seen() is view and np.array_equal(picture(probe), before)


@pytest.mark.parametrize("view", JUDGED)
def test_nothing_is_stale_or_to_be_injected_again(probe, view: View) -> None:
    judging.show(view)
    bpy.context.view_layer.update()
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert status.state == "baked", status


def test_undo_brings_back_neither_the_view_nor_what_it_hid(probe) -> None:
    def change(roughness: float) -> None:
        bpy.data.objects["Probe"].pcc_probe.falloff = roughness
        bpy.context.view_layer.update()
        bpy.ops.ed.undo_push(message="falloff")

    change(0.3)
    judging.show(View.OFF)
    change(0.4)
    change(0.5)
    bpy.ops.ed.undo()
    assert seen() is View.OFF
    bpy.ops.ed.undo()
    assert seen() is View.OFF, "the step was made before"
    judging.show(View.UNCORRECTED)
    bpy.ops.ed.redo()
    assert seen() is View.UNCORRECTED, "the step was made while it was off"
    judging.show(View.CORRECTED)
    bpy.ops.ed.undo()
    bpy.ops.ed.redo()
    assert seen() is View.CORRECTED


@pytest.mark.parametrize("view", JUDGED)
def test_what_is_injected_meanwhile_is_shown_alike(probe, view: View) -> None:
    remove()
    judging.show(view)
    put_in()
    bpy.context.view_layer.update()
    assert seen() is view


def test_removing_meanwhile_restores_materials_exactly(scene) -> None:
    bake(small_room())
    before = everything("materials")
    put_in()
    judging.show(View.OFF)
    remove()
    assert difference(before, everything("materials")) == []


LOOKUPS = [
    LookupEffects(Correction.ALIGNED_BOX, Outside.OWN),
    LookupEffects(Correction.TURNED_BOX, None, offset=True),
    LookupEffects(Correction.ORIENTED_BOX, Outside.BLACK, hardening=True),
    LookupEffects(Correction.ORIENTED_BOX, Outside.UNCORRECTED),
]


@pytest.mark.parametrize("effects", LOOKUPS, ids=lambda effects: effects.label)
def test_uncorrected_looks_up_along_the_ray_itself(scene, monkeypatch, effects: LookupEffects) -> None:
    rng = np.random.default_rng(1)
    formula = lookup_formula(effects)
    tree = groups.formula_group(formula)
    values = {name: rng.uniform(0.5, 1.0, (8, 3)[: 1 + (part.width == 3)]) for name, part in formula.inputs.items()}
    values["Direction"] /= np.linalg.norm(values["Direction"], axis=1, keepdims=True)
    corrected = evaluate_group(tree, values, ["Direction"])["Direction"]
    assert np.abs(corrected - values["Direction"]).max() > 0.1
    monkeypatch.setattr(judging, "_hold", lambda reason: None)  # the harness renders
    judging.show(View.UNCORRECTED)
    found = evaluate_group(tree, values, ["Direction"])["Direction"]
    assert found == pytest.approx(values["Direction"], abs=1e-6)


def test_the_switch_measures_a_misfit_that_nobody_knows_and_only_that(probe) -> None:
    manager, scene = bpy.context.window_manager, bpy.context.scene
    assert bpy.ops.pcc.judge(view="MISFIT") == {"FINISHED"}
    known = last_misfit.of(scene, probe)
    assert manager.pcc_show_misfit and known.found.misfit is not None
    bpy.ops.pcc.judge(view="OFF")
    assert not manager.pcc_show_misfit and seen() is View.OFF and judged(manager) is Judged.OFF
    bpy.ops.pcc.judge(view="MISFIT")
    assert last_misfit.of(scene, probe).found is known.found and seen() is View.CORRECTED
    assert judged(manager) is Judged.MISFIT
    bpy.ops.pcc.judge(view="CORRECTED")
    assert not manager.pcc_show_misfit and judged(manager) is Judged.CORRECTED
