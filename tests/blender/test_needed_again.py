"""Nothing that is needed is silently missing: what a scene calls for after an edit is shown at once, or said."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass

import bpy
import pytest

from pcc_addon.blender import handlers, marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.shade.surface_builder import PROBE
from pcc_addon.blender.status import statuses, waiting_probes
from pcc_addon.core.decisions import Effect
from pcc_addon.core.lookup_plan import lacking
from sample_blends.scenes import Room, add_box, add_camera, add_wall, principled, principled_node
from tests.blender.helpers import bake, glow, put_in, small_probe
from tests.blender.materials import image_texture, link, new, output_of

ROOM = Room((2.0, 1.5, 1.0), (3.0, -2.0, 1.0), 0.0)


def update() -> None:
    bpy.context.view_layer.update()


@pytest.fixture
def room(scene: bpy.types.Scene) -> bpy.types.Object:
    """The probe of a room in which as much is left out as can be: a mirroring table amid it, seen from inside."""
    for side, color in zip(("+X", "-X", "+Y", "-Y", "+Z", "-Z"), _HUES, strict=True):
        add_wall(ROOM, side, glow(f"Glow {side}", color))
    add_box(ROOM, "Table", (0.0, 0.0, -0.4), (0.4, 0.3, 0.1), principled("Table", Roughness=0.0))
    add_camera(ROOM.world(-1.5, -1.0, 0.5), ROOM.world(0.0, 0.0, -0.4), 20.0, 16, 9)
    scene.cycles.samples = 1
    probe = small_probe("Hall", ROOM.centre, ROOM.half_extents)
    probe.pcc_probe.effects.levels = "AUTO"
    update()
    bake(probe)
    put_in()
    update()
    assert said() == {}
    found = on()
    assert found == {Effect.PARALLAX, Effect.DIELECTRIC, Effect.FACES}, found  # a table mirrors up and down
    return probe


_HUES = [(1.0, 0.2, 0.1), (0.1, 0.9, 0.3), (0.2, 0.3, 1.0), (0.9, 0.8, 0.1), (0.8, 0.1, 0.9), (0.9, 0.9, 0.9)]


def on() -> set[Effect]:
    """The effects that the plan has on, of anything."""
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    surfaces = [surface for material in plan.materials if material.probes for surface in material.surfaces]
    planned = [*plan.probes, *(m for m in plan.materials if m.probes), *surfaces]
    return {decision.effect for each in planned for decision in each.decisions if decision.on}


def said() -> dict[str, str]:
    """What status has to say of each probe that is not as it should be."""
    found = statuses(bpy.context.scene, bpy.context.view_layer)
    return {status.probe: status.words for status in found if status.state != "baked" or status.outdated}


def is_shown() -> bool:
    """Whether shaders have all that the plan says; asked of the nodes, and of what an injection makes of them."""
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer)
    showing = {name for material in plan.materials for name in material.probes}
    for probe in (probe for probe in plan.probes if probe.probe in showing):
        item = bpy.data.objects[probe.probe]
        built = probe_group.built_lookup(item.pcc_probe.group) if item.pcc_probe.group else None
        there = {round(level.roughness, 4) for level in item.pcc_probe.levels}
        if built is None or lacking(built, probe.lookup) or not there >= set(probe.roughnesses):
            return False
    before = computed()
    put_in()
    update()
    return computed() == before


def computed() -> dict[str, list[tuple]]:
    """What each material's active tree computes of its surfaces, from which pictures of which probes.

    A probe's own group may compute more than an injection would let it.
    """
    return {
        material.name: sorted(
            (node.node_tree.name, tuple(socket.name for socket in node.inputs if socket.is_linked))
            for node in material.node_tree.nodes
            if node.bl_idname == "ShaderNodeGroup"
            and node.node_tree
            and not node.node_tree.name.startswith(("PCC Own Lobe", "PCC Probe"))
        )
        + sorted({node.node_tree.name for node in material.node_tree.nodes if marks.role(node) == PROBE})
        for material in bpy.data.materials
        if material.node_tree
    }


def table() -> bpy.types.Object:
    return bpy.data.objects["Table"]


def surface() -> bpy.types.Node:
    return principled_node(bpy.data.materials["Table"])


def hall() -> bpy.types.Object:
    return bpy.data.objects["Hall"]


def out_of_the_box() -> None:
    table().location.x += 1.9


def far_away() -> None:
    table().location.x += 50.0


def onto_a_wall() -> None:
    table().location.x += 1.6


def camera_outside() -> None:
    onto_a_wall()
    update()
    put_in()
    bpy.context.scene.camera.location.x -= 5.0


def parallel_camera() -> None:
    onto_a_wall()
    update()
    put_in()
    bpy.context.scene.camera.data.type = "ORTHO"


def turned() -> None:
    hall().rotation_euler.z = 0.3


def leaning() -> None:
    hall().rotation_euler.x = 0.3


def moved() -> None:
    hall().location.x += 0.2


def shrunk() -> None:
    hall().scale.x *= 0.1


def rough() -> None:
    surface().inputs["Roughness"].default_value = 0.2


def rougher() -> None:
    rough()
    update()
    surface().inputs["Roughness"].default_value = 0.5


def rough_by_texture() -> None:
    link(
        bpy.data.materials["Table"],
        image_texture(bpy.data.materials["Table"]).outputs[0],
        surface().inputs["Roughness"],
    )


def normal_map() -> None:
    material = bpy.data.materials["Table"]
    bump = new(material, "ShaderNodeBump")
    link(material, image_texture(material).outputs[0], bump.inputs["Height"])
    link(material, bump.outputs["Normal"], surface().inputs["Normal"])


def metal() -> None:
    surface().inputs["Metallic"].default_value = 0.5


def tint() -> None:
    surface().inputs["Specular Tint"].default_value = (1.0, 0.5, 0.2, 1.0)


def clear() -> None:
    surface().inputs["Transmission Weight"].default_value = 1.0


def film() -> None:
    surface().inputs["Thin Film Thickness"].default_value = 400.0


def brushed() -> None:
    rough()
    surface().inputs["Anisotropic"].default_value = 0.6


def weight() -> None:
    hall().pcc_probe.weight = 0.5


def faces() -> None:
    hall().pcc_probe.influence_high[0] = 0.5


def falloffs() -> None:
    hall().pcc_probe.falloff_per_face = True
    hall().pcc_probe.falloff_high[0] = 0.7


def normal_fade() -> None:
    hall().pcc_probe.normal_fade = 0.5


def hardening() -> None:
    rough()
    update()
    hall().pcc_probe.contact_hardening = True


def rough_where_it_hardens() -> None:
    hall().pcc_probe.contact_hardening = True
    update()
    put_in()
    rough()


def capture_point() -> None:
    hall().pcc_probe.capture_offset[0] = 0.4


def second_room() -> None:
    other = small_probe("Study", ROOM.world(0.0, 2.0, 0.0), (2.0, 2.0, 1.0))
    other.pcc_probe.effects.levels = "AUTO"
    bake(other)


def glossy_ball() -> None:
    add_box(ROOM, "Ball", (0.5, 0.5, 0.2), (0.1, 0.1, 0.1), principled("Ball", Roughness=0.3))


def same_material_elsewhere() -> None:
    add_box(ROOM, "Other Table", (9.0, 0.0, 0.0), (0.4, 0.3, 0.1), bpy.data.materials["Table"])


def animated_table() -> None:
    table().keyframe_insert("location", frame=1)
    table().location.x += 3.0
    table().keyframe_insert("location", frame=10)
    bpy.context.scene.frame_set(1)


def animated_probe() -> None:
    hall().keyframe_insert("location", frame=1)
    hall().location.x += 1.0
    hall().keyframe_insert("location", frame=10)
    bpy.context.scene.frame_set(1)


def animated_camera() -> None:
    onto_a_wall()
    update()
    put_in()
    bpy.context.scene.camera.keyframe_insert("location", frame=1)


def animated_roughness() -> None:
    socket = surface().inputs["Roughness"]
    socket.keyframe_insert("default_value", frame=1)
    socket.default_value = 0.5
    socket.keyframe_insert("default_value", frame=10)
    bpy.context.scene.frame_set(1)


def following_constraint() -> None:
    table().constraints.new("COPY_LOCATION").target = bpy.context.scene.camera
    table().constraints[0].influence = 0.0


def rigid_body() -> None:
    bpy.context.view_layer.objects.active = table()
    bpy.ops.rigidbody.object_add(type="ACTIVE")


def array_by_a_moving_object() -> None:
    empty = bpy.data.objects.new("Guide", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.location = table().location
    empty.keyframe_insert("location", frame=1)
    empty.location.x = 9.0
    empty.keyframe_insert("location", frame=10)
    bpy.context.scene.frame_set(1)
    modifier = table().modifiers.new("Array", "ARRAY")
    modifier.use_relative_offset, modifier.use_object_offset, modifier.offset_object = False, True, empty


def moving_instance() -> None:
    inner = bpy.data.collections.new("Inner")
    bpy.context.scene.collection.objects.unlink(table())
    inner.objects.link(table())
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    bpy.context.scene.collection.objects.link(empty)
    empty.keyframe_insert("location", frame=1)
    empty.location.x = 9.0
    empty.keyframe_insert("location", frame=10)
    bpy.context.scene.frame_set(1)


def displaced() -> None:
    material = bpy.data.materials["Table"]
    node = new(material, "ShaderNodeDisplacement")
    node.inputs["Scale"].default_value = 3.0
    link(material, node.outputs[0], output_of(material).inputs["Displacement"])
    material.displacement_method = "DISPLACEMENT"


def limit() -> None:
    rougher()
    update()
    put_in()
    update()
    material = bpy.data.materials["Table"]
    link(material, image_texture(material).outputs[0], surface().inputs["Roughness"])
    bpy.context.scene.pcc.roughness_limit = 0.3


def forced(effect: Effect) -> Callable[[], None]:
    def force() -> None:
        settings = (
            hall().pcc_probe if hasattr(hall().pcc_probe.effects, effect.key) else bpy.data.materials["Table"].pcc
        )
        setattr(settings.effects, effect.key, "ON")

    force.__name__ = f"forced {effect.key}"
    return force


@dataclass(frozen=True)
class Row:
    """A change of the scene and the effects that it calls for."""

    change: Callable[[], None]
    needs: frozenset[Effect]


def row(change: Callable[[], None], *needs: Effect) -> Row:
    return Row(change, frozenset(needs))


ROWS = [
    row(out_of_the_box, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(far_away),
    row(onto_a_wall, Effect.WALLS),
    row(camera_outside, Effect.OUTER_SIDES, Effect.FADE),
    row(parallel_camera, Effect.OUTER_SIDES, Effect.FADE),
    row(turned, Effect.TURN),
    row(leaning, Effect.TURN),
    row(moved, Effect.OFFSET),
    row(shrunk, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(rough, Effect.MULTISCATTER),
    row(rougher, Effect.MULTISCATTER),
    row(rough_by_texture, Effect.ROUGHNESS, Effect.LEVELS, Effect.OWN_LOBE),
    row(normal_map, Effect.BENT_NORMALS),
    row(metal, Effect.METAL),
    row(tint, Effect.TINT),
    row(clear, Effect.TRANSMISSION, Effect.WALLS),
    row(film, Effect.FILM),
    row(brushed, Effect.ANISOTROPY),
    row(weight, Effect.WEIGHT),
    row(faces, Effect.FACE_FALLOFFS),
    row(falloffs, Effect.FACE_FALLOFFS),
    row(normal_fade, Effect.NORMAL_FADE),
    row(hardening, Effect.HARDENING),
    row(rough_where_it_hardens, Effect.HARDENING),
    row(capture_point),
    row(second_room, Effect.BY_PLACE),
    row(glossy_ball),
    row(same_material_elsewhere, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(animated_table, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(animated_probe, Effect.TURN, Effect.OFFSET, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(animated_camera, Effect.OUTER_SIDES, Effect.FADE),
    row(animated_roughness, Effect.ROUGHNESS, Effect.LEVELS, Effect.OWN_LOBE),
    row(following_constraint, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(rigid_body, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(array_by_a_moving_object, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(moving_instance, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(displaced, Effect.FADE, Effect.OUTER_SIDES, Effect.WALLS),
    row(limit, Effect.OWN_LOBE),
    *(row(forced(effect), effect) for effect in Effect if effect.lossless and effect is not Effect.FACES),
]


@pytest.mark.sweep
@pytest.mark.parametrize("live", [True, pytest.param(False, marks=pytest.mark.heavy)], ids=["live", "unseen"])
@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.change.__name__)
def test_what_is_needed_again_is_shown_or_said(room: bpy.types.Object, row: Row, live: bool) -> None:
    """Whether shaders follow the edit at once, or nothing of ours runs meanwhile, as where a script makes it."""
    with nullcontext() if live else handlers.paused():
        row.change()
        update()
    assert row.needs <= on()
    before = said()
    assert before or is_shown(), "status says nothing, and shaders lack it"
    waiting = waiting_probes(
        bpy.context.scene, bpy.context.view_layer, [o for o in bpy.context.scene.objects if o.pcc_probe.is_probe]
    )
    bake(*waiting.probes)
    update()
    assert said() or is_shown(), "after the bake status says nothing, and shaders lack it"
    put_in()
    update()
    assert is_shown()
    left = statuses(bpy.context.scene, bpy.context.view_layer)
    assert not [status.words for status in left if (status.state != "baked" and not status.unneeded) or status.outdated]


@pytest.mark.parametrize("change", [far_away, out_of_the_box], ids=lambda change: change.__name__)
def test_a_material_that_no_probe_reaches_any_more_is_said_after_a_bake_too(room: bpy.types.Object, change) -> None:
    """The bake's groups are made for what is to show the probe, which the material is not, or no more like this."""
    change()
    update()
    bake(room)
    update()
    assert "Table" in said().get("Hall", "") or is_shown()
    put_in()
    assert is_shown()
