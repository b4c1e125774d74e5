"""Copy the tables of docs/emissive_room.md and docs/shading_cost.md into the README, between its markers.

python3 dev.py run benchmarks/readme_figures.py
"""

from __future__ import annotations

from benchmarks.measure import ROOT, write_between

PAGES = ("emissive_room.md", "shading_cost.md")


def main() -> None:
    tables = [_table((ROOT / "docs" / page).read_text(encoding="utf-8")) for page in PAGES]
    write_between(ROOT / "README.md", "figures: written by benchmarks/readme_figures.py", "\n\n".join(tables))


def _table(page: str) -> str:
    return "\n".join(line for line in page.splitlines() if line.startswith("|"))


if __name__ == "__main__":
    main()
