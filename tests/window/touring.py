"""The tour's file, and what its steps cost a person."""

from __future__ import annotations

from collections.abc import Mapping

import bpy

FLOOR = "tour floor"  # of a scene: a place of another room's floor that the camera sees, for `drive_tour.py`
MOST_CLICKS, MOST_SECONDS = 12, 120.0

# Seconds by the Keystroke-Level Model (Card, Moran and Newell 1980): to think, to point, to press or let go a button,
# to press a key, to bring the hand from mouse to keyboard or back.
_THINK, _POINT, _BUTTON, _KEY, _HAND = 1.35, 1.1, 0.1, 0.28, 0.4


def seconds(step: Mapping[str, object]) -> float:
    """A person's time for a step as `drive_tour.py` notes it; waiting for the machine is not in it."""
    clicks, keys = step["clicks"], step["keys"]
    acts = clicks + keys
    return acts * _THINK + clicks * (_POINT + 2.0 * _BUTTON) + keys * (_KEY + 2.0 * _HAND)


def two_rooms_without_probes() -> bpy.types.Scene:
    """Two furnished rooms with one floor, which is seen by the camera through the doorway between them."""
    from sample_blends.two_rooms import DOORWAY_Y, STUDY, two_rooms

    scene = two_rooms(doorway=True)
    for item in [item for item in scene.objects if item.pcc_probe.is_probe]:
        bpy.data.objects.remove(item)
    scene[FLOOR] = STUDY.world(-STUDY.half_extents[0] + 0.3, DOORWAY_Y + 0.2, -STUDY.half_extents[2])
    return scene
