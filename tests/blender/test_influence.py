"""The influence settings in Blender: what the nodes compute, live values, moving probes, fresh bakes, panels."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.shade import probe_group
from pcc_addon.core.effects.records import Correction
from pcc_addon.core.probe import ProbeSpec
from sample_blends.scenes import principled
from tests.blender.helpers import pretend_bake, put_in, shown_group, small_probe, small_room
from tests.core.sharing import weight_and_depth
from tests.shader_harness import evaluate_group

POINTS = np.random.default_rng(0).uniform(-1.6, 1.6, (600, 3))
SETTINGS = {
    "influence_low": (0.3, -0.2, 0.1),
    "influence_high": (-0.4, 0.2, 0.0),
    "falloff_per_face": True,
    "falloff_low": (0.1, 0.5, 0.3),
    "falloff_high": (0.6, 0.2, 0.4),
    "normal_fade": 0.3,
    "weight": 0.75,
}


def set_up(probe: bpy.types.Object, **settings: object) -> None:
    for name, value in settings.items():
        setattr(probe.pcc_probe, name, value)


def show(probe: bpy.types.Object) -> None:
    """Put the probe's group into a rendered material, which makes its drivers run."""
    material = principled("Shows the Probe")
    material.node_tree.nodes.new("ShaderNodeGroup").node_tree = probe.pcc_probe.group
    mesh = bpy.data.meshes.new("Shows the Probe")
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Shows the Probe", mesh))


def check_nodes(probe: bpy.types.Object) -> None:
    """The probe's lookup and depth, with the values that its group gives them, against NumPy; both are group nodes."""
    bpy.context.view_layer.update()
    spec = probe_spec(probe)
    correction = Correction[probe_group.shown_effects(probe.pcc_probe.group).split(",")[0].replace(" ", "_").upper()]
    points = spec.box.centre + POINTS @ spec.box.axes.T
    normals = POINTS / np.linalg.norm(POINTS, axis=-1, keepdims=True)
    expected = weight_and_depth(spec, points, normals, np.float64, correction, facing=True)
    found = weight_by_nodes(probe, spec, points, normals)
    np.testing.assert_allclose(found, expected[0], atol=2e-4)
    assert 0.05 < (found > 0.0).mean() < 1.0 and found.max() == pytest.approx(spec.influence.weight, abs=1e-6)


def weight_by_nodes(probe: bpy.types.Object, spec: ProbeSpec, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Weight times presence, from the lookup's node group."""
    tree = probe.pcc_probe.group
    [node] = [n for n in tree.nodes if n.bl_idname == "ShaderNodeGroup" and n.node_tree.name.startswith("PCC Lookup")]
    given = {}
    for socket in node.inputs:
        feeding = socket.links[0].from_node if socket.is_linked else None
        if feeding is None:
            given[socket.name] = np.array(socket.default_value)
        elif feeding.bl_idname == "ShaderNodeVectorMath":  # driven
            driven = feeding.inputs["Vector"].links[0].from_node
            given[socket.name] = (
                np.array([s.default_value for s in driven.inputs]) * feeding.inputs["Scale"].default_value
            )
    cases = {"Position": points, "Normal": normals, "Direction": normals, "Offset": np.zeros(3)}
    found = evaluate_group(node.node_tree, {**given, **cases}, ("Weight", "Presence"))
    return found["Weight"] * found["Presence"]


@pytest.mark.parametrize(
    ("rotation", "scale"),
    [
        ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        ((0.0, 0.0, 0.0), (-1.0, 1.0, 1.0)),
        ((0.0, 0.0, 0.7), (1.0, 1.0, 1.0)),
        ((0.0, 0.0, 2.5), (1.0, -1.0, 1.0)),
        ((0.3, -0.4, 0.9), (1.0, 1.0, 1.0)),
        ((0.3, -0.4, 0.9), (1.0, 1.0, -1.0)),
    ],
    ids=["aligned", "aligned, mirrored", "turned", "turned, mirrored", "oriented", "oriented, mirrored"],
)
def test_nodes_give_each_face_its_own_reach_and_falloff(addon, scene, rotation: tuple, scale: tuple) -> None:
    probe = small_probe(rotation=rotation)
    probe.scale = [a * b for a, b in zip(probe.scale, scale, strict=True)]
    set_up(probe, **SETTINGS)
    bpy.context.view_layer.update()
    pretend_bake(probe)
    show(probe)
    check_nodes(probe)


def test_values_are_live_and_follow_a_probe_that_is_turned_and_mirrored(addon, scene) -> None:
    probe = small_probe()
    pretend_bake(probe)
    show(probe)
    assert "per face" not in probe_group.shown_effects(probe.pcc_probe.group)
    set_up(probe, **SETTINGS)
    check_nodes(probe)
    set_up(probe, weight=0.5, influence_high=(0.2, 0.0, 0.0), falloff_low=(0.2, 0.2, 0.2))
    check_nodes(probe)
    probe.rotation_euler = (0.3, 0.2, 0.1)
    check_nodes(probe)
    probe.scale.x *= -1.0
    check_nodes(probe)


def test_a_weight_comes_and_goes_in_the_twins_at_once(addon, scene) -> None:
    probe = small_room()
    pretend_bake(probe)
    put_in()
    group = shown_group(bpy.data.materials["Floor"])

    def linked() -> bool:
        users = [n for n in bpy.data.materials["Floor"].node_tree.nodes if getattr(n, "node_tree", None) == group]
        return any("Weight" in n.outputs and n.outputs["Weight"].is_linked for n in users)

    scene.camera = None
    before = linked()
    probe.pcc_probe.weight = 0.5
    assert linked()
    probe.pcc_probe.weight = 1.0
    put_in()
    assert linked() is before


def test_no_setting_of_the_influence_makes_a_bake_stale(addon, scene) -> None:
    probe = small_room()

    def content() -> str:
        return SceneFingerprint(bpy.context.scene, bpy.context.view_layer).content_hash(probe_spec(probe))

    before = content()
    some = bpy.data.collections.new("Some")
    some.objects.link(bpy.data.objects["Wall -Z"])
    set_up(probe, **SETTINGS, priority=3, receivers=some, excluded=some)
    spec = probe_spec(probe)
    assert content() == before
    assert spec.influence.priority == 3 and spec.influence.receivers == spec.influence.excluded == {"Wall -Z"}
    assert spec.influence.low == pytest.approx((0.3, -0.2, 0.1)) and spec.influence.weight == 0.75
