"""Halves of the truth, and the folder that keeps them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.accuracy import files
from pcc_addon.core.accuracy.halves import Halves
from pcc_addon.core.accuracy.metrics import noise_of_halves
from pcc_addon.core.accuracy.results import ResultsFolder
from pcc_addon.core.errors import PccError

SHAPE = (24, 40, 3)
ALL = np.ones(SHAPE[:2], bool)


def noisy(seed: int, samples: int) -> Halves:
    """Light 2 with noise of 0.5 a sample."""
    random = np.random.default_rng(seed)
    first, second = 2.0 + 0.5 / np.sqrt(samples) * random.standard_normal((2, *SHAPE))
    return Halves(first, second, samples, 1.0)


def test_more_samples_count_as_many_as_they_are() -> None:
    ones, threes = (Halves(np.full(SHAPE, v), np.full(SHAPE, 2 * v), n, 1.5) for v, n in ((1.0, 1), (3.0, 3)))
    both = ones.deepened(threes)
    assert (both.samples, both.seconds) == (4, 3.0)
    np.testing.assert_allclose(both.first, 2.5)
    np.testing.assert_allclose(both.second, 5.0)
    np.testing.assert_allclose(both.mean, 3.75)


def test_the_noise_of_deepened_halves_is_that_of_all_their_samples() -> None:
    both = noisy(1, 4)
    for seed in range(2, 6):
        both = both.deepened(noisy(seed, 16))
    expected = 0.5 / np.sqrt(2 * 68) / 2.0
    assert noise_of_halves(both.first, both.second, ALL) == pytest.approx(expected, rel=0.05)
    assert np.std(both.mean) / 2.0 == pytest.approx(expected, rel=0.05)


def test_halves_come_back_in_a_run_of_the_same(tmp_path: Path) -> None:
    folder = ResultsFolder(tmp_path / "new" / "folder")
    folder.keep_halves(1, noisy(1, 4), "key")
    back = folder.halves(1, "key")
    np.testing.assert_array_equal(back.first, noisy(1, 4).first.astype(np.float32))
    assert (back.samples, back.seconds) == (4, 1.0)
    assert folder.halves(1, "other") is None
    assert folder.halves(0, "key") is None


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 torn", b"no archive"])
def test_damaged_halves_count_as_none(tmp_path: Path, damage: bytes) -> None:
    folder = ResultsFolder(tmp_path)
    (tmp_path / "truth_0.npz").write_bytes(damage)
    assert folder.halves(0, "key") is None


def test_clearing_leaves_what_is_not_ours(tmp_path: Path) -> None:
    folder = ResultsFolder(tmp_path)
    folder.keep_halves(0, noisy(1, 4), "key")
    folder.keep_shown("rung_001", np.zeros(SHAPE), 0.0)
    for name in ("cost.json", "notes.txt", "run_001.txt"):
        (tmp_path / name).write_text("x")
    folder.clear()
    assert sorted(os.listdir(tmp_path)) == ["notes.txt", "run_001.txt"]


def test_a_full_disk_leaves_what_was_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = ResultsFolder(tmp_path)
    folder.keep_array("truth", np.zeros(SHAPE))
    before = (tmp_path / "truth.npy").read_bytes()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(PccError, match="No space left on device"):
        folder.keep_array("truth", np.ones(SHAPE))
    assert (tmp_path / "truth.npy").read_bytes() == before
    assert os.listdir(tmp_path) == ["truth.npy"]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(PccError, match=r"cannot make the folder '.*file.*--out"):
        ResultsFolder(tmp_path / "file" / "below")
