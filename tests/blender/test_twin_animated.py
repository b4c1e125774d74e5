"""Animated inputs of a material: its twin has their values at each frame, though no handler runs then."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.shade import injection
from pcc_addon.blender.shade.sketch import OF, VALUES
from pcc_addon.blender.store.pictures import read_file
from sample_blends.scenes import principled_node
from tests.blender.helpers import bake, put_in, save, small_room
from tests.rna_dump import difference, dump


def keyed(inputs) -> None:
    for frame, strength, color in ((1, 0.0, (1.0, 0.0, 0.0, 1.0)), (6, 1.0, (0.0, 1.0, 0.5, 1.0)), (11, 0.2, (1,) * 4)):
        inputs["Emission Strength"].default_value = strength
        inputs["Base Color"].default_value = color
        inputs["Emission Strength"].keyframe_insert("default_value", frame=frame)
        inputs["Base Color"].keyframe_insert("default_value", frame=frame)


def cycled(inputs) -> None:
    keyed(inputs)
    curves = [
        c for bag in inputs.data.id_data.animation_data.action.layers[0].strips[0].channelbags for c in bag.fcurves
    ]
    for curve in curves:
        curve.modifiers.new("CYCLES")


def driven(inputs) -> None:
    inputs["Emission Strength"].driver_add("default_value").driver.expression = "frame / 10"


def shown(material: bpy.types.Material) -> list[tuple[str, object, object]]:
    """(input, what the twin has, what the original has) at the scene's frame, of all inputs that repeat another."""
    tree = material.evaluated_get(bpy.context.evaluated_depsgraph_get()).node_tree
    found = []
    for node in tree.nodes:
        for ours, theirs in (marks.noted(node, VALUES) or {}).items():
            original = tree.nodes[marks.noted(node, OF)]
            value = next(s.default_value for s in node.inputs if s.identifier == ours)
            known = next(s.default_value for s in original.inputs if s.identifier == theirs)
            found.append((theirs, value, known))
    return found


def check(material: bpy.types.Material, names: set[str]) -> None:
    seen: dict[str, set] = {}
    for frame in (1, 4, 6, 9, 11, 14):
        bpy.context.scene.frame_set(frame)
        for name, ours, theirs in shown(material):
            wide = np.size(ours)
            known = np.resize(np.ravel(theirs).astype(float)[:wide], wide)
            np.testing.assert_allclose(np.ravel(ours).astype(float), known, atol=1e-6)
            seen.setdefault(name, set()).add(tuple(np.round(known, 5)))
    assert {name for name in names if len(seen.get(name, ())) > 2} == names, "nothing moved, so nothing is tested"


@pytest.mark.parametrize(
    ("animate", "names"),
    [
        (keyed, {"Emission Strength", "Base Color"}),
        (cycled, {"Emission Strength", "Base Color"}),
        (driven, {"Emission Strength"}),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_a_twin_has_the_values_of_each_frame(scene, animate: Callable[[object], None], names: set[str]) -> None:
    probe, floor = small_room(), bpy.data.materials["Floor"]
    node = principled_node(floor)
    node.inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    animate(node.inputs)
    scene.frame_set(1)
    bake(probe)
    before = dump()
    put_in()
    check(floor, names)
    curves = len(floor.node_tree.animation_data.drivers)
    put_in()
    assert len(floor.node_tree.animation_data.drivers) == curves
    scene.frame_set(1)
    injection.remove()
    assert [line for line in difference(before, dump()) if "Floor" in line] == []


def test_keyframes_that_are_edited_show_in_the_twin(scene) -> None:
    probe, floor = small_room(), bpy.data.materials["Floor"]
    inputs = principled_node(floor).inputs
    inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    keyed(inputs)
    bake(probe)
    put_in()
    inputs["Emission Strength"].default_value = 7.0
    inputs["Emission Strength"].keyframe_insert("default_value", frame=9)
    bpy.context.view_layer.update()
    check(floor, {"Emission Strength", "Base Color"})


def test_captures_of_frames_show_what_is_animated_in_materials_that_will_show_a_probe(scene, tmp_path) -> None:
    """While captured these wear twins without their reflections."""
    probe, floor = small_room(), bpy.data.materials["Floor"]
    inputs = principled_node(floor).inputs
    inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    for frame, value in ((1, 0.0), (2, 1.0)):
        inputs["Emission Strength"].default_value = value
        inputs["Emission Strength"].keyframe_insert("default_value", frame=frame)
    scene.frame_set(1)
    save(tmp_path / "room.blend")
    assert bpy.ops.pcc.bake(frames="1-2") == {"FINISHED"}
    levels = [level for level in bake_record(probe).levels if level.roughness == 0.0]
    dark, bright = (read_file(tmp_path / "room.pcc" / level.file)[0].mean() for level in levels)
    assert bright - dark == pytest.approx(1.0, abs=0.05)
