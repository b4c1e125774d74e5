"""A probe that was copied and not baked since: status and plan say whose pictures it shows, and others go before it."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import pytest

from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.status import ProbeStatus, statuses
from sample_blends.scenes import principled
from tests.blender.helpers import pretend_bake, put_in, shown_group, small_probe
from tests.blender.materials import shiny, show

COPIED = "it is a copy of 'Probe', whose pictures it shows until it is baked"


def status_of(name: str) -> ProbeStatus:
    return next(s for s in statuses(bpy.context.scene, bpy.context.view_layer) if s.probe == name)


def duplicate(probe: bpy.types.Object, name: str = "Copy") -> bpy.types.Object:
    copy = probe.copy()
    copy.name = name
    bpy.context.scene.collection.objects.link(copy)
    copy.location.x += 20.0
    bpy.context.view_layer.update()
    return copy


def reasons(name: str) -> tuple[str, ...]:
    return plan_scene(bpy.context.scene, bpy.context.view_layer).probe(name).reasons


def test_a_copy_says_whose_pictures_it_shows_until_it_has_its_own(probe) -> None:
    copy = duplicate(probe)
    found = status_of("Copy")
    assert found.state == "stale" and found.copy_of == "Probe" and found.words.startswith(COPIED)
    assert not status_of("Probe").copy_of
    assert reasons("Copy")[1].startswith(COPIED)
    pretend_bake(copy)
    assert not status_of("Copy").copy_of and not any("copy" in reason for reason in reasons("Copy"))


def rename_original(probe: bpy.types.Object, copy: bpy.types.Object) -> str:
    probe.name = "Zed"
    return "Zed"


def swap_names(probe: bpy.types.Object, copy: bpy.types.Object) -> str:
    probe.name, copy.name = "Away", "Probe"
    return "Away"


def move_both(probe: bpy.types.Object, copy: bpy.types.Object) -> str:
    probe.location.y += 20.0
    return "Probe"


def move_neither(probe: bpy.types.Object, copy: bpy.types.Object) -> str:
    copy.location = probe.location
    return "Probe"


@pytest.mark.parametrize("act", [rename_original, swap_names, move_both, move_neither])
def test_the_original_is_known_by_its_place_and_its_name(probe, act: Callable) -> None:
    copy = duplicate(probe)
    original = act(probe, copy)
    bpy.context.view_layer.update()
    assert status_of(copy.name).copy_of == original and not status_of(original).copy_of


@pytest.mark.parametrize("how", ["deleted", "unlinked"])
def test_what_is_left_of_an_original_and_its_copy_is_no_copy(probe, how: str) -> None:
    duplicate(probe)
    if how == "deleted":
        bpy.data.objects.remove(probe)
    else:
        bpy.context.scene.collection.objects.unlink(probe)
    assert not status_of("Copy").copy_of


def test_a_copy_that_is_moved_onto_another_probe_does_not_take_its_surfaces_over(probe) -> None:
    """Called so that its name would come first."""
    other = small_probe("Other", (23.0, -2.0, 1.0))
    pretend_bake(other)
    here, there = shiny("Here"), principled("There")
    show(here)
    show(there, "Second").location.x += 20.0
    copy = duplicate(probe, "A")
    put_in()
    material = bpy.data.materials["There"]
    order = [node.node_tree for node in material.node_tree.nodes if getattr(node, "node_tree", None)]
    shown = [tree for tree in order if tree in (other.pcc_probe.group, copy.pcc_probe.group)]
    assert shown[0] == copy.pcc_probe.group and shown[-1] == other.pcc_probe.group
    assert shown_group(here) == probe.pcc_probe.group
