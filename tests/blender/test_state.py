"""A bake leaves no trace: whatever happens in it, the file is afterwards what it was before."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.bake import faces
from pcc_addon.blender.bake.capture import Stage
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.shade import injection, twin
from pcc_addon.blender.store import levels
from pcc_addon.core import equirect
from pcc_addon.core.errors import BakeError
from sample_blends.scenes import principled, principled_node
from tests.blender.helpers import ROOM, bake, glow, picture, small_room
from tests.rna_dump import difference, dump


class Broken(Exception):
    """What the tests raise inside a bake."""


def complete() -> dict[str, str]:
    """A dump of the whole file."""
    bpy.context.view_layer.update()
    return dump()


def settled() -> dict[str, str]:
    """The same, read twice: some properties come into being when they are first read."""
    complete()
    return complete()


def add_quad(name: str, material: bpy.types.Material, x: float, collection: bpy.types.Collection) -> bpy.types.Object:
    """A square metre across the room's x axis, `x` metres from its centre."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, -0.5, -0.5), (0, 0.5, -0.5), (0, 0.5, 0.5), (0, -0.5, 0.5)], [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    item = bpy.data.objects.new(name, mesh)
    item.location = (ROOM.centre[0] + x, ROOM.centre[1], ROOM.centre[2])
    collection.objects.link(item)
    return item


@pytest.fixture
def probe(scene) -> bpy.types.Object:
    """A baked probe in a room with a blurred receiver, one that shows the probe already, and an area lamp."""
    probe = small_room()
    principled_node(bpy.data.materials["Floor"]).inputs["Roughness"].default_value = 0.3
    bake(probe)
    injection.inject(scene, bpy.context.view_layer)
    add_quad("New", principled("New", Roughness=0.6), 1.0, scene.collection)
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    lamp.location = ROOM.centre
    scene.collection.objects.link(lamp)
    make_unusual(scene)
    return probe


def make_unusual(scene: bpy.types.Scene) -> None:
    """Settings that a user may have, and that a capture must neither obey nor lose."""
    render, cycles = scene.render, scene.cycles
    render.resolution_x, render.resolution_y, render.resolution_percentage = 123, 45, 37
    render.pixel_aspect_x = 2.0
    render.use_border, render.border_max_x, render.border_max_y = True, 0.4, 0.3
    render.use_crop_to_border = True
    render.film_transparent = render.use_motion_blur = render.use_multiview = render.use_stamp = True
    render.use_stamp_note, render.stamp_note_text = True, "stamped"
    render.image_settings.file_format = "JPEG"
    render.image_settings.quality = 33
    if hasattr(render.image_settings, "use_exr_interleave"):
        render.image_settings.use_exr_interleave = True
    render.use_persistent_data = False
    render.dither_intensity = 2.0
    scene.view_settings.exposure, scene.view_settings.gamma = 3.0, 2.0
    cycles.samples, cycles.film_exposure, cycles.time_limit = 7, 4.0, 100.0
    cycles.use_adaptive_sampling, cycles.film_transparent_glass = True, True
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 5.0
    scene.view_layers.new("Second").use = True
    bpy.context.view_layer.use = False
    scene.frame_set(7)
    for name, flag in (("Indirect Only", "indirect_only"), ("Cut Out", "holdout"), ("Excluded", "exclude")):
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        setattr(bpy.context.view_layer.layer_collection.children[name], flag, True)
    if scene.world:
        scene.world.cycles_visibility.camera = False


def step_names(probe: bpy.types.Object) -> list[str]:
    """What each step of the probe's bake says that it does."""
    work = BakeJob(bpy.context.scene, bpy.context.view_layer, [probe], None)
    messages = []
    while work.step():
        messages.append(work.message)
    return messages


def test_a_finished_bake_changes_only_the_probes_own_record(probe) -> None:
    bake(probe)  # adds the level of the new material to the probe's group
    before = settled()
    [result] = bake(probe)
    assert result.error is None
    own = ("objects['Probe'].pcc_probe", "objects['Probe']['pcc_probe']", "images", "node_groups['PCC Probe Probe']")
    changed = [line for line in difference(before, complete()) if not line.startswith(own)]
    assert changed == []


def test_cancelling_after_any_step_restores_everything(probe) -> None:
    before = settled()
    reached = []
    for count in range(1, 100):
        work = BakeJob(bpy.context.scene, bpy.context.view_layer, [probe], None)
        if not all(work.step() for _ in range(count)):
            break
        reached.append(work.message)
        if count > 1:
            assert bpy.context.scene.camera is not None, "the scene is not set up between steps"
        work.cancel()
        assert difference(before, complete()) == [], work.message
    assert any("face -Z" in message for message in reached) and any("storing" in message for message in reached)


BREAKABLE: dict[str, tuple[object, str, int]] = {
    "the stage": (Stage, "__init__", 1),
    "aiming": (Stage, "aim", 1),
    "a face": (Stage, "face", 6),
    "assembling": (equirect, "from_faces", 1),
    "blurring": (faces, "prefilter", 2),
    "storing": (levels, "store", 1),
    "the twins": (twin, "add_twins", 1),
}
CALLS = [(what, call) for what, (_, _, calls) in BREAKABLE.items() for call in range(1, calls + 1)]


def raise_on_call(function: Callable, number: int, error: BaseException) -> Callable:
    """`function`, but its call with this number (from 1) raises after it has done its work; storing, before."""
    calls, works = 0, function is not levels.store

    def broken(*args: object, **kwargs: object) -> object:
        nonlocal calls
        calls += 1
        result = function(*args, **kwargs) if works else None
        if calls == number:
            raise error
        return result

    return broken


@pytest.mark.sweep
@pytest.mark.parametrize(("what", "call"), CALLS, ids=[f"{what}, call {call}" for what, call in CALLS])
def test_an_exception_anywhere_restores_everything(probe, monkeypatch, what, call) -> None:
    before = settled()
    owner, name, _ = BREAKABLE[what]
    monkeypatch.setattr(owner, name, raise_on_call(getattr(owner, name), call, Broken(what)))
    with pytest.raises(Broken, match=what):
        bake(probe)
    assert difference(before, complete()) == []


def test_a_keyboard_interrupt_restores_everything(probe, monkeypatch) -> None:
    before = settled()
    monkeypatch.setattr(Stage, "face", raise_on_call(Stage.face, 2, KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        bake(probe)
    assert difference(before, complete()) == []


def test_an_expected_failure_of_one_probe_restores_everything_and_is_told(probe, monkeypatch) -> None:
    before = settled()
    monkeypatch.setattr(Stage, "face", raise_on_call(Stage.face, 3, BakeError("no luck")))
    [result] = bake(probe)
    assert result.error == "probe 'Probe': no luck"
    assert difference(before, complete()) == []


def test_a_job_that_was_never_started_changes_nothing(probe) -> None:
    before = settled()
    work = BakeJob(bpy.context.scene, bpy.context.view_layer, [probe], None)
    work.cancel()
    assert difference(before, complete()) == []


def test_an_object_deleted_between_steps_does_not_keep_the_rest_from_coming_back(probe) -> None:
    work = BakeJob(bpy.context.scene, bpy.context.view_layer, [probe], None)
    assert work.step() and work.step()
    bpy.data.objects.remove(bpy.data.objects["Lamp"])
    work.cancel()
    assert (bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_percentage) == (123, 37)
    assert bpy.context.scene.render.image_settings.file_format == "JPEG"
    assert [c.name for c in bpy.data.cameras] == []


def of_surfaces() -> list[str]:
    """The groups of ours that light surfaces, or copy a user's group for one."""
    used = [tree for tree in bpy.data.node_groups if tree.users]
    return [tree.name for tree in used if str(marks.role(tree)).startswith(("formula: Surface", "copy"))]


def test_unused_formula_groups_of_ours_are_gone_after_a_bake(probe) -> None:
    assert of_surfaces(), "the injected material has one"
    injection.remove()
    assert of_surfaces() == []
    bake(probe)
    assert of_surfaces() == [], "what the capture needed stays"


def test_the_picture_does_not_depend_on_settings_that_only_the_users_renders_concern(scene) -> None:
    probe = small_room()
    bake(probe)
    before = picture(probe).copy()
    make_unusual(scene)
    bake(probe)
    assert 0.9 < before.max() < 1.5 and before.shape == (32, 64, 3)
    assert np.allclose(picture(probe), before, atol=1e-5)


def seen(probe: bpy.types.Object) -> float:
    """How bright the middle of the +X face is: what a square metre in front of that wall looks like."""
    bake(probe)
    found = equirect.lookup(picture(probe), np.array([1.0, 0.0, 0.0]))
    return float(found[1])  # the wall behind is red


@pytest.mark.parametrize(
    ("change", "visible"),
    [
        (lambda item: None, True),
        (lambda item: setattr(item, "is_holdout", True), True),
        (lambda item: setattr(item, "visible_camera", False), True),
        (lambda item: setattr(item, "visible_glossy", False), False),
        (lambda item: setattr(item, "hide_render", True), False),
        (lambda item: layer(item, "indirect_only"), True),
        (lambda item: layer(item, "holdout"), True),
        (lambda item: layer(item, "exclude"), False),
    ],
    ids=[
        "plain", "a holdout", "hidden from cameras", "hidden from reflections", "not rendered",
        "in an indirect-only collection", "in a holdout collection", "in an excluded collection",
    ],
)  # fmt: skip
def test_the_capture_sees_what_a_reflection_would_see(scene, change, visible) -> None:
    probe = small_room()
    collection = bpy.data.collections.new("Own")
    scene.collection.children.link(collection)
    item = add_quad("Green", glow("Green", (0.0, 1.0, 0.0)), 1.0, collection)
    change(item)
    before = settled()
    assert seen(probe) == pytest.approx(1.0 if visible else 0.0, abs=0.02)
    lines = [line for line in difference(before, complete()) if line.startswith(("objects['Green']", "scenes"))]
    assert lines == []


def layer(item: bpy.types.Object, flag: str) -> None:
    setattr(bpy.context.view_layer.layer_collection.children[item.users_collection[0].name], flag, True)


@pytest.mark.parametrize(("camera", "glossy"), [(True, True), (False, True), (True, False)])
def test_the_world_is_captured_where_reflections_see_it(scene, camera, glossy) -> None:
    from tests.blender.helpers import small_probe

    background = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (0.0, 0.5, 0.0, 1.0)
    background.inputs["Strength"].default_value = 1.0
    scene.world.cycles_visibility.camera, scene.world.cycles_visibility.glossy = camera, glossy
    assert seen(small_probe()) == pytest.approx(0.5 if glossy else 0.0, abs=0.01)
    assert (scene.world.cycles_visibility.camera, scene.world.cycles_visibility.glossy) == (camera, glossy)
