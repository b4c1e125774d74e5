"""How probes stand, in one word and a sentence; nothing is rendered here."""

from __future__ import annotations

from dataclasses import replace

import bpy
import pytest

from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.status import ProbeStatus, stale_probes, statuses
from pcc_addon.core.sequence import Moment
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


@pytest.mark.parametrize(
    ("content_hash", "which"), [("0123abcd" * 8, "an earlier"), ("1:0123abcd", "an earlier"), ("99:0123", "a later")]
)
def test_a_bake_of_another_version_says_why_it_is_stale(baked, content_hash: str, which: str) -> None:
    baked.pcc_probe.bake_record = replace(bake_record(baked), content_hash=content_hash).to_json()
    why = f"it was baked by {which} version of the add-on, which looked at other things; bake it again"
    assert found() == [ProbeStatus("Baked", "stale", why)]


def test_frames_of_another_version_say_why_they_are_stale(baked) -> None:
    moments = tuple(Moment(frame, f"{frame}" * 8, 0, (0.0, 0.0, 0.0)) for frame in (1, 2))
    baked.pcc_probe.bake_record = replace(bake_record(baked), moments=moments).to_json()
    [status] = found()
    assert status.stale_frames == (1, 2) and status.why.startswith("it was baked by an earlier version of the add-on")
