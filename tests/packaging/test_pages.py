"""The documents: links and pictures lead somewhere, and the zip's manual shows all of what is for artists."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import pytest

from . import manual
from .manual import ROOT

pytestmark = pytest.mark.without_blender
DOCUMENTS = sorted(
    [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]
)


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_and_pictures_lead_somewhere(page: Path) -> None:
    for link in manual.links(page):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert "://" in link or target.exists(), link
        if anchor and "://" not in link:
            assert anchor in manual.anchors(target), link


def test_every_page_is_reached_from_the_contents() -> None:
    known, new = {manual.CONTENTS}, [manual.CONTENTS]
    while new:
        page = new.pop()
        found = {(page.parent / link.partition("#")[0]).resolve() for link in manual.links(page) if "://" not in link}
        fresh = {target for target in found - known if target.suffix == ".md"}
        known, new = known | fresh, [*new, *fresh]
    assert set(DOCUMENTS) - known <= {ROOT / "CHANGELOG.md"}


def test_every_picture_of_a_screen_is_shown() -> None:
    shown = {Path(link).name for page in manual.pages() for link in manual.links(page)}
    kept = {picture.name for picture in (manual.ARTISTS / "images").iterdir()}
    assert kept <= shown | {Path(link).name for link in manual.links(ROOT / "README.md")}


class _Seen(HTMLParser):
    """What an HTML page refers to, and what on it can be referred to."""

    def __init__(self) -> None:
        super().__init__()
        self.references: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src"):
                self.references.append(value or "")
            elif name == "id":
                self.anchors.add(value or "")


def test_the_rendered_manual_needs_nothing_else(tmp_path: Path) -> None:
    files = manual.render(tmp_path / "manual")
    seen = {}
    for file in files:
        seen[file.name] = _Seen()
        seen[file.name].feed(file.read_text(encoding="utf-8"))
    assert [file.stem for file in files] == [page.stem for page in manual.pages()]
    for name, page in seen.items():
        for reference in page.references:
            path, _, anchor = reference.partition("#")
            assert (tmp_path / "manual" / (path or name)).is_file(), f"{name}: {reference}"
            assert not anchor or anchor in seen[path or name].anchors, f"{name}: {reference}"


def test_the_rendered_manual_is_small(tmp_path: Path) -> None:
    manual.render(tmp_path / "manual")
    assert sum(file.stat().st_size for file in (tmp_path / "manual").iterdir()) < 4_000_000, "bytes"
