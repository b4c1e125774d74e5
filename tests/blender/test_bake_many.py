"""Bakes of many probes: what keeps a renderer from reading the scene anew, and captures that are stored together."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake import capture, job
from pcc_addon.blender.bake.capture import Stage
from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.read.holders import Holders
from pcc_addon.blender.rendering import Renderer
from pcc_addon.blender.store import levels
from pcc_addon.core.errors import BakeError
from sample_blends.scenes import Room, add_wall
from tests.blender.helpers import bake, glow, picture, small_probe, small_room
from tests.rna_dump import difference, dump

TOGETHER, APART = 10**9, 0  # rays of an object
together = pytest.mark.skipif(bpy.app.version < (5, 0), reason="4.5 cannot read the file of one view: one by one there")


@pytest.fixture
def render_calls(monkeypatch) -> list[str]:
    """What each call of Blender's renderer was for."""
    calls, render = [], Renderer._render

    def counted(self: Renderer, what: str, **options: bool) -> None:
        calls.append(what)
        render(self, what, **options)

    monkeypatch.setattr(Renderer, "_render", counted)
    return calls


def cube() -> bpy.types.Object:
    """A cube of glowing walls, each of one colour, and a probe in its middle: no face shows an edge."""
    room = Room((2.0, 2.0, 2.0), (1.0, 2.0, 3.0), 0.0)
    for k, side in enumerate(("+X", "-X", "+Y", "-Y", "+Z", "-Z")):
        add_wall(room, side, glow(side, (0.1 + 0.1 * k, 0.9 - 0.1 * k, 0.2 + 0.3 * (k % 3))))
    return small_probe(location=room.centre, half_extents=room.half_extents)


@together
def test_faces_are_rendered_together_in_files_of_earlier_blenders(scene, monkeypatch, render_calls) -> None:
    probe = cube()
    settings = scene.render.image_settings
    settings.use_exr_interleave = True  # as Blender sets it in files from before 5.0
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    [result] = bake(probe)
    assert result.error is None and len(render_calls) == 1 and settings.use_exr_interleave


@together
@pytest.mark.parametrize(("samples", "denoise", "apart", "at_once"), [(1, False, 6, 1), (4, True, 12, 2)])
def test_faces_rendered_together_are_those_rendered_one_by_one(
    scene, monkeypatch, render_calls, samples, denoise, apart, at_once
) -> None:
    probe = cube()
    probe.pcc_probe.samples, probe.pcc_probe.denoise = samples, denoise
    found = {}
    for rays, calls in ((APART, apart), (TOGETHER, at_once)):
        monkeypatch.setattr(capture, "_VIEWS_TO_REST", rays)
        render_calls.clear()
        [result] = bake(probe)
        assert result.error is None and len(render_calls) == calls
        found[rays] = picture(probe).copy()
    assert found[APART].std() > 0.1
    if denoise:  # the denoiser sees what each face's own noise leaves of features, such as normals
        assert np.abs(found[APART] - found[TOGETHER]).mean() < 2e-3
    else:
        assert np.array_equal(found[APART], found[TOGETHER])


@together
def test_faces_rendered_together_are_as_bright_in_light_with_noise(scene, monkeypatch) -> None:
    probe = small_room()
    probe.pcc_probe.samples = 64
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", APART)
    bake(probe)
    expected = picture(probe).copy()
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    bake(probe)
    assert np.abs(picture(probe) - expected).mean() < 0.02 * expected.mean()


@together
def test_few_rays_among_many_objects_are_rendered_together(scene, render_calls) -> None:
    probe = small_room()
    bake(probe)
    assert len(render_calls) == 6, "a face costs more than going over so few objects"
    render_calls.clear()
    for k in range(400):
        item = bpy.data.objects.new(f"Far {k}", bpy.data.meshes.new("Far"))
        scene.collection.objects.link(item)
    bake(probe)
    assert len(render_calls) == 1
    render_calls.clear()
    probe.pcc_probe.samples = 64
    bake(probe)
    assert len(render_calls) == 6


def three_cubes() -> list[bpy.types.Object]:
    """Three probes within the glowing cube, each with its own point of view, and a ball that only some of them see."""
    probes = [cube(), *(small_probe(name, (1.0, 2.0, 3.0), (1.9, 1.9, 1.9)) for name in ("Second", "Third"))]
    mesh = bpy.data.meshes.new("Slab")
    mesh.from_pydata([(-0.6, -0.6, 0.0), (0.6, -0.6, 0.0), (0.6, 0.6, 0.0), (-0.6, 0.6, 0.0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(glow("Slab", (0.0, 0.0, 5.0)))
    slab = bpy.data.objects.new("Slab", mesh)
    slab.location = (1.0, 2.0, 3.6)
    bpy.context.scene.collection.objects.link(slab)
    for k, probe in enumerate(probes):
        probe.pcc_probe.capture_offset = (0.0, 0.0, 0.45 * (k - 1))
        probe.pcc_probe.samples = 16
    return probes


@together
def test_faces_of_many_probes_in_one_render_are_those_of_each(scene, monkeypatch, render_calls) -> None:
    probes = three_cubes()
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    found = {}
    for most, calls in ((1, 3), (3, 1)):
        monkeypatch.setattr(capture, "_TOGETHER", most)
        render_calls.clear()
        results = bake(*probes)
        assert [result.error for result in results] == [None] * 3 and len(render_calls) == calls
        assert all(result.seconds > 0.0 for result in results), "each has its share of the time"
        found[most] = [picture(probe).copy() for probe in probes]
    for alone, among_others in zip(found[1], found[3], strict=True):
        assert np.abs(alone - among_others).mean() < 0.01, "edges have a noise of their own"
    assert all(np.abs(found[1][i] - found[1][k]).mean() > 0.05 for i, k in ((0, 1), (1, 2), (2, 0)))


def more_samples(probe: bpy.types.Object) -> None:
    probe.pcc_probe.samples = 17


def nearer_clip(probe: bpy.types.Object) -> None:
    probe.pcc_probe.clip_end = 50.0


def farther_start(probe: bpy.types.Object) -> None:
    probe.pcc_probe.clip_start = 0.02


def something_hidden(probe: bpy.types.Object) -> None:
    probe.pcc_probe.hidden_objects.add().object = bpy.data.objects["Slab"]


def another_size(probe: bpy.types.Object) -> None:
    probe.pcc_probe.resolution = 18


@together
@pytest.mark.parametrize("change", [more_samples, nearer_clip, farther_start, something_hidden, another_size])
def test_a_probe_that_is_captured_otherwise_has_a_render_of_its_own(scene, monkeypatch, render_calls, change) -> None:
    probes = three_cubes()
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    change(probes[1])
    assert [result.error for result in bake(*probes)] == [None] * 3
    assert [what.split("'")[1] for what in render_calls].count("Second") == 1, "the dearest comes first"


@together
def test_nothing_is_hidden_from_probes_that_hide_the_same(scene, monkeypatch, render_calls) -> None:
    """They are rendered one after the other: what is hidden from one is shown again before the next."""
    probes = three_cubes()
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    for probe in probes:
        something_hidden(probe)
    bake(*probes)
    assert len(render_calls) == 3 and all(picture(probe).max() < 1.5 for probe in probes)


@together
@pytest.mark.parametrize(("name", "value"), [("_VIEWS_TO_REST", 90), ("_PIXELS_TOGETHER", 2 * 6 * 32**2)])
def test_a_render_is_shared_by_as_many_as_it_is_worth_and_memory_holds(
    scene, monkeypatch, render_calls, name, value
) -> None:
    probes = three_cubes()  # among ten objects, 98,000 rays each
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    monkeypatch.setattr(capture, name, value)
    bake(*probes)
    assert len(render_calls) == 2


@together
def test_shapes_that_look_at_the_camera_are_captured_probe_by_probe(scene, monkeypatch, render_calls) -> None:
    probes = three_cubes()
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    tree = bpy.data.node_groups.new("Billboard", "GeometryNodeTree")
    tree.nodes.new("GeometryNodeInputActiveCamera")
    bake(*probes)
    assert len(render_calls) == 3


@together
def test_a_failed_render_of_many_fails_them_one_by_one(scene, monkeypatch) -> None:
    probes = three_cubes()
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    views, calls = Renderer.views, []

    def failing(self: Renderer, what: str, cameras: list) -> list[np.ndarray]:
        calls.append(len(cameras))
        if len(calls) == 1:
            raise BakeError(f"{what}: no luck")
        return views(self, what, cameras)

    monkeypatch.setattr(Renderer, "views", failing)
    results = {result.probe: result.error for result in bake(*probes)}
    assert results == {"Probe": "probe 'Probe': its faces: no luck", "Second": None, "Third": None}
    assert calls == [18, 12]


def test_eevee_renders_face_by_face(scene, monkeypatch, render_calls) -> None:
    probe = small_room()
    probe.pcc_probe.engine = "EEVEE"
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    monkeypatch.setattr(Renderer, "picture", lambda self, what: self._render(what))
    monkeypatch.setattr(Renderer, "_render", lambda self, what: (_ for _ in ()).throw(BakeError(what)))
    [result] = bake(probe)
    assert "face +X" in result.error


@together
def test_the_users_views_come_back(scene, monkeypatch) -> None:
    probe = small_room()
    view = scene.render.views.new("Mine")
    view.camera_suffix, view.use = "_mine", True
    scene.render.views[0].use = False
    scene.render.views.active_index = 1
    bake(probe)
    dump()
    before = dump(("scenes", "cameras", "objects"))
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", TOGETHER)
    [result] = bake(probe)
    assert result.error is None
    own = ("objects['Probe'].pcc_probe", "objects['Probe']['pcc_probe']")
    changed = difference(before, dump(("scenes", "cameras", "objects")))
    assert [line for line in changed if not line.startswith(own)] == []


@pytest.mark.sweep
@pytest.mark.parametrize("rays", [APART, pytest.param(TOGETHER, marks=together)], ids=["one by one", "together"])
def test_no_data_block_comes_or_goes_between_faces(scene, monkeypatch, rays) -> None:
    """Each new one has the next session uid; after one that came or went a renderer reads the whole scene anew."""
    probes = [small_room(), small_probe("Other")]
    if rays == TOGETHER:
        probes += [small_probe("Third"), small_probe("Fourth")]
    for probe in probes:
        probe.pcc_probe.denoise = True
    bake(*probes)  # the first render makes the image of results
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", rays)
    monkeypatch.setattr(capture, "_TOGETHER", 2)
    begins, ends, render = [], [], Renderer._render

    def counted(self: Renderer, what: str, **options: bool) -> None:
        begins.append(newest())
        render(self, what, **options)  # which numbers its own copies
        ends.append(newest())

    monkeypatch.setattr(Renderer, "_render", counted)
    bake(*probes)
    assert len(begins) == (24 if rays == APART else 4)
    made = np.subtract(begins[1:], ends[:-1]) - 1
    assert made[0] <= 1, "the image that files are read through"
    assert not made[1:].any(), made


def newest() -> int:
    """The session uid of a data block made now."""
    mark = bpy.data.texts.new("mark")
    uid = mark.session_uid
    bpy.data.texts.remove(mark)
    return uid


@pytest.mark.parametrize("held", [10**9, 0], ids=["stored together", "stored one by one"])
def test_a_bake_asks_once_who_holds_what(scene, monkeypatch, held) -> None:
    """Else storing a probe would take the longer the more there are."""
    probes = [small_room(), small_probe("Second"), small_probe("Third")]
    monkeypatch.setattr(job, "_HELD_BYTES", held)
    asked, begin = [], Holders.__init__
    monkeypatch.setattr(Holders, "__init__", lambda self: (asked.append(self), begin(self))[1])
    for _ in range(2):
        asked.clear()
        assert [result.error for result in bake(*probes)] == [None] * 3
        assert len(asked) == 1


def test_of_captures_stored_together_one_may_fail(scene, monkeypatch) -> None:
    probes = [small_room(), small_probe("Second"), small_probe("Third")]
    store = levels.store

    def failing(probe: bpy.types.Object, *rest: object, **options: object) -> None:
        if probe.name == "Second":
            raise BakeError("the disk is full")
        store(probe, *rest, **options)

    monkeypatch.setattr(levels, "store", failing)
    results = {result.probe: result.error for result in bake(*probes)}
    assert results == {"Probe": None, "Second": "probe 'Second': the disk is full", "Third": None}
    assert [bool(probe.pcc_probe.bake_record) for probe in probes] == [True, False, True]


def test_a_probe_that_cannot_be_rendered_leaves_those_that_wait_alone(scene, monkeypatch) -> None:
    probes = [small_room(), small_probe("Second"), small_probe("Third")]
    face = Stage.face

    def failing(self: Stage, spec: object, index: int) -> np.ndarray:
        if spec.name == "Second" and index == 3:
            raise BakeError("no luck")
        return face(self, spec, index)

    monkeypatch.setattr(Stage, "face", failing)
    results = {result.probe: result.error for result in bake(*probes)}
    assert results == {"Probe": None, "Second": "probe 'Second': no luck", "Third": None}


@pytest.mark.parametrize(("held", "expected"), [(10**9, ["face"] * 12 + ["store"] * 2), (0, None)])
def test_captures_wait_to_be_stored_while_they_are_small(scene, monkeypatch, held, expected) -> None:
    probes = [small_room(), small_probe("Second")]
    monkeypatch.setattr(job, "_HELD_BYTES", held)
    work = BakeJob(scene, bpy.context.view_layer, probes, None)
    kinds = []
    while work.step():
        kinds += ["face"] * ("face " in work.message) + ["store"] * ("storing" in work.message)
    assert kinds == (expected or [*["face"] * 6, "store", *["face"] * 6, "store"])


@pytest.mark.parametrize("held", [10**9, 0], ids=["stored together", "stored one by one"])
def test_cancelling_between_two_probes_keeps_the_finished_one(scene, monkeypatch, held) -> None:
    probes = [small_room(), small_probe("Second"), small_probe("Third")]
    monkeypatch.setattr(job, "_HELD_BYTES", held)
    work = BakeJob(scene, bpy.context.view_layer, probes, None)
    while not work.results:
        assert work.step()
    work.cancel()
    assert [bool(probe.pcc_probe.bake_record) for probe in probes] == [True, False, False]
    assert [result.probe for result in work.results] == ["Probe"]


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="before 5.0 nothing parts a scene from its compositor")
def test_a_denoised_bake_leaves_the_render_layers_node_alone(scene) -> None:
    tree = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
    scene.compositing_node_group = tree
    node = tree.nodes.new("CompositorNodeRLayers")
    probe = small_room()
    probe.pcc_probe.denoise = True
    before = [(socket.name, socket.enabled) for socket in node.outputs]
    [result] = bake(probe)
    assert result.error is None and scene.compositing_node_group == tree
    assert [(socket.name, socket.enabled) for socket in node.outputs] == before
