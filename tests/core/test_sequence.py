"""Which frames of an animated probe share a picture, and which pictures are missing."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.sequence import changed_frames, changes, plan_sequence

HERE, THERE = (0.0, 0.0, 0.0), (1.0, 2.0, 3.0)


def plan(hashes: str, known: str = ""):
    """The sequence of frames 10, 11, … at which the probe sees these letters, each from a point of its own."""
    frames = range(10, 10 + len(hashes))
    points = [(float(ord(letter)), 0.0, 0.0) for letter in hashes]
    return plan_sequence(frames, list(hashes), points, set(known))


def test_frames_at_which_nothing_changes_share_a_picture() -> None:
    found = plan("aabbb")
    assert [moment.number for moment in found.moments] == [0, 0, 1, 1, 1]
    assert found.frames == (10, 12) and found.hashes == ("a", "b") and found.missing == (0, 1)


def test_what_was_seen_before_is_shown_again() -> None:
    """A lamp that blinks has two pictures, however long it does."""
    found = plan("abababab")
    assert [moment.number for moment in found.moments] == [0, 1] * 4
    assert found.missing == (0, 1)


def test_pictures_that_are_there_are_not_missing() -> None:
    assert plan("abcb", known="bx").missing == (0, 2)
    assert plan("aab", known="ab").missing == ()


@given(st.text(alphabet="abcde", min_size=1, max_size=40), st.text(alphabet="abcdef"))
def test_each_frame_shows_a_picture_of_what_is_seen_then(hashes: str, known: str) -> None:
    found = plan(hashes, known)
    assert [moment.frame for moment in found.moments] == list(range(10, 10 + len(hashes)))
    for moment, letter in zip(found.moments, hashes, strict=True):
        assert found.hashes[moment.number] == moment.content_hash == letter
        assert moment.capture_point == (float(ord(letter)), 0.0, 0.0)
        assert hashes[found.frames[moment.number] - 10] == letter
    assert len(set(found.hashes)) == len(found.hashes) == len(set(hashes))
    assert {found.hashes[number] for number in found.missing} == set(hashes) - set(known)


@pytest.mark.parametrize("hashes", ["a", "aaa"])
def test_frames_without_a_hash_are_no_sequence(hashes: str) -> None:
    with pytest.raises(ValueError):
        plan_sequence((1, 2), list(hashes), (HERE, HERE))
    with pytest.raises(ValueError):
        changed_frames(plan("ab").moments, list(hashes))


@given(st.text(alphabet="abc", min_size=1, max_size=40))
def test_changes_say_at_each_frame_what_moments_say(hashes: str) -> None:
    moments = plan(hashes).moments
    steps = changes(moments)
    for moment in moments:
        last = [change for change in steps if change.frame <= moment.frame][-1]
        assert (last.number, last.capture_point) == (moment.number, moment.capture_point)
    assert all(a.number != b.number for a, b in itertools.pairwise(steps))


def test_changed_frames_are_named() -> None:
    moments = plan("aabb").moments
    assert changed_frames(moments, list("aabb")) == ()
    assert changed_frames(moments, list("axbc")) == (11, 13)
