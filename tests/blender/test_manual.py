"""Question marks and F1 open pages, and headings, that exist."""

from __future__ import annotations

import webbrowser
from fnmatch import fnmatchcase
from types import SimpleNamespace
from urllib.parse import unquote, urlparse

import bpy
import pytest
from bl_operators.wm import WM_OT_doc_view_manual

from pcc_addon.blender import properties
from pcc_addon.ui import manual
from pcc_addon.ui.manual import OPERATORS, PROPERTIES, Page, address
from tests.blender.drawn import Drawn, Layout, context_of, ours
from tests.packaging.manual import ARTISTS, anchors, pages


def types() -> list[str]:
    """Our properties as Blender asks for them."""
    return [
        f"bpy.types.{cls.__name__}.{prop.identifier}"
        for cls in properties.CLASSES
        for prop in cls.bl_rna.properties
        if prop.identifier not in ("rna_type", "name")
    ]


def operators() -> list[str]:
    return [f"bpy.ops.pcc.{name}" for name in dir(bpy.ops.pcc) if not name.startswith("_")]


def page_of(found: str) -> tuple[str, str]:
    """The name of a page and the anchor that an address leads to."""
    parts = urlparse(found)
    assert parts.scheme == "file"
    return unquote(parts.path).rsplit("/", 1)[1].partition(".")[0], parts.fragment


def exists(page: str, anchor: str) -> bool:
    source = ARTISTS / f"{page}.md"
    return source.is_file() and (not anchor or anchor in anchors(source))


def test_there_is_a_name_for_each_page(addon) -> None:
    assert [page.value for page in Page] == [page.stem for page in pages()]


def test_all_places_exist(addon) -> None:
    places = [*OPERATORS.values(), *PROPERTIES.values()]
    places += [panel.about for panel in ours(bpy.types.Panel) if hasattr(panel, "about")]
    assert not [place for place in places if not exists(place[0].value, place[1])]


def test_f1_finds_a_page_for_each_operator_and_property(addon) -> None:
    for name in (*operators(), *types()):
        found = WM_OT_doc_view_manual._lookup_rna_url(name, verbose=False)
        assert found is not None and exists(*page_of(found)), name


def test_f1_leaves_blenders_own_to_blender(addon) -> None:
    found = WM_OT_doc_view_manual._lookup_rna_url("bpy.ops.object.delete", verbose=False)
    assert found is None or "docs.blender.org" in found


def test_every_pattern_is_for_something(addon) -> None:
    asked = [name.lower() for name in (*operators(), *types())]
    patterns = [f"bpy.ops.pcc.{name}" for name in OPERATORS] + [f"bpy.types.{name}" for name in PROPERTIES]
    taken = {next(pattern for pattern in patterns if fnmatchcase(name, pattern)) for name in asked}
    assert set(patterns) - taken <= {"bpy.ops.pcc.*", "bpy.types.pcc_*"}, "the last ones, for what is new"


def test_panels_that_stand_by_themselves_have_a_question_mark(addon) -> None:
    alone = [panel for panel in ours(bpy.types.Panel) if not getattr(panel, "bl_parent_id", "")]
    assert len(alone) > 5
    for panel in alone:
        drawn = Drawn()
        header = SimpleNamespace(layout=Layout(drawn), about=getattr(panel, "about", None))
        if panel.__name__ != "PCC_PT_presets":  # a menu
            panel.draw_header_preset(header, context_of(300.0))
            assert "pcc.manual" in [name for name, _ in drawn.operators], panel.__name__


def test_the_button_opens_the_page(addon, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    assert bpy.ops.pcc.manual(page="TROUBLE", anchor="seam") == {"FINISHED"}
    assert [page_of(found) for found in opened] == [("trouble", "seam")]


def test_a_page_that_is_missing_is_told(addon, monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    monkeypatch.setattr(manual, "_BUILT", ())
    monkeypatch.setattr(manual, "_SOURCES", tmp_path)
    with pytest.raises(RuntimeError, match="'trouble' is not where the add-on is"):
        bpy.ops.pcc.manual(page="TROUBLE")
    assert manual._manual_map() == ("", ()), "Blender's own pages are found all the same"


def test_an_installed_page_comes_before_its_source(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    (tmp_path / "glass.html").write_text("")
    monkeypatch.setattr(manual, "_BUILT", (tmp_path,))
    assert address((Page.GLASS, "")) == (tmp_path / "glass.html").as_uri()
    assert page_of(address((Page.FILES, "x"))) == ("files", "x")
