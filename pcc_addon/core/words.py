"""Lists in words."""

from __future__ import annotations

from collections.abc import Sequence


def listed(words: Sequence[str]) -> str:
    """Such as "a, b and c"."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def named(names: Sequence[str]) -> str:
    """`listed`, each in quotation marks."""
    return listed([f"'{name}'" for name in names])
