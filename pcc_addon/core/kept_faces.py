"""Faces of bakes under way, kept beside the pictures: whoever goes on with a bake that was killed takes them.

A face is found again by all that it depends on, so that no old one is taken for a new one. Files are whole or not
there; one that a power cut tore fails its checksum and counts as not there.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import time
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .workplace import aside

FOLDER = ".faces"
_SYNCED = 0.25  # seconds of work that a power cut may take; to wait for the disk more often would slow small faces


@dataclass(frozen=True)
class KeptFace:
    """A face: (n + 2·OVERSCAN, same, 3) float32, what was wrong with it in words, and the seconds that it took."""

    picture: np.ndarray
    words: tuple[str, ...] = ()
    seconds: float = 0.0


class KeptFaces:
    """The faces that are kept in a folder of pictures."""

    def __init__(self, folder: Path, *, resumes: bool) -> None:
        """Nothing is written before the first face is kept.

        Args:
            folder: of the pictures.
            resumes: whether faces that are there already are taken.
        """
        self._folder, self._resumes = folder / FOLDER, resumes
        self._part: Path | None = None
        self._synced = time.monotonic()

    def of(self, stem: str, *seen: str) -> KeptProbe:
        """Those of a probe; its files' `stem`, and all that its faces depend on."""
        return KeptProbe(self, f"{stem}.{_digest(seen)}")

    def take(self, name: str) -> KeptFace | None:
        """A face that was kept under a name; None where it has to be rendered."""
        if not self._resumes:
            return None
        path = self._folder / f"{name}.npz"
        try:
            with np.load(path, allow_pickle=False) as held:
                picture, words, seconds = held["picture"], held["words"], held["seconds"]
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        if picture.ndim != 3 or picture.dtype != np.float32 or not np.isfinite(picture).all():
            return None
        return KeptFace(picture, tuple(str(each) for each in words.tolist()), float(seconds))

    def has(self, name: str) -> bool:
        """Whether a face may be there under a name; only `take` tells for sure."""
        return self._resumes and (self._folder / f"{name}.npz").is_file()

    def keep(self, name: str, face: KeptFace) -> None:
        """Keep a face; where that is not possible, as on a full disk, it is rendered again after a kill."""
        with contextlib.suppress(OSError):
            if self._folder.is_symlink():  # it may have come with a stranger's file
                return
            if self._part is None:
                self._folder.mkdir(parents=True, exist_ok=True)
                self._part = aside(self._folder / "face.npz")
            try:
                with self._part.open("wb") as file:
                    words = np.array(face.words, np.str_)
                    np.savez(file, picture=face.picture, words=words, seconds=np.float64(face.seconds))
                    file.flush()
                    if time.monotonic() - self._synced > _SYNCED:
                        os.fsync(file.fileno())
                        self._synced = time.monotonic()
                os.replace(self._part, self._folder / f"{name}.npz")
            finally:
                self._part.unlink(missing_ok=True)

    def forget(self, stems: Iterable[str]) -> None:
        """Remove all faces of probes whose bakes are whole, whatever they saw; and the folder with the last."""
        with contextlib.suppress(OSError):
            clear(self._folder.parent, stems)


def clear(folder: Path, stems: Iterable[str] | None = None) -> None:
    """Remove what is kept in a folder of pictures: of some probes, by their files' stems, or all.

    Raises:
        OSError: something cannot be removed.
    """
    faces, wanted = folder / FOLDER, None if stems is None else set(stems)
    if faces.is_symlink():  # it may have come with a stranger's file
        return
    for path in faces.glob("*.npz"):
        if wanted is None or path.name.partition(".")[0] in wanted:
            path.unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        faces.rmdir()


@dataclass(frozen=True)
class KeptProbe:
    """The kept faces of one probe in one state of the scene; without `faces` none is kept."""

    faces: KeptFaces | None = None
    name: str = ""

    def take(self, face: str) -> KeptFace | None:
        """One of them, or None where it has to be rendered."""
        return self.faces.take(f"{self.name}.{face}") if self.faces else None

    def has(self, face: str) -> bool:
        """Whether one of them may be there."""
        return self.faces is not None and self.faces.has(f"{self.name}.{face}")

    def keep(self, face: str, kept: KeptFace) -> None:
        if self.faces:
            self.faces.keep(f"{self.name}.{face}", kept)


NOWHERE = KeptProbe()


def _digest(words: Iterable[str]) -> str:
    return hashlib.blake2b("\n".join(words).encode(), digest_size=8).hexdigest()
