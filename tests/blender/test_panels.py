"""Panels in every state that a probe may be in: nothing fails, is missing, or is wider than there is room."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.setting_groups import OF_ONE, Group
from pcc_addon.ui import sentences
from pcc_addon.ui.panels.accuracy import PCC_PT_accuracy
from pcc_addon.ui.panels.probe import PCC_PT_probe
from pcc_addon.ui.panels.result import PCC_PT_result
from pcc_addon.ui.panels.scene import PCC_PT_scene
from pcc_addon.ui.panels.scene_materials import PCC_PT_scene_materials
from sample_blends.scenes import principled
from tests.blender.drawn import context_of, draw, ours
from tests.blender.helpers import pretend_bake, put_in, save, small_probe
from tests.blender.materials import shiny, show
from tests.core.cost_reports import example

NARROW, WIDE = 190.0, 900.0


def nothing(scene) -> None:
    pass


def unbaked(scene) -> None:
    activate(small_probe())


def baked(scene) -> None:
    probe = small_probe()
    show(shiny())
    pretend_bake(probe)
    put_in()
    activate(probe)
    bpy.ops.pcc.status()


def damaged(scene) -> None:
    probe = small_probe()
    probe.pcc_probe.bake_record = "{"
    activate(probe)


def image(scene) -> None:
    probe = small_probe()
    probe.pcc_probe.source = "IMAGE"
    activate(probe)


def world(scene) -> None:
    probe = small_probe()
    probe.pcc_probe.source = "WORLD"
    probe.pcc_probe.correction = "RELIEF"
    probe.pcc_probe.falloff_per_face = True
    activate(probe)


def mesh(scene) -> None:
    small_probe()
    activate(show(shiny()))


STATES = [nothing, unbaked, baked, damaged, image, world, mesh]


def activate(item: bpy.types.Object) -> None:
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = item
    item.select_set(True)


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.__name__)
def test_every_panel_is_drawn_in_every_state(scene, state) -> None:
    state(scene)
    drawn = [panel for panel in ours(bpy.types.Panel) if panel.__name__ != "PCC_PT_presets" and draw(panel)]
    assert len(drawn) >= 3, "the sidebar and the scene"


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.__name__)
def test_what_is_written_fits_into_a_narrow_column(scene, state) -> None:
    state(scene)
    context = context_of(NARROW)
    for panel in ours(bpy.types.Panel):
        drawn = draw(panel, NARROW) if panel.__name__ != "PCC_PT_presets" else None
        for label in drawn.labels if drawn else ():
            assert sentences.width(context, label) <= sentences.room(context), (panel.bl_label, label)


def test_every_setting_of_a_probe_has_its_place_in_a_panel(scene) -> None:
    found = set()
    for state in (unbaked, world, image):
        state(scene)
        settings = bpy.context.object.pcc_probe
        for panel in ours(bpy.types.Panel):
            drawn = draw(panel) if getattr(panel, "bl_context", "") == "data" else None
            found |= {name for data, name in (drawn.properties if drawn else ()) if data == settings}
    wanted = {name for group in (Group.CAPTURE, Group.BOX, Group.INFLUENCE) for name in group.names}
    assert wanted - found == {"hidden_objects"}, "whose items are drawn"
    assert {"size", "capture_offset", "follow"} <= found


def test_every_setting_can_be_copied_or_belongs_to_one_probe(scene) -> None:
    names = {p.identifier for p in small_probe().pcc_probe.bl_rna.properties} - {"rna_type", "name"}
    copied = [name for group in Group for name in group.names]
    assert sorted(copied) == sorted(names - OF_ONE) and names >= OF_ONE


def test_all_that_can_be_set_or_pressed_says_what_it_is() -> None:
    for cls in ours(bpy.types.Operator):
        operator = getattr(bpy.ops.pcc, cls.bl_idname.removeprefix("pcc.")).get_rna_type()
        assert operator.description or hasattr(cls, "description"), cls
        assert "INTERNAL" in getattr(cls, "bl_options", ()) or _untold(operator) <= PLAIN, cls
    for cls in ours(bpy.types.PropertyGroup):
        assert not _untold(cls.bl_rna), cls


PLAIN = {"location", "rotation", "first", "last", "filepath", "directory"}
"""What needs no words, or is set by Blender."""


def _untold(kind: bpy.types.Struct) -> set[str]:
    """Its properties that an artist may see and that say nothing of themselves, nor of what there is to choose."""
    own = [prop for prop in kind.properties if prop.identifier not in {"rna_type", "name"} and not prop.is_hidden]
    told = {p.identifier for p in own if p.type == "ENUM" and all(item.description for item in p.enum_items)}
    untold = {p.identifier for p in own if p.type not in {"POINTER", "COLLECTION"} and not p.description}
    return untold - told


def test_a_probe_says_how_its_bake_stands_and_why(scene) -> None:
    unbaked(scene)
    assert "Not baked" in draw(PCC_PT_probe).text and "It has no bake" in draw(PCC_PT_result).text
    baked(scene)
    assert "Stale: " in draw(PCC_PT_probe, WIDE).text, "a bake that was pretended is of another scene"
    result = draw(PCC_PT_result, WIDE)
    assert "Cycles, 16 px faces, 1 sample" in result.text and "MB" in result.text
    assert len(result.icons) == 2
    damaged(scene)
    assert "is not a probe's sidecar" in draw(PCC_PT_result, WIDE).text


def test_the_button_says_whether_it_bakes_one_or_several_or_why_none(scene) -> None:
    unbaked(scene)

    def said() -> list[str]:
        drawn = draw(PCC_PT_probe, WIDE)
        assert all(asked.scope == "SELECTED" for name, asked in drawn.operators if name == "pcc.bake")
        return [text for text in (*drawn.texts, *drawn.labels) if text.startswith(("Bake ", "Select "))]

    assert said() == ["Bake and Show this Probe", "Bake this Probe"]
    small_probe("Other").select_set(True)
    assert said() == ["Bake and Show Selected Probes", "Bake Selected Probes"]
    bpy.data.objects["Probe"].select_set(False)
    assert said() == ["Select the probe to bake it"]


def test_what_injection_leaves_alone_is_said_with_the_reason(scene) -> None:
    probe = small_probe()
    show(shiny())
    show(principled("Matt", Roughness=0.9), "Chalk")
    pretend_bake(probe)
    bpy.ops.pcc.inject()
    text = draw(PCC_PT_scene_materials, WIDE).text
    assert (
        "1 of 2 materials in reach can show probes" in text and "surface 'Principled BSDF' keeps its own lobe" in text
    )


def test_materials_can_be_restored_when_the_last_probe_is_gone(scene) -> None:
    material = shiny()
    for k in range(4):
        show(material, f"Mesh {k}").location.x = 10.0 * k
        pretend_bake(small_probe(f"Probe {k}", (10.0 * k, 0.0, 0.0), (2.0, 2.0, 2.0)))
    put_in()
    for probe in all_probes(scene):
        bpy.data.objects.remove(probe)
    bpy.context.view_layer.update()
    assert scene.objects[0].active_material != material, "rooms wear copies"
    assert [name for name, _ in draw(PCC_PT_scene).operators] == ["pcc.probe_add", "pcc.remove"]
    bpy.ops.pcc.remove()
    assert {item.active_material for item in scene.objects} == {material}
    assert [name for name, _ in draw(PCC_PT_scene).operators] == ["pcc.probe_add"]


def test_the_table_of_accuracy_breaks_where_it_is_narrow(scene, tmp_path) -> None:
    from pcc_addon.core.accuracy import files

    save(tmp_path / "room.blend")
    report = example()
    activate(small_probe(report.probe))
    files.keep(report, tmp_path / "room.cost")
    context = context_of(NARROW)
    for width in (NARROW, WIDE):
        drawn = draw(PCC_PT_accuracy, width)
        assert any(" px" in label for label in drawn.labels), "settings are named"
    narrow = draw(PCC_PT_accuracy, NARROW)
    assert all(sentences.width(context, label) <= sentences.room(context) for label in narrow.labels)
