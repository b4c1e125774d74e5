"""How probes stand, in one word and a sentence; nothing is rendered here."""

from __future__ import annotations

from dataclasses import replace

import bpy
import pytest

from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.status import ProbeStatus, stale_probes, statuses
from tests.blender.helpers import pretend_bake, small_probe
from tests.blender.materials import shiny, show


def found() -> list[ProbeStatus]:
    return statuses(bpy.context.scene, bpy.context.view_layer)


@pytest.fixture
def baked(scene) -> bpy.types.Object:
    """A probe whose bake counts as one of the scene as it is, which has an object called "Mesh"."""
    probe = small_probe("Baked")
    show(shiny())
    pretend_bake(probe)
    fingerprint = SceneFingerprint(scene, bpy.context.view_layer)
    record = replace(bake_record(probe), content_hash=fingerprint.content_hash(probe_spec(probe)))
    probe.pcc_probe.bake_record = record.to_json()
    return probe


def test_every_probe_has_its_state_by_name(baked) -> None:
    faulty, unbaked, elsewhere = (small_probe(name) for name in ("Faulty", "Unbaked", "Attic"))
    pretend_bake(faulty)
    faulty.pcc_probe.levels[0].image = None
    collection = bpy.data.collections.new("Attic")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(elsewhere)
    bpy.context.scene.collection.objects.unlink(elsewhere)
    bpy.context.view_layer.layer_collection.children["Attic"].exclude = True
    first, *rest = found()
    assert (first.probe, first.state) == ("Attic", "error") and "leaves its collection out" in first.why
    assert rest == [
        ProbeStatus("Baked", "baked", ""),
        ProbeStatus("Faulty", "stale", "its picture of roughness 0 is missing from the file; bake it again"),
        ProbeStatus("Unbaked", "unbaked", "it has no bake"),
    ]
    among = [unbaked, baked, elsewhere, faulty]
    assert stale_probes(bpy.context.scene, bpy.context.view_layer, among) == [unbaked, elsewhere, faulty]
    assert stale_probes(bpy.context.scene, bpy.context.view_layer, [baked]) == []


@pytest.mark.parametrize("moved", ["Mesh", "Baked"])
def test_a_move_makes_a_bake_stale_at_once(baked, moved: str) -> None:
    bpy.data.objects[moved].location.x += 0.5  # Blender has not seen it yet
    assert found() == [ProbeStatus("Baked", "stale", "the scene or the probe changed since its bake")]
