"""Effects that an artist forces: the plan says so, shaders show it at once, and the choice stays with what has it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.shade import copies, probe_group
from pcc_addon.blender.shade.twin import has_twins, shown_probe_groups
from pcc_addon.core.decisions import OF_MATERIALS, OF_PROBES, Decision, Effect
from pcc_addon.core.pictures import LADDER
from sample_blends.scenes import Room, add_wall, principled, principled_node
from tests.blender.helpers import ROOM, pretend_bake, put_in, save, small_probe
from tests.blender.materials import Material, link, new, shiny, show
from tests.blender.test_twin_shown import levels_read


def decided(effect: Effect) -> Decision:
    """What the plan says of an effect of the only probe or material."""
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    material = plan.materials[0]
    surfaces = [decision for surface in material.surfaces for decision in surface.decisions]
    found = [d for d in (*plan.probes[0].decisions, *material.decisions, *surfaces) if d.effect is effect]
    assert len(found) == 1
    return found[0]


# Probes: what makes an effect needed, where it is not by itself.


def turned() -> dict[str, object]:
    return {"rotation": (0.0, 0.0, 0.4)}


def off_centre() -> dict[str, object]:
    return {"capture_offset": (0.3, 0.0, 0.0)}


def beyond() -> None:
    bpy.data.objects["Mesh"].location.x += ROOM.half_extents[0]


def on_a_wall() -> None:
    bpy.data.objects["Mesh"].location.z -= ROOM.half_extents[2]


def set_to(**settings: object) -> Callable[[], None]:
    def change() -> None:
        for name, value in settings.items():
            setattr(bpy.data.objects["Probe"].pcc_probe, name, value)

    return change


def nothing() -> None:
    """The room as it is."""


OF_LOOKUPS = [
    (Effect.PARALLAX, nothing, set_to(correction="NONE")),
    (Effect.TURN, turned, nothing),
    (Effect.OFFSET, off_centre, nothing),
    (Effect.FADE, beyond, nothing),
    (Effect.OUTER_SIDES, on_a_wall, nothing),
    (Effect.FACE_FALLOFFS, set_to(influence_low=(0.5, 0.0, 0.0)), nothing),
    (Effect.NORMAL_FADE, set_to(normal_fade=0.5), nothing),
    (Effect.WEIGHT, set_to(weight=0.5), nothing),
    (Effect.HARDENING, set_to(contact_hardening=True), nothing),
    (Effect.WALLS, on_a_wall, nothing),
]


def injected(change: Callable[[], object], material: Callable[[], Material]) -> bpy.types.Object:
    """A probe that a material shows, which an injection has fitted to what there is."""
    probe = small_probe(**(change() if change in (turned, off_centre) else {}))
    pretend_bake(probe)
    show(material())
    if change not in (turned, off_centre):
        change()
    put_in()
    bpy.context.view_layer.update()
    return probe


def rough() -> Material:
    material = shiny()
    principled_node(material).inputs["Roughness"].default_value = 0.3
    return material


@pytest.mark.sweep
@pytest.mark.parametrize(("effect", "change", "on"), [
    *((effect, needed, True) for effect, needed, _ in OF_LOOKUPS),
    *((effect, needless, False) for effect, _, needless in OF_LOOKUPS),
], ids=lambda value: getattr(value, "key", None))  # fmt: skip
def test_a_forced_effect_of_a_probe_is_in_its_plan_and_its_lookup_at_once(scene, effect, change, on: bool) -> None:
    probe = injected(change, rough)
    tree = probe.pcc_probe.group
    before, choice = probe_group.shown_effects(tree), "OFF" if on else "ON"
    assert (decided(effect).on, decided(effect).forced) == (on, False)
    setattr(probe.pcc_probe.effects, effect.key, choice)
    assert (decided(effect).on, decided(effect).forced) == (not on, True)
    label = probe_group.shown_effects(tree)
    assert label != before
    called = [node.node_tree.name[:60] for node in tree.nodes if node.bl_idname == "ShaderNodeGroup"]
    assert f"PCC Lookup, {label}"[:60] in called  # Blender 4.5 cuts names
    setattr(probe.pcc_probe.effects, effect.key, "AUTO")
    assert not decided(effect).forced and probe_group.shown_effects(tree) == before


def test_every_effect_of_a_lookup_is_tried() -> None:
    # Relief is nothing without captured distances: test_relief.py.
    assert {effect for effect, *_ in OF_LOOKUPS} == {*OF_PROBES} - {Effect.LEVELS, Effect.FACES, Effect.RELIEF}


def test_forced_hardening_reads_levels_at_once_and_makes_those_that_are_missing(scene) -> None:
    probe = injected(nothing, rough)
    probe.pcc_probe.effects.levels = "AUTO"
    [material] = [m for m in bpy.data.materials if has_twins(m)]
    before = levels_read(material)
    probe.pcc_probe.effects.hardening = "ON"
    bpy.context.view_layer.update()
    assert levels_read(material) > before


@pytest.mark.parametrize(("choice", "levels"), [("ON", len(LADDER)), ("OFF", 1), ("AUTO", 3)])
def test_forced_levels_are_planned(scene, choice: str, levels: int) -> None:
    probe = injected(nothing, rough)
    probe.pcc_probe.effects.levels = choice
    [plan] = plan_scene(scene, bpy.context.view_layer).probes
    assert len(plan.pictures) == levels and decided(Effect.LEVELS).forced == (choice != "AUTO")


# Materials.


def with_input(name: str, value: object) -> Callable[[], Material]:
    def made() -> Material:
        material = rough()
        principled_node(material).inputs[name].default_value = value
        return material

    return made


def fed(kind: str, name: str) -> Callable[[], Material]:
    """Some input is what the first output of a new node says."""

    def made() -> Material:
        material = rough()
        link(material, new(material, kind).outputs[0], principled_node(material).inputs[name])
        return material

    return made


def single_scattering() -> Material:
    material = rough()
    principled_node(material).distribution = "GGX"
    return material


OF_SURFACES = [
    (Effect.MULTISCATTER, rough, single_scattering),
    (Effect.ANISOTROPY, with_input("Anisotropic", 0.8), None),
    (Effect.FILM, with_input("Thin Film Thickness", 400.0), None),
    (Effect.DIELECTRIC, rough, with_input("Metallic", 1.0)),
    (Effect.TINT, with_input("Specular Tint", (1.0, 0.5, 0.25, 1.0)), rough),
    (Effect.METAL, with_input("Metallic", 1.0), rough),
    (Effect.TRANSMISSION, with_input("Transmission Weight", 1.0), None),
    (Effect.ROUGHNESS, fed("ShaderNodeTexNoise", "Roughness"), rough),
    (Effect.BENT_NORMALS, fed("ShaderNodeBump", "Normal"), None),
    (Effect.OWN_LOBE, fed("ShaderNodeTexNoise", "Roughness"), None),
]
"""Effects, materials that need them, and materials that do not and can have them all the same."""


def shader(material: Material) -> tuple[list[tuple[str, str]], list[str]]:
    """What is ours in a material: its nodes, the groups that they call, and the levels that they read."""
    ours = [node for node in material.node_tree.nodes if marks.role(node)]
    named = sorted((n.label, getattr(getattr(n, "node_tree", None), "name", n.bl_idname)) for n in ours)
    return named, sorted(levels_read(material))


def cases() -> Iterator[object]:
    for effect, needing, needless in OF_SURFACES:
        yield pytest.param(effect, needing, True, id=f"{effect.key} off")
        if needless is not None:
            yield pytest.param(effect, needless, False, id=f"{effect.key} on")


@pytest.mark.sweep
@pytest.mark.parametrize(("effect", "make", "on"), cases())
def test_a_forced_effect_of_a_material_is_in_its_plan_and_its_shader_at_once(probe, effect, make, on: bool) -> None:
    material = make()
    show(material)
    put_in()
    before = shader(material)
    assert (decided(effect).on, decided(effect).forced) == (on, False)
    setattr(material.pcc.effects, effect.key, "OFF" if on else "ON")
    assert (decided(effect).on, decided(effect).forced) == (not on, True)
    assert shader(material) != before
    setattr(material.pcc.effects, effect.key, "AUTO")
    assert shader(material) == before and not decided(effect).forced


@pytest.mark.parametrize("effect", [effect for effect, _, needless in OF_SURFACES if needless is None])
def test_what_cannot_be_forced_on_says_so_and_changes_nothing(probe, effect) -> None:
    material = rough()
    show(material)
    put_in()
    before = shader(material)
    setattr(material.pcc.effects, effect.key, "ON")
    decision = decided(effect)
    assert not decision.on and not decision.forced and decision.why.startswith("cannot be forced on: ")
    assert shader(material) == before


def test_every_effect_of_a_material_is_tried() -> None:
    assert {effect for effect, *_ in OF_SURFACES} == {*OF_MATERIALS} - {Effect.BY_PLACE}


def test_a_surface_that_is_too_rough_shows_the_probe_as_soon_as_it_is_told_to(probe) -> None:
    show(rough(), "Other")
    material = with_input("Roughness", 0.9)()
    material.name = "A"
    show(material)
    put_in()
    assert not has_twins(material)
    material.pcc.effects.own_lobe = "OFF"
    assert [*shown_probe_groups(material)] == [probe.pcc_probe.group] and levels_read(material)
    material.pcc.effects.own_lobe = "AUTO"
    assert not levels_read(material)


def test_a_choice_injects_nothing_where_nothing_is_injected(probe) -> None:
    material = with_input("Roughness", 0.9)()
    show(material)
    material.pcc.effects.own_lobe, material.pcc.effects.by_place = "OFF", "ON"
    assert not has_twins(material)


@pytest.fixture
def rooms(scene) -> Material:
    """Four rooms in a row with a probe each, and floors that share a material; it is injected."""
    floor = principled("Floor", Roughness=0.1)
    for k in range(4):
        room = Room((2.0, 1.5, 1.0), (5.0 * k, 0.0, 0.0), 0.0)
        add_wall(room, "-Z", floor).name = f"Floor {k}"
        pretend_bake(small_probe(f"Room {k}", room.centre, room.half_extents))
    put_in()
    return floor


def worn() -> list[Material]:
    return [bpy.data.objects[f"Floor {k}"].material_slots[0].material for k in range(4)]


def test_by_place_is_shown_at_once(rooms) -> None:
    assert len({*worn()}) == 4
    rooms.pcc.effects.by_place = "ON"
    assert {*worn()} == {rooms} and len(shown_probe_groups(rooms)) == 4
    rooms.pcc.effects.by_place = "OFF"
    assert {*worn()} == {rooms} and len(shown_probe_groups(rooms)) == 1
    rooms.pcc.effects.by_place = "AUTO"
    assert len({*worn()}) == 4 and not shown_probe_groups(rooms)


@pytest.mark.parametrize("chosen", ["original", "copy"])
def test_copies_follow_the_choices_of_their_original_and_it_theirs(rooms, chosen: str) -> None:
    (rooms if chosen == "original" else worn()[2]).pcc.effects.metal = "ON"
    assert [m.pcc.effects.metal for m in (rooms, *worn())] == ["ON"] * 5
    assert {*worn()} == {*copies.all_copies()[rooms]} and len({*worn()}) == 4
    for material in worn():
        assert any("metal" in tree for _, tree in shader(material)[0])


# What keeps the choices.


def chosen_both(probe: bpy.types.Object, material: Material) -> tuple[str, str]:
    return probe.pcc_probe.effects.weight, material.pcc.effects.metal


def test_choices_survive_saving_and_loading_and_are_appended(probe, tmp_path) -> None:
    material = rough()
    show(material)
    put_in()
    probe.pcc_probe.effects.weight, material.pcc.effects.metal = "ON", "ON"
    save(tmp_path / "kept.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    material = bpy.data.materials["Shiny"]
    assert chosen_both(bpy.data.objects["Probe"], material) == ("ON", "ON")
    assert any("metal" in tree for _, tree in shader(material)[0])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "kept.blend")) as (_, there):
        there.objects, there.materials = ["Probe"], ["Shiny"]
    assert chosen_both(there.objects[0], there.materials[0]) == ("ON", "ON")


def test_duplicates_have_the_choices_and_each_its_own_from_then_on(probe) -> None:
    material = rough()
    probe.pcc_probe.effects.weight, material.pcc.effects.metal = "OFF", "OFF"
    other, another = probe.copy(), material.copy()
    assert chosen_both(other, another) == ("OFF", "OFF")
    other.pcc_probe.effects.weight = another.pcc.effects.metal = "ON"
    assert chosen_both(probe, material) == ("OFF", "OFF")


def test_a_choice_is_one_undo_step_and_undo_brings_the_shader_back(probe) -> None:
    show(rough())
    put_in()
    before = shader(bpy.data.materials["Shiny"])
    bpy.ops.ed.undo_push(message="before")
    bpy.data.materials["Shiny"].pcc.effects.metal = "ON"
    bpy.ops.ed.undo_push(message="chosen")
    after = shader(bpy.data.materials["Shiny"])
    assert after != before
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    assert shader(bpy.data.materials["Shiny"]) == before and bpy.data.materials["Shiny"].pcc.effects.metal == "AUTO"
    bpy.ops.ed.redo()
    bpy.context.view_layer.update()
    assert shader(bpy.data.materials["Shiny"]) == after
