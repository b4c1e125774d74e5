"""Copy the tables of docs/emissive_room.md and docs/shading_cost.md into the README, between its markers.

python3 dev.py run benchmarks/readme_figures.py
"""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- figures: written by benchmarks/readme_figures.py -->\n", "<!-- end of figures -->"
PAGES = ("emissive_room.md", "shading_cost.md")


def main() -> None:
    readme = ROOT / "README.md"
    before, _, rest = readme.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    tables = [_table((ROOT / "docs" / page).read_text(encoding="utf-8")) for page in PAGES]
    readme.write_text(f"{before}{BEGIN}\n" + "\n\n".join(tables) + f"\n\n{END}{after}", encoding="utf-8")


def _table(page: str) -> str:
    return "\n".join(line for line in page.splitlines() if line.startswith("|"))


if __name__ == "__main__":
    main()
