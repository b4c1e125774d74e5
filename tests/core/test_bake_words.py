"""A bake in words."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta, timezone

import numpy as np
import pytest

from pcc_addon.core.bake_words import kept_as, made_when, made_with, megabytes, not_captured
from pcc_addon.core.pictures import PictureKey, PictureKind
from pcc_addon.core.probe import Box, ProbeSpec, Source
from pcc_addon.core.sequence import Moment
from pcc_addon.core.sidecar import Level, Sidecar

SPEC = ProbeSpec("Hall", Box(tuple(np.eye(4).ravel().tolist())))
BAKE = replace(
    Sidecar.of_bake(SPEC, "5b0c", seconds=12.3, content_hash="", blender="", addon=""),
    date="2026-03-01T23:30:10+00:00",
    levels=tuple(Level(PictureKey(PictureKind.RADIANCE, k), k / 8, "a.exr", 64, 32, 2_100_000) for k in range(2)),
)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "Cycles, 512 px faces, 64 samples, denoised"),
        ({"denoise": False, "samples": 1}, "Cycles, 512 px faces, 1 sample"),
        ({"engine": "EEVEE", "half_float": True}, "EEVEE, 512 px faces, 64 samples, half float"),
        ({"source": Source.WORLD, "denoise": False}, "the world by Cycles, 512 px faces, 64 samples"),
        ({"source": Source.IMAGE}, "an image, 512 px faces"),
    ],
)
def test_what_it_was_baked_with(changes, words: str) -> None:
    assert made_with(replace(BAKE, **changes)) == words


def test_when_it_was_baked_is_told_in_local_time() -> None:
    east = timezone(timedelta(hours=2))
    assert made_when(BAKE, east) == "2026-03-02 01:30, in 12 s"
    assert made_when(replace(BAKE, date=""), east) == "in 12 s", "an older bake"


def test_how_much_is_kept() -> None:
    assert kept_as(BAKE) == "2 pictures, 4.2 MB"
    moments = tuple(Moment(frame, "", 0, (0.0, 0.0, 0.0)) for frame in (1, 2, 3))
    assert kept_as(replace(BAKE, moments=moments)) == "2 pictures for frames 1-3, 4.2 MB"
    assert kept_as(replace(BAKE, levels=(replace(BAKE.levels[0], size=0),))) == "1 picture", "of version 1"


def test_faces_that_were_left_out_are_named() -> None:
    assert not_captured(BAKE) == ""
    assert not_captured(replace(BAKE, faces=("+X", "-X", "+Y", "-Y"))).endswith(": +Z and -Z")


@pytest.mark.parametrize(
    ("size", "words"),
    [(4_000, "0.004 MB"), (310_000, "0.31 MB"), (999_000, "1.0 MB"), (4_200_000, "4.2 MB"), (9_990_000, "10 MB"),
     (999_400_000, "999 MB"), (999_600_000, "1.0 GB"), (25_000_000_000, "25 GB")],
)  # fmt: skip
def test_sizes_have_two_or_three_digits(size: int, words: str) -> None:
    assert megabytes(size) == words
