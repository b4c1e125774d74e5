"""Which pictures and identities probes share with their copies, and which of these is the original."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import bpy
import numpy as np

from ...core.errors import PccError
from .probes import bake_record, placed_objects


class Holders:
    """How many probes of the file hold each picture and each identity, counted once for all that are stored."""

    def __init__(self) -> None:
        probes = [item.pcc_probe for item in bpy.data.objects if item.type == "EMPTY"]
        self._identities = Counter(settings.uid for settings in probes if settings.is_probe)
        self._pictures: Counter[int] = Counter()
        for settings in probes:
            self._pictures.update({level.image.session_uid for level in settings.levels if level.image})

    def share_identity(self, uid: str) -> bool:
        """Whether several probes have an identity."""
        return self._identities[uid] > 1

    def has_identity(self, uid: str) -> bool:
        """Whether any probe has an identity."""
        return self._identities[uid] > 0

    def share(self, image: bpy.types.Image) -> bool:
        """Whether several probes show a picture."""
        return self._pictures[image.session_uid] > 1

    def let_go_identity(self, uid: str) -> None:
        """A probe has this identity no more, but one of its own."""
        self._identities[uid] -= 1

    def let_go(self, images: Iterable[bpy.types.Image]) -> None:
        """A probe shows some pictures no more."""
        self._pictures.subtract({image.session_uid for image in images})


def originals() -> dict[str, str]:
    """By the name of each probe that shows another one's pictures the name of that: it was copied and not baked since.

    Copies have the identity of their original until they are baked. That is the original which stands where the bake
    was made, of several the one that is called as it was then.
    """
    alike: dict[str, list[bpy.types.Object]] = {}
    placed = placed_objects()
    for item in bpy.data.objects:
        if item.type == "EMPTY" and item.pcc_probe.uid and item.library is None and item in placed:
            alike.setdefault(item.pcc_probe.uid, []).append(item)
    found = {}
    for probes in alike.values():
        first = min(probes, key=_strangeness) if len(probes) > 1 else probes[0]
        found.update({probe.name: first.name for probe in probes if probe != first})
    return found


def _strangeness(probe: bpy.types.Object) -> tuple[bool, bool, str]:
    """What is greater the less a probe is like the one that was baked; the name decides where nothing else does."""
    try:
        record = bake_record(probe)
    except PccError:
        record = None
    if record is None:
        return True, True, probe.name
    moved = not np.allclose(np.reshape(record.matrix, (4, 4))[:3, 3], probe.matrix_world.translation, atol=1e-4)
    return moved, record.probe != probe.name, probe.name
