"""Sentences in panels are broken where a region ends, and nothing of them is lost."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.ui.sentences import fold, width


@pytest.mark.parametrize(
    ("text", "room", "lines"),
    [
        ("", 5, [""]),
        ("one", 5, ["one"]),
        ("one two three", 7, ["one two", "three"]),
        ("one two three", 100, ["one two three"]),
        ("a-very-long-name is broken", 6, ["a-very", "-long-", "name", "is", "broken"]),
        ("is a-very-long-name", 6, ["is", "a-very", "-long-", "name"]),
        ("narrow", 0, list("narrow")),
    ],
)
def test_lines_fit_and_keep_all_words(text: str, room: float, lines: list[str]) -> None:
    assert fold(text, room, len) == lines


def test_lines_fit_as_they_are_drawn() -> None:
    text = "surfaces of 'Floor polished' lie on its box and may be seen from outside"
    lines = fold(text, 170.0, lambda piece: width(bpy.context, piece))
    assert " ".join(lines) == text and 2 < len(lines) < 5
    assert all(0.0 < width(bpy.context, line) <= 170.0 for line in lines)
