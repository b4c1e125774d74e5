"""The folder of a run of `pcc cost`: beside cost.json the pictures that its measurements are made of."""

from __future__ import annotations

import io
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from ..errors import PccError
from .files import CSV_NAME, JSON_NAME, write_aside
from .halves import Halves
from .png import png_of


class ResultsFolder:
    """Arrays in a folder, each written aside and moved into place: who is killed leaves what there was."""

    def __init__(self, path: Path) -> None:
        """Make it where it is missing.

        Raises:
            PccError: it cannot be made.
        """
        self.path = path
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise PccError(f"cannot make the folder '{path}' ({error.strerror}); choose another with --out") from error

    def keep_array(self, name: str, array: np.ndarray) -> None:
        """Keep an array as `NAME.npy`.

        Raises:
            PccError: it cannot be written.
        """
        packed = io.BytesIO()
        np.save(packed, array)
        write_aside(self.path / f"{name}.npy", packed.getvalue())

    def keep_shown(self, name: str, picture: np.ndarray, exposure: float) -> str:
        """Keep a picture (h, w, 3), linear, row 0 at the bottom, as `NAME.png`; returns that file name.

        Args:
            name: of the file.
            picture: it.
            exposure: stops by which it is brightened.

        Raises:
            PccError: it cannot be written.
        """
        return self.keep_png(name, png_of(picture[::-1], exposure))

    def keep_png(self, name: str, png: bytes) -> str:
        """Keep the bytes of a picture as `NAME.png`; returns that file name. Raises as `keep_array` does."""
        write_aside(self.path / f"{name}.png", png)
        return f"{name}.png"

    def keep_halves(self, number: int, halves: Halves, key: str) -> None:
        """Keep the truth of a frame, counted from 0, in a run with this key. Raises as `keep_array` does."""
        packed = io.BytesIO()
        first, second = halves.first.astype(np.float32), halves.second.astype(np.float32)
        np.savez(packed, first=first, second=second, samples=halves.samples, seconds=halves.seconds, key=key)
        write_aside(self.path / f"truth_{number}.npz", packed.getvalue())

    def halves(self, number: int, key: str) -> Halves | None:
        """The truth of a frame, as far as it was kept in a run with this key."""
        try:
            with np.load(self.path / f"truth_{number}.npz", allow_pickle=False) as kept:
                if str(kept["key"]) != key:
                    return None
                first, second = kept["first"].astype(np.float64), kept["second"].astype(np.float64)
                return Halves(first, second, int(kept["samples"]), float(kept["seconds"]))
        except (OSError, ValueError, KeyError, EOFError, BadZipFile):
            return None

    def clear(self) -> None:
        """Remove what another run left here; nothing else in the folder is touched.

        Raises:
            PccError: something cannot be removed.
        """
        try:
            for pattern in (JSON_NAME, CSV_NAME, "truth*.np[yz]", "served_*.npy", "rung_*.*", "truth.png", "heat.png"):
                for path in self.path.glob(pattern):
                    path.unlink(missing_ok=True)
        except OSError as error:
            raise PccError(f"cannot remove old results in '{self.path}' ({error.strerror}); choose --out") from error
