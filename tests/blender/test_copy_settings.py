"""Settings are copied by subject, to the selected probes alone, and nothing else is."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender.setting_groups import OF_ONE, Group
from tests.blender.helpers import pretend_bake, small_probe
from tests.blender.materials import shiny, show


def values(probe: bpy.types.Object) -> dict[str, object]:
    """All settings of a probe as plain values."""
    return {prop.identifier: _plain(getattr(probe.pcc_probe, prop.identifier)) for prop in _properties(probe.pcc_probe)}


def _properties(group: bpy.types.PropertyGroup) -> list[bpy.types.Property]:
    return [prop for prop in group.bl_rna.properties if prop.identifier not in {"rna_type", "name"}]


def _plain(value: object) -> object:
    if isinstance(value, bpy.types.PropertyGroup):
        return {prop.identifier: _plain(getattr(value, prop.identifier)) for prop in _properties(value)}
    if hasattr(value, "add"):
        return [_plain(item) for item in value]
    return tuple(value) if hasattr(value, "foreach_get") else value


@pytest.fixture
def first(scene) -> bpy.types.Object:
    """The active probe, with a value of its own in each setting."""
    probe = small_probe("First")
    other = bpy.data.collections.new("Some")
    scene.collection.children.link(other)
    settings = probe.pcc_probe
    for prop in _properties(settings):
        name = prop.identifier
        if name in OF_ONE or prop.type == "COLLECTION" or name == "effects":
            continue
        if prop.type == "POINTER":
            setattr(settings, name, other)
        elif prop.type == "ENUM":
            setattr(settings, name, next(i.identifier for i in prop.enum_items if i.identifier != prop.default))
        elif prop.type == "BOOLEAN":
            setattr(settings, name, not getattr(settings, name))
        elif prop.type == "STRING":
            setattr(settings, name, "//room.exr")
        elif prop.is_array:
            setattr(settings, name, (0.1, 0.2, 0.3))
        else:
            low = max(prop.hard_min, 0)
            setattr(settings, name, type(prop.default)(low + 0.35 * (min(prop.hard_max, low + 40) - low)))
    settings.hidden_objects.add().object = show(shiny(), "Ball")
    settings.effects.fade, settings.effects.levels = "OFF", "AUTO"
    settings.capture_offset = (0.1, 0.0, 0.0)
    probe.select_set(True)
    bpy.context.view_layer.objects.active = probe
    return probe


@pytest.fixture
def second(first) -> bpy.types.Object:
    probe = small_probe("Second", (9.0, 0.0, 0.0))
    pretend_bake(probe)
    probe.select_set(True)
    return probe


@pytest.mark.parametrize("group", list(Group), ids=lambda g: g.name)
def test_a_group_is_copied_and_nothing_else(first, second, group: Group) -> None:
    before, wanted, place = values(second), values(first), second.matrix_world.copy()
    assert all(before[name] != wanted[name] for name in group.names if name not in {"effects"})
    assert bpy.ops.pcc.copy_settings(groups={group.name}) == {"FINISHED"}
    after = values(second)
    assert {name: after[name] for name in group.names} == {name: wanted[name] for name in group.names}
    rest = set(before) - set(group.names)
    assert {name: after[name] for name in rest} == {name: before[name] for name in rest}
    assert second.matrix_world == place


def test_all_of_them_are_copied_to_the_selected_ones_alone(first, second) -> None:
    third = small_probe("Third")
    before, source = values(third), values(first)
    assert bpy.ops.pcc.copy_settings() == {"FINISHED"}
    assert values(third) == before and values(first) == source
    copied = [name for group in Group for name in group.names]
    assert {name: values(second)[name] for name in copied} == {name: source[name] for name in copied}
    assert second.pcc_probe.bake_record and second.pcc_probe.capture_offset[0] == 0.0


def test_it_is_one_undo_step(first, second) -> None:
    bpy.ops.ed.undo_push(message="before")
    before = values(bpy.data.objects["Second"])["samples"]
    bpy.ops.pcc.copy_settings("EXEC_DEFAULT", True)
    assert bpy.data.objects["Second"].pcc_probe.samples != before
    bpy.ops.ed.undo()
    assert bpy.data.objects["Second"].pcc_probe.samples == before


def test_without_others_it_says_what_to_do(first) -> None:
    with pytest.raises(RuntimeError, match="Select other parallax probes too"):
        bpy.ops.pcc.copy_settings()
    bpy.context.view_layer.objects.active = bpy.data.objects["Ball"]
    with pytest.raises(RuntimeError, match="Make the parallax probe active"):
        bpy.ops.pcc.copy_settings()


def test_nothing_chosen_copies_nothing(first, second, capfd) -> None:
    before = values(second)
    assert bpy.ops.pcc.copy_settings(groups=set()) == {"CANCELLED"}
    assert values(second) == before and "nothing is copied" in capfd.readouterr().out
