"""Renders the pages for artists as HTML, for the extension's zip: `python3 dev.py build` does.

`python -m tests.packaging.manual FOLDER` writes them into a folder. They need no network: style and pictures lie beside
them. Links to pages that are not for artists become their words, since the zip does without these.
"""

from __future__ import annotations

import html
import os
import posixpath
import re
import shutil
import sys
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.anchors import anchors_plugin

ROOT = Path(__file__).resolve().parents[2]
ARTISTS = ROOT / "docs" / "artists"
CONTENTS = ROOT / "docs" / "README.md"

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title} – Parallax Probes</title>
<link rel="stylesheet" href="style.css">
</head>
<body>
<nav aria-label="Pages"><p>Parallax Probes</p><ul>
{links}
</ul></nav>
<main>
{body}</main>
</body>
</html>
"""

_STYLE = """:root {
  --page: #fff; --side: #f3f4f5; --text: #1d2125; --quiet: #5b636b; --line: #d8dcdf; --link: #0b62b0; --code: #eef0f2;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #1e2022; --side: #17191a; --text: #e3e5e7; --quiet: #a2a9af; --line: #3b4044; --link: #7db8ef;
    --code: #2b2f32;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0; display: flex; min-height: 100vh; background: var(--page); color: var(--text);
  font: 16px/1.55 system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", sans-serif;
}
nav { flex: 0 0 15rem; padding: 1.5rem 1.25rem; background: var(--side); border-right: 1px solid var(--line); }
nav p { margin: 0 0 .75rem; font-weight: 600; }
nav ul { margin: 0; padding: 0; list-style: none; }
nav li { margin: .3rem 0; }
nav [aria-current] { color: var(--text); font-weight: 600; text-decoration: none; }
main { flex: 1 1 auto; min-width: 0; max-width: 56rem; padding: 1.5rem 2.5rem 4rem; }
h1 { margin-top: 0; line-height: 1.2; }
h2 { margin-top: 2.2rem; padding-top: .6rem; border-top: 1px solid var(--line); }
a { color: var(--link); }
img { max-width: 100%; height: auto; }
code { padding: .1em .3em; border-radius: 3px; background: var(--code); font-size: .9em; overflow-wrap: anywhere; }
pre { padding: .8rem 1rem; overflow-x: auto; border-radius: 4px; background: var(--code); }
pre code { padding: 0; overflow-wrap: normal; }
table { display: block; overflow-x: auto; border-collapse: collapse; }
th, td { padding: .4rem .7rem; border: 1px solid var(--line); text-align: left; vertical-align: top; }
.elsewhere { color: var(--quiet); }
@media (max-width: 50rem) {
  body { display: block; }
  nav { border-right: 0; border-bottom: 1px solid var(--line); }
  nav li { display: inline-block; margin-right: .8rem; }
  main { padding: 1.25rem; }
}
"""


def pages() -> list[Path]:
    """The pages for artists, in the order of the contents page.

    Raises:
        ValueError: a page is missing in the contents, which nobody would find.
    """
    named = re.findall(r"\]\(artists/([a-z_]+\.md)", CONTENTS.read_text(encoding="utf-8"))
    order = [ARTISTS / name for name in dict.fromkeys(named)]
    missing = sorted({page.name for page in ARTISTS.glob("*.md")} - {page.name for page in order})
    if missing:
        raise ValueError(f"docs/README.md names no {', '.join(missing)}: link each page for artists there")
    return order


def parser() -> MarkdownIt:
    """The Markdown of all docs: tables, and anchors of headings as GitHub calls them."""
    return MarkdownIt("commonmark").enable("table").use(anchors_plugin, max_level=4)


def anchors(page: Path) -> set[str]:
    """The anchors of a page: those of its headings, and those that are written as HTML."""
    text = page.read_text(encoding="utf-8")
    headings = (token for token in parser().parse(text) if token.type == "heading_open")
    return {str(token.attrs["id"]) for token in headings} | set(re.findall(r'<a id="([^"]+)"', text))


def links(page: Path) -> list[str]:
    """Where a page's links and pictures lead, as they are written."""
    tokens = [child for token in parser().parse(page.read_text(encoding="utf-8")) for child in token.children or ()]
    return [str(token.attrs[name]) for token in tokens for name in ("href", "src") if name in token.attrs]


def title(page: Path) -> str:
    """The text of a page's first heading."""
    return page.read_text(encoding="utf-8").split("\n", 1)[0].removeprefix("# ")


def render(folder: Path) -> list[Path]:
    """Write all pages with their pictures into a folder, which is emptied before; returns the pages' files."""
    beside = folder.with_name(f"{folder.name}.new")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    (beside / "style.css").write_text(_STYLE, encoding="utf-8")
    order = pages()
    for page in order:
        text = _PAGE.format(title=html.escape(title(page)), links=_contents(order, page), body=_body(page, beside))
        (beside / f"{page.stem}.html").write_text(text, encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(beside, folder)
    return [folder / f"{page.stem}.html" for page in order]


def _contents(order: list[Path], current: Path) -> str:
    return "\n".join(
        f'<li><a href="{page.stem}.html"{" aria-current=page" if page == current else ""}>'
        f"{html.escape(title(page))}</a></li>"
        for page in order
    )


def _body(page: Path, folder: Path) -> str:
    """A page's text as HTML; its pictures are copied into the folder."""
    markdown = parser()
    tokens = markdown.parse(page.read_text(encoding="utf-8"))
    for token in tokens:
        if token.children:
            token.children = [_turned(child, page, folder) for child in token.children]
            _name_elsewhere(token.children)
    return markdown.renderer.render(tokens, markdown.options, {})


def _turned(token: Token, page: Path, folder: Path) -> Token:
    """A picture or link of a page, as it is in the folder."""
    if token.type == "image":
        source = (page.parent / str(token.attrs["src"])).resolve()
        name = source.relative_to(ROOT / "docs").as_posix().replace("/", "-")
        shutil.copyfile(source, folder / name)
        token.attrs["src"] = name
        token.attrs["loading"] = "lazy"
    elif token.type == "link_open":
        path, _, anchor = str(token.attrs["href"]).partition("#")
        if path.endswith(".md") and "/" not in path:
            token.attrs["href"] = f"{path[:-3]}.html" + (f"#{anchor}" if anchor else "")
    return token


def _name_elsewhere(tokens: list[Token]) -> None:
    """Links that lead out of the pages for artists become their words, with the file's name as a tip."""
    ends = None
    for token in tokens:
        if token.type == "link_open" and str(token.attrs["href"]).startswith(".."):
            place = posixpath.normpath(posixpath.join("docs/artists", str(token.attrs["href"]).partition("#")[0]))
            token.tag, token.attrs = "span", {"class": "elsewhere", "title": f"{place} of the add-on's sources"}
            ends = token.level
        elif token.type == "link_close" and ends is not None:
            token.tag, ends = "span", None


if __name__ == "__main__":
    print(*render(Path(sys.argv[1])), sep="\n")
