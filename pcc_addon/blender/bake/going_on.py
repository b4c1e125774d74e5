"""How a bake goes on where another one was stopped, or does its share of one that several processes do."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.errors import BakeError
from ...core.kept_faces import KeptFaces, KeptProbe
from ...core.probe import ProbeSpec
from ...core.shares import Share, dealt
from ...core.sidecar import Sidecar, file_stem, read_file, sidecar_file
from ...version import ADDON_VERSION
from ..probes import ensure_uid, lasting_uid
from ..read.holders import Holders
from ..store import pictures
from ..store.keeping import show_files


@dataclass(frozen=True)
class Going:
    """What a bake takes over, and what it leaves to others.

    Attributes:
        resumes: whether bakes that lie whole in the folder, and kept faces, are taken where nothing has changed.
        share: of a bake that others do as well; None: all of it.
    """

    resumes: bool = False
    share: Share | None = None


class GoingOn:
    """The pictures and faces in a folder that a bake may go on from; what it makes waits for the disk."""

    def __init__(self, going: Going, folder: Path) -> None:
        self.resumes, self.share = going.resumes, going.share
        self._folder, self._faces = folder, KeptFaces(folder, resumes=going.resumes)

    def faces_of(self, probe: bpy.types.Object, holders: Holders, content_hash: str) -> KeptProbe:
        """The kept faces of a probe that sees what has this hash."""
        return self._faces.of(
            file_stem(probe.name, lasting_uid(probe, holders, self._folder)),
            content_hash,
            bpy.app.version_string,
            ADDON_VERSION,
        )

    def forget(self, probes: Iterable[bpy.types.Object]) -> None:
        """The bakes of some probes are whole: their faces are needed no more."""
        self._faces.forget(file_stem(probe.name, probe.pcc_probe.uid) for probe in probes)

    def dealt(self, costs: Sequence[float], pieces: Sequence[int]) -> list[range]:
        """Which pieces of work are to be done here, as `shares.dealt`."""
        return [range(n) for n in pieces] if self.share is None else dealt(costs, pieces, self.share)

    def recovered(
        self, probe: bpy.types.Object, spec: ProbeSpec, holders: Holders, content_hash: str, faces: Sequence[str]
    ) -> Sidecar | None:
        """Let a probe have the still that lies whole in the folder, if it shows what is to be baked; its record then.

        Args:
            probe, spec: of which the bake is.
            holders: who shows which pictures.
            content_hash: of what it sees now.
            faces: those that it needs.
        """
        record = self._lying(probe, holders)
        if record is None or record.moments or not record.is_of(spec, content_hash, faces):
            return None
        return self._taken(probe, record, holders)

    def recover_sequence(self, probe: bpy.types.Object, holders: Holders) -> None:
        """Let a probe have the sequence that lies in the folder; its pictures stay as far as nothing has changed."""
        record = self._lying(probe, holders)
        if record is not None and record.moments and record.to_json() != probe.pcc_probe.bake_record:
            self._taken(probe, record, holders)

    def _lying(self, probe: bpy.types.Object, holders: Holders) -> Sidecar | None:
        """The record of a bake that lies whole in the folder, by this Blender and add-on."""
        if not self.resumes:
            return None
        path = self._folder / sidecar_file(probe.name, lasting_uid(probe, holders, self._folder))
        with contextlib.suppress(OSError, UnicodeDecodeError, BakeError):
            record = Sidecar.from_json(read_file(path), path.name)
            by_us = (record.blender, record.addon) == (bpy.app.version_string, ADDON_VERSION)
            ours = by_us and record.uid == lasting_uid(probe, holders, self._folder)
            if ours and record.levels and all(self._is_there(level.file, level.size) for level in record.levels):
                return record
        return None

    def _is_there(self, name: str, size: int) -> bool:
        path = self._folder / name
        return Path(name).name == name and path.is_file() and path.stat().st_size == size > 0

    def _taken(self, probe: bpy.types.Object, record: Sidecar, holders: Holders) -> Sidecar:
        ensure_uid(probe, holders, self._folder)
        with pictures.desk():
            show_files(probe, record, self._folder, holders)
        return record
