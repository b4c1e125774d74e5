"""The pictures of an animated probe: one file for each thing that it sees, kept until all of a new bake are there."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ...core import sidecar
from ...core.errors import BakeError
from ...core.pictures import PictureKey, PictureKind
from ...core.prefilter import prefilter
from ...core.radiance import as_half
from ...core.workplace import link
from ..read.holders import Holders
from . import pictures
from .keeping import cannot_write, folder_for_parts, rung, take_in

Shown = dict[float, sidecar.Level]  # the levels of one picture, by roughness


def check_packing(probe: str, folder: Path | None) -> Path:
    """The folder of a sequence.

    Raises:
        BakeError: there is none: Blender packs no sequences.
    """
    if folder is None:
        raise BakeError(
            f"probe '{probe}': pictures of several frames cannot be packed into the file; save it first, or choose a "
            "folder for the scene's pictures"
        )
    return folder


class Reel:
    """A sequence while it is baked: its files lie aside until `store` moves them into place."""

    def __init__(self, stack: ExitStack, probe: bpy.types.Object, folder: Path, roughnesses: Iterable[float]) -> None:
        """The unfinished files go when `stack` closes.

        Args:
            stack: of the bake.
            probe: the probe object; its `uid` is set.
            folder: where the files will be.
            roughnesses: of its levels, with 0 for the captures themselves.

        Raises:
            BakeError: nothing can be written there.
        """
        self._probe, self._folder, self._roughnesses = probe, folder, sorted(roughnesses)
        self._parts = folder_for_parts(stack, folder)
        self._levels: dict[int, Shown] = {}

    def add(self, number: int, shown: Mapping[float, np.ndarray]) -> None:
        """Write the levels (h, 2h, 3) of a picture aside.

        Raises:
            BakeError: a file cannot be written.
        """
        for roughness in self._roughnesses:
            path, half = self._part(number, roughness), self._probe.pcc_probe.half_float
            picture = as_half(shown[roughness]) if half else shown[roughness]
            pictures.write_file(path, picture, half=half)
            height, width = picture.shape[:2]
            digest = sidecar.digest_of(picture)
            self._note(number, roughness, sidecar.Level(_NO_KEY, roughness, "", width, height, 0, digest))

    def reuse(self, number: int, shown: Shown, folder: Path) -> None:
        """Take the levels of a picture from files of a folder, which stay where they are.

        Raises:
            BakeError: one cannot be read or copied.
        """
        for roughness in self._roughnesses:
            level = shown[roughness]
            try:
                link(folder / level.file, self._part(number, roughness))
            except OSError as error:
                raise BakeError(cannot_write(self._probe, self._folder, error)) from error
            self._note(number, roughness, level)

    def store(self, record: sidecar.Sidecar, holders: Holders | None = None) -> None:
        """Move all files into place and let the probe show them; its levels are filled into the record here.

        Args:
            record: of the bake.
            holders: who shows which pictures, where that was asked before.

        Raises:
            BakeError: a file cannot be moved; what was there before is untouched.
        """
        stem = sidecar.file_stem(self._probe.name, record.uid)
        numbers = sorted(self._levels)
        described = [level for k, r in enumerate(self._roughnesses) for level in self._described(stem, k, r, numbers)]
        record = replace(record, levels=tuple(described))
        try:
            for level in described:
                os.replace(self._part(level.key.number, level.roughness), self._parts / level.file)
        except OSError as error:
            raise BakeError(cannot_write(self._probe, self._folder, error)) from error
        with pictures.desk():
            take_in(self._probe, record, self._parts, self._folder, holders or Holders())

    def _described(self, stem: str, k: int, roughness: float, numbers: Sequence[int]) -> list[sidecar.Level]:
        """One level of all pictures. Their common name depends on all of them."""
        levels = [self._levels[number][roughness] for number in numbers]
        digest = sidecar.digest_of_all([level.digest for level in levels])
        keys = [PictureKey(PictureKind.RADIANCE, k, number) for number in numbers]
        return [
            replace(level, key=key, file=sidecar.level_file(stem, key, digest))
            for level, key in zip(levels, keys, strict=True)
        ]

    def _part(self, number: int, roughness: float) -> Path:
        return self._parts / f"part-{rung(roughness)}-{number}.exr"

    def _note(self, number: int, roughness: float, level: sidecar.Level) -> None:
        size = self._part(number, roughness).stat().st_size
        self._levels.setdefault(number, {})[roughness] = replace(level, roughness=roughness, size=size)


_NO_KEY = PictureKey(PictureKind.RADIANCE, 0, 0)  # until all pictures are known


def known_pictures(
    probe: bpy.types.Object, record: sidecar.Sidecar | None, folder: Path, roughnesses: Iterable[float]
) -> dict[str, Shown]:
    """The pictures of a probe's last sequence that can be used again, by the hash of what they show.

    Those that lack a level, or whose files are not what was baked, are none.
    """
    shown: dict[int, Shown] = {}
    wanted = {rung(roughness): roughness for roughness in roughnesses}
    for level in record.levels if record else ():
        path = folder / level.file
        if rung(level.roughness) in wanted and path.is_file() and path.stat().st_size == level.size:
            shown.setdefault(level.key.number, {})[wanted[rung(level.roughness)]] = level
    whole = {number: levels for number, levels in shown.items() if len(levels) == len(wanted)}
    return {m.content_hash: whole[m.number] for m in (record.moments if record else ()) if m.number in whole}


def add_levels(probe: bpy.types.Object, record: sidecar.Sidecar, missing: Sequence[float], folder: Path | None) -> None:
    """Make further levels of a sequence from its captures.

    Raises:
        BakeError: a capture is missing, or a level cannot be written.
    """
    place = check_packing(probe.name, folder)
    have = sorted({level.roughness for level in record.levels})
    known = known_pictures(probe, record, place, have)
    by_number = {moment.number: known.get(moment.content_hash) for moment in record.moments}
    with ExitStack() as stack:
        stack.enter_context(pictures.desk())
        reel = Reel(stack, probe, place, {*have, *missing})
        for number, shown in by_number.items():
            if shown is None or 0.0 not in shown:
                raise BakeError(f"probe '{probe.name}': a capture of its sequence is missing; bake it again")
            now = {roughness: pictures.read_file(place / level.file) for roughness, level in shown.items()}
            now |= {roughness: prefilter(now[0.0], roughness) for roughness in missing}
            reel.add(number, now)
        reel.store(record)
