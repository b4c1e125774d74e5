"""The hash of what a bake depends on, as records keep it: with the version of what it looks at."""

from __future__ import annotations

import re

VERSION = 2  # another one where hashes of what has not changed are others
_WRITTEN = re.compile(r"(\d{1,9}):.*")


def written(digits: str) -> str:
    """The hash of hexadecimal digits that this version found."""
    return f"{VERSION}:{digits}"


def version_of(content_hash: str) -> int:
    """The version that wrote a hash; the first one wrote digits alone."""
    found = _WRITTEN.fullmatch(content_hash)
    return int(found[1]) if found else 1
