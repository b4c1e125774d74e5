"""A scene with a broken shader is baked all the same; what was wrong is told with the place where it stands."""

from __future__ import annotations

import json
import re
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender.bake.job import BakedProbe
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.cli import run_in_blender
from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACES, face_directions
from sample_blends.scenes import emissive
from tests.blender.helpers import ROOM, bake, picture, small_probe
from tests.eevee import without_shadows

RESOLUTION = 32
SIZE = 0.3  # metres across, about a metre away
BACKGROUND = 0.25


def multiplied(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket, factor: float) -> bpy.types.NodeSocket:
    node = tree.nodes.new("ShaderNodeMath")
    node.operation, node.inputs[1].default_value = "MULTIPLY", factor
    tree.links.new(value, node.inputs[0])
    return node.outputs[0]


def emitter(towards: tuple[float, float, float], strength: float | str) -> None:
    """A small glowing cube `towards` from the probe; its strength a number, or "infinite" or "NaN" by its nodes."""
    material, emission = emissive("Broken")
    tree = material.node_tree
    if isinstance(strength, str):
        geometry = tree.nodes.new("ShaderNodeNewGeometry")  # not a constant, so that nothing is computed beforehand
        length = tree.nodes.new("ShaderNodeVectorMath")
        length.operation = "LENGTH"
        tree.links.new(geometry.outputs["Position"], length.inputs[0])
        value = multiplied(tree, multiplied(tree, length.outputs["Value"], 1e30), 1e30)
        if strength == "NaN":
            difference = tree.nodes.new("ShaderNodeMath")
            difference.operation = "SUBTRACT"
            for socket in difference.inputs[:2]:
                tree.links.new(value, socket)
            value = difference.outputs[0]
        tree.links.new(value, emission.inputs["Strength"])
    else:
        emission.inputs["Strength"].default_value = strength
    bpy.ops.mesh.primitive_cube_add(size=SIZE, location=Vector(ROOM.centre) + Vector(towards))
    bpy.context.object.data.materials.append(material)


def grey_world(engine: str, denoise: bool) -> bpy.types.Object:
    """A probe under an even sky, ready to bake; returns the probe."""
    background = next(n for n in bpy.context.scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    background.inputs["Strength"].default_value = BACKGROUND
    without_shadows(bpy.context.scene)
    probe = small_probe()
    settings = probe.pcc_probe
    settings.engine, settings.resolution, settings.samples, settings.denoise = engine, RESOLUTION, 4, denoise
    return probe


def place(line: str) -> np.ndarray:
    """The unit direction of the pixel that a report names."""
    found = re.search(r"face ([+-][XYZ]): .*the first at column (\d+), row (\d+)$", line)
    assert found, line
    face = next(face for face in FACES if face.name == found[1])
    d = face_directions(face, RESOLUTION)[int(found[3]), int(found[2])]
    return d / np.linalg.norm(d)


def check(probe: bpy.types.Object, result: BakedProbe, towards: tuple[float, float, float], what: str) -> None:
    """The one report names the fault, is kept in the record, and points at the emitter; the picture is sound."""
    assert result.error is None
    [line] = result.replaced_pixels
    hidden = probe.pcc_probe.denoise and what == "negative"
    fate = "at one sample a pixel, hidden by denoising" if hidden else "were replaced"
    assert re.search(rf"[1-9]\d* {what} pixels {fate}, the first", line)
    assert bake_record(probe).replaced_pixels == (line,)
    reach = 0.5 * SIZE * np.sqrt(3.0) / np.linalg.norm(towards) + 2.0 / RESOLUTION  # the cube's, and a pixel
    assert place(line) @ towards / np.linalg.norm(towards) > np.cos(reach)
    sound(probe)


def sound(probe: bpy.types.Object) -> None:
    stored = picture(probe)
    assert np.isfinite(stored).all() and stored.min() >= 0.0 and stored.max() <= 65504.0
    np.testing.assert_allclose(np.median(stored), BACKGROUND, rtol=0.01, err_msg="the rest is as it was")


def shown(probe: bpy.types.Object, towards: tuple[float, float, float]) -> np.ndarray:
    return equirect.lookup(picture(probe), np.array(towards))


# In each of the six faces, away from the middle, so that a mirrored or turned position is seen.
DIRECTIONS = [
    (1.0, 0.5, -0.3),
    (-1.0, 0.4, 0.5),
    (0.5, 1.0, -0.3),
    (0.4, -1.0, 0.5),
    (0.5, 0.3, 1.0),
    (0.3, -0.5, -1.0),
]


@pytest.mark.parametrize("towards", DIRECTIONS)
def test_the_reported_place_is_where_the_broken_object_stands(scene, towards) -> None:
    emitter(towards, -3.0)
    probe = grey_world("CYCLES", denoise=False)
    [result] = bake(probe)
    check(probe, result, towards, "negative")
    np.testing.assert_array_equal(shown(probe, towards), 0.0)


@pytest.mark.sweep
@pytest.mark.parametrize("denoise", [False, True])
@pytest.mark.parametrize(
    ("strength", "what", "becomes"),
    [(-3.0, "negative", 0.0), (1e6, "too bright", 65504.0), (1e10, "too bright", 65504.0)],
)
def test_negative_and_too_bright_light_in_cycles_is_told_denoised_or_not(
    scene, denoise, strength, what, becomes
) -> None:
    towards = DIRECTIONS[0]
    emitter(towards, strength)
    probe = grey_world("CYCLES", denoise)
    [result] = bake(probe)
    check(probe, result, towards, what)
    np.testing.assert_allclose(shown(probe, towards), becomes, atol=1e-3)


@pytest.mark.sweep
@pytest.mark.parametrize("strength", [3e38, "infinite", "NaN"])
@pytest.mark.parametrize("denoise", [False, True])
def test_light_that_is_not_finite_is_black_in_cycles_own_picture(scene, denoise, strength) -> None:
    """Cycles replaces it before there is a picture, so it cannot be counted: what `radiance` says is true."""
    towards = DIRECTIONS[0]
    emitter(towards, strength)
    probe = grey_world("CYCLES", denoise)
    [result] = bake(probe)
    assert result.error is None and result.replaced_pixels == ()
    sound(probe)
    np.testing.assert_allclose(shown(probe, towards), 0.0, atol=1e-3)


def test_an_object_across_an_edge_is_told_by_both_faces_and_only_with_their_own_pixels(scene) -> None:
    towards = (1.0, 1.0, 0.1)
    emitter(towards, -3.0)
    [result] = bake(grey_world("CYCLES", denoise=False))
    assert [line[:7] for line in result.replaced_pixels] == ["face +X", "face +Y"]
    for line in result.replaced_pixels:
        assert place(line) @ towards / np.linalg.norm(towards) > np.cos(0.3)


def test_a_sound_scene_has_nothing_to_report(scene) -> None:
    emitter(DIRECTIONS[0], 60000.0)
    [result] = bake(grey_world("CYCLES", denoise=False))
    assert result.error is None and result.replaced_pixels == ()


def test_the_operator_the_shell_and_the_sidecar_say_it(scene, tmp_path: Path, capfd) -> None:
    emitter(DIRECTIONS[0], -3.0)
    grey_world("CYCLES", denoise=True)
    path = tmp_path / "broken.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    capfd.readouterr()
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"}
    said = r"probe 'Probe': face \+X: [1-9]\d* negative pixels at one .* denoising, the first at column \d+, row \d+"
    assert re.search(rf"Warning: {said}", capfd.readouterr().out)
    assert run_in_blender(["bake", str(path)]) == 0, "a broken shader is told, not a failure"
    assert re.search(rf"^{said}$", capfd.readouterr().out, re.MULTILINE)
    assert run_in_blender(["bake", str(path), "--json"]) == 0
    events = [json.loads(line) for line in capfd.readouterr().out.splitlines()]
    [note] = [event["note"] for event in events if event["event"] == "note"]
    sidecar = max((tmp_path / "broken.pcc").glob("*.json"), key=lambda file: file.stat().st_mtime)
    assert json.loads(sidecar.read_text(encoding="utf-8"))["replaced_pixels"] == [note.removeprefix("probe 'Probe': ")]


@pytest.mark.heavy
@pytest.mark.parametrize("strength", [1e6, 3e38])
def test_eevee_cuts_too_bright_light_off_and_it_is_told(scene, strength) -> None:
    towards = DIRECTIONS[3]
    emitter(towards, strength)
    probe = grey_world("EEVEE", denoise=False)
    [result] = bake(probe)
    check(probe, result, towards, "too bright")
    np.testing.assert_array_equal(shown(probe, towards), 65504.0)


@pytest.mark.heavy
@pytest.mark.parametrize("strength", [-3.0, "infinite", "NaN"])
def test_negative_and_not_finite_light_is_black_in_eevees_own_picture(scene, strength) -> None:
    """EEVEE replaces it before there is a picture, so it cannot be counted: what `radiance` says is true."""
    emitter(DIRECTIONS[3], strength)
    probe = grey_world("EEVEE", denoise=False)
    [result] = bake(probe)
    assert result.error is None and result.replaced_pixels == ()
    sound(probe)
    np.testing.assert_array_equal(shown(probe, DIRECTIONS[3]), 0.0)
