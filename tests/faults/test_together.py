"""Several processes at one file, and a Blender that goes away while another works for it."""

from __future__ import annotations

import os

import bpy
import pytest

from pcc_addon.blender import devices
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.status import statuses
from pcc_addon.core.kept_faces import FOLDER

from .hall import Hall, check
from .processes import Victim
from .tally import fault

pytestmark = pytest.mark.skipif(os.name != "posix", reason="waits for processes as POSIX systems have them")


def test_two_processes_bake_the_same_file(place: Hall) -> None:
    both = [Victim(place.temporary), Victim(place.temporary)]
    for victim in both:
        victim.go(place)
    with fault("several processes at one file"):
        assert [victim.ended() for victim in both] == [(0, []), (0, [])]
        assert check(place), "who saved last has its own bake"


@pytest.mark.heavy
def test_a_file_is_saved_by_another_while_it_is_baked(place: Hall) -> None:
    """As in a window: what is saved last is what is there, whole."""
    victim = Victim(place.temporary)
    victim.go(place, "bake", "--save", "--resolution=64", "--samples=16")
    victim.wait_for("face -X")
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    bpy.ops.wm.save_mainfile()
    with fault("several processes at one file"):
        assert victim.ended() == (0, [])
        bpy.ops.wm.open_mainfile(filepath=str(place.blend))
        assert all(probe.pcc_probe.resolution == 64 for probe in all_probes(bpy.context.scene))
        found = statuses(bpy.context.scene, bpy.context.view_layer)
        assert [status.state for status in found] == ["baked", "baked"]
        assert {path.name for path in place.blend.parent.iterdir()} == {"hall.blend", "hall.blend1", "hall.pcc"}


def test_who_bakes_for_a_blender_that_is_gone_stops(place: Hall) -> None:
    """The background bake's second Blender, whose first was killed: its pipe is closed."""
    victim = Victim(place.temporary)
    before = place.everything()
    attended = f"--attended={devices.chosen().to_json()}"
    victim.go(place, "bake", "--json", attended, "--resolution=128", "--samples=16", f"--folder={place.pictures}")
    victim.wait_for("face +X")
    victim.process.stdout.close()
    with fault("several processes at one file"):
        assert victim.process.wait(timeout=120) == 130, "before it had rendered all"
        left = {name: held for name, held in place.everything().items() if f"/{FOLDER}/" not in name}
        assert left == before, "but for faces to go on from"
        check(place)
