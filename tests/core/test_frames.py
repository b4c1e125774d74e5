"""Frames that are asked for, and how several are said."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.errors import PccError
from pcc_addon.core.frames import STILL, FrameRange, parse_frames, spans


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        ("1-4", [1, 2, 3, 4]),
        ("7-7", [7]),
        ("0-10:5", [0, 5, 10]),
        ("1-10:4", [1, 5, 9]),
        ("-3--1", [-3, -2, -1]),
        (" 2-3 ", [2, 3]),
    ],
)
def test_a_range_names_its_frames(text: str, frames: list[int]) -> None:
    assert list(FrameRange.parse(text).frames) == frames


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("12", "such as 1-250"),
        ("a-b", "such as 1-250"),
        ("1-2:", "such as 1-250"),
        ("1-2:-1", "such as 1-250"),
        ("1.5-3", "such as 1-250"),
        ("1..5", "such as 1-250"),
        ("5-1", "ask for 1-5"),
        ("1-9:0", "take at least 1"),
        ("1-2000000", "stay within"),
        ("-2000000-1", "stay within"),
    ],
)
def test_what_is_no_range_is_named_with_what_to_write(text: str, remedy: str) -> None:
    with pytest.raises(PccError) as caught:
        FrameRange.parse(text)
    assert text in str(caught.value) and remedy in str(caught.value)


@given(st.integers(-1000, 1000), st.integers(0, 500), st.integers(1, 9))
def test_a_range_and_its_text_are_inverses(first: int, length: int, step: int) -> None:
    asked = FrameRange(first, first + length, step)
    assert FrameRange.parse(asked.text) == asked


def test_what_is_not_asked_for_is_as_last_baked() -> None:
    assert parse_frames(None) is None and parse_frames(" ") is None
    assert parse_frames(" Still ") == STILL
    assert parse_frames("1-2") == FrameRange(1, 2)


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ([], ""),
        ([5], "5"),
        ([1, 2, 3, 7, 12, 13], "1-3, 7, 12-13"),
        ([1, 3, 5, 7, 8], "1-7:2, 8"),
        ([2, 9], "2, 9"),
        ([2, 3, 9], "2-3, 9"),
    ],
)
def test_frames_are_said_briefly(frames: list[int], words: str) -> None:
    assert spans(frames) == words


@given(st.sets(st.integers(-50, 200)))
def test_what_is_said_names_all_frames_and_no_other(frames: set[int]) -> None:
    said = [part for part in spans(sorted(frames)).split(", ") if part]
    ranges = [FrameRange.parse(part).frames if "-" in part[1:] else [int(part)] for part in said]
    assert [frame for each in ranges for frame in each] == sorted(frames)
