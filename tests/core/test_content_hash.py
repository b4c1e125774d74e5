"""Hashes say which version of the add-on found them."""

from __future__ import annotations

import pytest

from pcc_addon.core.content_hash import VERSION, version_of, written


def test_a_hash_says_its_version() -> None:
    assert written("abc123") == f"{VERSION}:abc123" and version_of(written("abc123")) == VERSION


@pytest.mark.parametrize(
    ("content_hash", "version"), [("abc123", 1), ("", 1), ("12", 1), ("3:abc", 3), (":abc", 1), ("a:1", 1)]
)
def test_the_first_version_wrote_digits_alone(content_hash: str, version: int) -> None:
    assert version_of(content_hash) == version
