"""Writes all vectors: python3 dev.py run tests/vectors/make.py"""

from __future__ import annotations

from tests.vectors import dominant, interior, levels, lookup, refracted, shares

FILES = (lookup.FILE, refracted.FILE, shares.FILE, levels.FILE, dominant.FILE, interior.FILE)

if __name__ == "__main__":
    for file in FILES:
        file.path.write_text(file.text(), encoding="utf-8")
        print(file.path)
