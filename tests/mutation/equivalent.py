"""Changes that no test can notice, because they change nothing that anybody could see."""

from __future__ import annotations

EQUIVALENT: dict[tuple[str, str, str, str], str] = {}
"""Why, by module, source line without its indentation, what was replaced, and by what."""
