"""Which probe a material shows, and whether it and an object show any, as an artist chooses: at once, kept, undone."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.properties import is_probe_here
from pcc_addon.blender.shade import copies
from pcc_addon.blender.shade.twin import has_twins, shown_probe_groups
from pcc_addon.blender.status import statuses
from tests.blender.helpers import pretend_bake, put_in, save, small_probe
from tests.blender.materials import Material, shiny, show
from tests.blender.snapshots import settled
from tests.rna_dump import difference


def update() -> None:
    bpy.context.view_layer.update()


def shows(material: Material) -> list[str]:
    return [group.name.removeprefix("PCC Probe ") for group in shown_probe_groups(material)]


def shown_on(name: str) -> list[str]:
    return shows(bpy.data.objects[name].material_slots[0].material)


def late() -> dict[str, tuple[str, ...]]:
    return {s.probe: s.outdated for s in statuses(bpy.context.scene, bpy.context.view_layer) if s.outdated}


@pytest.fixture
def wood(probe) -> Material:
    """Worn by a table and a vase that "Probe" and "Large", whose box is around it, reach; it shows both."""
    pretend_bake(small_probe("Large", half_extents=(5.0, 5.0, 5.0)))
    material = shiny("Wood")
    show(material, "Table")
    show(material, "Vase")
    put_in()
    assert {*shows(material)} == {"Probe", "Large"}
    return material


# At once.


def test_a_chosen_probe_is_shown_alone_at_once_and_others_come_back(wood) -> None:
    before = {*shows(wood)}
    wood.pcc.probe = bpy.data.objects["Large"]
    assert shows(wood) == ["Large"] and not late()
    wood.pcc.probe = bpy.data.objects["Probe"]
    assert shows(wood) == ["Probe"] and not late()
    wood.pcc.probe = None
    assert {*shows(wood)} == before and not late()


def test_a_material_is_excluded_and_included_at_once_though_nothing_else_shows_a_probe(wood) -> None:
    before = {*shows(wood)}
    wood.pcc.show_probes = False
    assert not has_twins(wood) and not late()
    put_in()
    assert not has_twins(wood)
    wood.pcc.show_probes = True
    assert {*shows(wood)} == before and not late()


def test_an_object_is_excluded_and_included_at_once(wood) -> None:
    vase, table = bpy.data.objects["Vase"], bpy.data.objects["Table"]
    vase.pcc.show_probes = False
    assert shown_on("Vase") == [] and {*shown_on("Table")} == {"Probe", "Large"} and not late()
    table.pcc.show_probes = False
    assert shown_on("Vase") == shown_on("Table") == [] and not copies.all_copies()
    vase.pcc.show_probes = table.pcc.show_probes = True
    assert {*shows(wood)} == {"Probe", "Large"} and not copies.all_copies() and not late()


def test_other_materials_stay_as_they_are(wood) -> None:
    other = shiny("Iron")
    show(other, "Lamp")
    put_in()
    before = {*shows(other)}
    wood.pcc.show_probes = False
    assert {*shows(other)} == before


def test_a_choice_injects_nothing_where_nothing_is_injected(wood) -> None:
    bpy.ops.pcc.remove()
    wood.pcc.show_probes = False
    wood.pcc.show_probes = True
    wood.pcc.probe = bpy.data.objects["Large"]
    bpy.data.objects["Vase"].pcc.show_probes = False
    assert not has_twins(wood) and not copies.all_copies()


def test_removing_restores_what_choices_changed_and_forgets_that_they_did(scene) -> None:
    small = small_probe()
    pretend_bake(small)
    wood = shiny("Wood")
    show(wood, "Table")
    show(wood, "Vase").pcc.show_probes = False
    other = shiny("Iron")
    show(other, "Lamp")
    other.pcc.show_probes = False
    before = settled()
    put_in()
    assert shown_on("Table") == ["Probe"] and shown_on("Vase") == shown_on("Lamp") == []
    bpy.ops.pcc.remove()
    assert difference(before, settled()) == []


def test_where_handlers_did_not_see_a_choice_status_asks_for_an_injection(wood) -> None:
    wood.pcc["show_probes"] = False  # as a file has it that was edited where the add-on is not
    assert wood.pcc.show_probes is False and shows(wood)
    assert late() == dict.fromkeys(("Large", "Probe"), ("'Wood' would show it otherwise",))
    put_in()
    assert not has_twins(wood) and not late()


def test_the_plan_says_what_was_chosen(wood) -> None:
    wood.pcc.probe = bpy.data.objects["Large"]
    bpy.data.objects["Vase"].pcc.show_probes = False
    [plan] = plan_scene(bpy.context.scene, bpy.context.view_layer).materials
    assert plan.choices == (
        "its Probe is 'Large', which it shows alone",
        "Show Probes of 'Vase' is off",
    )


# Copies and duplicates.


@pytest.mark.parametrize("chosen", ["original", "copy"])
def test_copies_of_a_material_repeat_its_choice(wood, chosen: str) -> None:
    bpy.data.objects["Vase"].pcc.show_probes = False
    [copy] = copies.all_copies()[wood]
    (wood if chosen == "original" else copy).pcc.probe = bpy.data.objects["Large"]
    [copy] = copies.all_copies()[wood]
    assert {wood.pcc.probe, copy.pcc.probe} == {bpy.data.objects["Large"]} and shown_on("Table") == ["Large"]
    copy.pcc.show_probes = False
    assert not wood.pcc.show_probes and not copies.all_copies() and shown_on("Table") == []


def test_duplicates_have_the_choices_and_each_its_own_from_then_on(wood) -> None:
    table = bpy.data.objects["Table"]
    wood.pcc.probe, table.pcc.show_probes = bpy.data.objects["Large"], False
    other, another = wood.copy(), table.copy()
    assert other.pcc.probe == wood.pcc.probe and not another.pcc.show_probes
    other.pcc.probe, another.pcc.show_probes = None, True
    assert wood.pcc.probe == bpy.data.objects["Large"] and not table.pcc.show_probes


# What may be chosen, and what goes.


def test_only_probes_of_the_scene_can_be_chosen(wood) -> None:
    elsewhere = small_probe("Elsewhere")
    bpy.context.scene.collection.objects.unlink(elsewhere)
    bpy.data.scenes.new("Other").collection.objects.link(elsewhere)
    offered = [item.name for item in bpy.data.objects if is_probe_here(wood.pcc, item)]
    assert offered == ["Large", "Probe"]
    wood.pcc.probe = bpy.data.objects["Table"]  # as a script may
    [plan] = plan_scene(bpy.context.scene, bpy.context.view_layer).materials
    assert shows(wood) == [] and "'Table' alone, which is no probe of scene" in plan.notes[0]


def test_a_probe_that_was_chosen_and_is_deleted_is_gone_with_its_pictures(wood) -> None:
    wood.pcc.probe = bpy.data.objects["Large"]
    with bpy.context.temp_override(selected_objects=[bpy.data.objects["Large"]]):
        bpy.ops.object.delete()
    update()
    assert "Large" not in bpy.data.objects and wood.pcc.probe is None and not has_twins(wood)
    bpy.data.orphans_purge(do_recursive=True)
    assert not [image.name for image in bpy.data.images if "Large" in image.name]


def test_a_probe_that_is_in_another_scene_only_is_named(wood) -> None:
    large = bpy.data.objects["Large"]
    wood.pcc.probe = large
    bpy.data.scenes.new("Other").collection.objects.link(large)
    bpy.context.scene.collection.objects.unlink(large)
    update()
    [plan] = plan_scene(bpy.context.scene, bpy.context.view_layer).materials
    assert wood.pcc.probe == large and "is no probe of scene 'Scene': choose another" in plan.notes[0]


def test_choices_survive_saving_and_loading(wood, tmp_path: Path) -> None:
    wood.pcc.probe = bpy.data.objects["Large"]
    bpy.data.objects["Vase"].pcc.show_probes = False
    for path in (tmp_path / "a.blend", tmp_path / "b.blend"):
        save(path)
        bpy.ops.wm.open_mainfile(filepath=str(path))
        wood = bpy.data.materials["Wood"]
        assert wood.pcc.probe == bpy.data.objects["Large"] and not bpy.data.objects["Vase"].pcc.show_probes
        assert shown_on("Table") == ["Large"] and shown_on("Vase") == [] and not late()
    bpy.ops.pcc.remove()
    assert not has_twins(wood) and not any(marks.is_copy(material) for material in bpy.data.materials)


def choose(path: str, value: object) -> None:
    """As a panel does, with an undo step."""
    assert bpy.ops.wm.context_set_value("EXEC_DEFAULT", True, data_path=path, value=repr(value)) == {"FINISHED"}


def test_each_choice_is_one_undo_step(wood) -> None:
    def state() -> tuple:
        table = bpy.data.objects["Table"]
        chosen = bpy.data.materials["Wood"].pcc.show_probes, table.pcc.show_probes
        return *chosen, sorted(shown_on("Table")), sorted(shown_on("Vase"))

    bpy.context.view_layer.objects.active = bpy.data.objects["Table"]
    bpy.ops.ed.undo_push(message="before")
    states = [state()]
    for path in ("object.pcc.show_probes", "object.active_material.pcc.show_probes"):
        choose(path, False)
        states.append(state())
    assert len({str(s) for s in states}) == 3
    for expected in (states[1], states[0]):
        bpy.ops.ed.undo()
        update()
        assert state() == expected
    for expected in states[1:]:
        bpy.ops.ed.redo()
        update()
        assert state() == expected
