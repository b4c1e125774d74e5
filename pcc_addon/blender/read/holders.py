"""Which pictures and identities probes share with their copies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import bpy


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

    def share(self, image: bpy.types.Image) -> bool:
        """Whether several probes show a picture."""
        return self._pictures[image.session_uid] > 1

    def let_go_identity(self, uid: str) -> None:
        """A probe has this identity no more, but one of its own."""
        self._identities[uid] -= 1

    def let_go(self, images: Iterable[bpy.types.Image]) -> None:
        """A probe shows some pictures no more."""
        self._pictures.subtract({image.session_uid for image in images})
