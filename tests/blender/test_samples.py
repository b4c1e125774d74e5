"""The sample files: whole, small, and such as what builds them makes."""

from __future__ import annotations

import bpy
import pytest

from benchmarks.gallery_systems import SYSTEMS
from benchmarks.measure import ROOT
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.shade.by_hand import groups_of
from pcc_addon.blender.status import statuses
from sample_blends import by_hand, glass, interior
from sample_blends.build import FOLDER, SAMPLES

LARGEST = 1_500_000
BAKED = {"by_hand.blend", "interior.blend"}  # what they show needs a bake at once


def states() -> dict[str, str]:
    """The state of each probe, by name."""
    bpy.context.view_layer.update()
    return {found.probe: found.state for found in statuses(bpy.context.scene, bpy.context.view_layer)}


def test_every_file_has_a_builder() -> None:
    assert {path.name for path in FOLDER.glob("*.blend")} == SAMPLES.keys()


@pytest.mark.parametrize("name", sorted(SAMPLES))
def test_a_file_is_small_and_its_probes_are_as_said(addon, name: str) -> None:
    path = FOLDER / name
    assert path.stat().st_size <= LARGEST
    bpy.ops.wm.open_mainfile(filepath=str(path))
    missing = [image.name for image in bpy.data.images if image.source == "FILE" and not image.packed_file]
    assert not missing
    found = set(states().values())
    # A later Blender changes materials and lamps when it opens the file: what they bake is another picture then.
    also = {"stale"} if bpy.app.version[:2] != bpy.data.version[:2] else set()
    assert found and found <= ({"baked"} | also if name in BAKED else {"unbaked"})


@pytest.mark.parametrize("build", [lambda: interior.interior(8, 1), lambda: by_hand.by_hand(8, 1)])
def test_a_scene_that_comes_baked_is_not_stale(addon, build) -> None:
    """What is added after the bake, as it shows the bake, does not count."""
    build()
    assert states() == {"Room": "baked"}


def test_the_things_of_glass_show_the_probe_that_leaves_them_out(addon) -> None:
    glass.glass()
    bpy.context.view_layer.update()
    [plan] = [p for p in plan_scene(bpy.context.scene, bpy.context.view_layer).materials if p.material == "Glass"]
    assert {name for name, _ in plan.objects} == {"Ball", "Egg", "Pane"} and plan.probes == ("Room",)
    hidden = {item.object.name for item in bpy.data.objects["Room"].pcc_probe.hidden_objects}
    assert hidden == {"Ball", "Egg", "Pane"}


def test_shaders_made_by_hand_use_each_output_of_the_probes_group(addon) -> None:
    by_hand.by_hand(8, 1)
    [group] = groups_of(bpy.data.objects["Room"])
    used = set()
    for name in ("Iridescent", "Toon", "In Mist"):
        tree = bpy.data.materials[name].node_tree
        used |= {link.from_socket.name for link in tree.links if getattr(link.from_node, "node_tree", None) == group}
    assert used == {"Radiance", "Weight", "Distance"}


def test_the_gallery_shows_every_system_and_has_its_strips() -> None:
    whole = (ROOT / "docs" / "systems.md").read_text(encoding="utf-8")
    lines = whole.partition("## Beyond the technique")[0].splitlines()
    titles = [line.split("|")[1].strip() for line in lines if line.startswith("| ")][2:]
    assert titles == [system.title for system in SYSTEMS]
    strips = {path.stem: path.stat().st_size for path in (ROOT / "docs" / "images" / "gallery").glob("*.png")}
    assert strips.keys() == {system.name for system in SYSTEMS} and max(strips.values()) <= 70_000
