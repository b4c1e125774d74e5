"""Where the pages for artists are: buttons in panels lead there, and Blender's own *Online Manual* (F1)."""

from __future__ import annotations

from enum import Enum
from pathlib import Path

import bpy

_ADDON = Path(__file__).resolve().parents[1]
_BUILT = (_ADDON / "manual", _ADDON.parent / "build" / "manual")  # of an installed zip; what `dev.py build` left
_SOURCES = _ADDON.parent / "docs" / "artists"


class Page(str, Enum):
    """A page for artists: the name of its file."""

    FIRST_PROBE = "first_probe"
    PLACING = "placing"
    ROOMS = "rooms"
    SEVERAL = "several"
    BAKING = "baking"
    MATERIALS = "materials"
    WINDOWS = "windows"
    GLASS = "glass"
    ANIMATION = "animation"
    CUBEMAPS = "cubemaps"
    ENGINES = "engines"
    ACCURACY = "accuracy"
    BATCH = "batch"
    FILES = "files"
    BY_HAND = "by_hand"
    PANELS = "panels"
    TROUBLE = "trouble"


Place = tuple[Page, str]
"""A page and the anchor of a heading on it; "" is the page's top."""

OPERATORS: dict[str, Place] = {
    "probe_add": (Page.PLACING, "adding"),
    "drag_*": (Page.PLACING, "handles"),
    "fit": (Page.PLACING, "fit-to-room"),
    "judge": (Page.PLACING, "judging"),
    "misfit": (Page.ROOMS, "where-it-will-be-wrong"),
    "bake_frames": (Page.ANIMATION, ""),
    "bake*": (Page.BAKING, ""),
    "status": (Page.BAKING, "fresh-or-stale"),
    "state": (Page.BAKING, "fresh-or-stale"),
    "lock": (Page.BAKING, "which-probes"),
    "select": (Page.BAKING, "which-probes"),
    "copy_settings": (Page.SEVERAL, "the-same-settings-for-many"),
    "preset*": (Page.PANELS, "parallax-probe"),
    "hidden_*": (Page.PANELS, "hidden-from-capture"),
    "inject": (Page.MATERIALS, ""),
    "remove": (Page.MATERIALS, "back-to-what-they-were"),
    "plan": (Page.MATERIALS, "what-is-left-alone"),
    "interior_*": (Page.WINDOWS, ""),
    "picture_choose": (Page.CUBEMAPS, ""),
    "cost*": (Page.ACCURACY, ""),
    "node_add": (Page.BY_HAND, ""),
    "mirrored_view_add": (Page.BY_HAND, ""),
    "*": (Page.FIRST_PROBE, ""),
}
"""Patterns of our operators' names, the first that fits first."""

PROPERTIES: dict[str, Place] = {
    "pcc_probe.source": (Page.CUBEMAPS, ""),
    "pcc_probe.picture": (Page.CUBEMAPS, ""),
    "pcc_probe.follow": (Page.ANIMATION, "a-thing-that-moves"),
    "pcc_probe.size": (Page.PANELS, "box"),
    "pcc_probe.padding": (Page.PANELS, "box"),
    "pcc_probe.correction": (Page.ROOMS, "furniture-relief"),
    "pcc_probe.relief_*": (Page.ROOMS, "furniture-relief"),
    "pcc_probe.contact_hardening": (Page.PANELS, "box"),
    "pcc_probe.locked": (Page.BAKING, "which-probes"),
    "pcc_probe.hidden_*": (Page.PANELS, "hidden-from-capture"),
    "pcc_probe.weight": (Page.PANELS, "influence"),
    "pcc_probe.priority": (Page.PANELS, "influence"),
    "pcc_probe.outside": (Page.PANELS, "influence"),
    "pcc_probe.falloff*": (Page.PANELS, "influence"),
    "pcc_probe.normal_fade": (Page.PANELS, "influence"),
    "pcc_probe.influence_*": (Page.PANELS, "influence"),
    "pcc_probe.receivers": (Page.PANELS, "influence"),
    "pcc_probe.excluded": (Page.PANELS, "influence"),
    "pcc_probe.*": (Page.PANELS, "capture"),
    "pcc_probeeffects.*": (Page.MATERIALS, "effects"),
    "pcc_materialeffects.*": (Page.MATERIALS, "effects"),
    "pcc_material.*": (Page.MATERIALS, "choosing"),
    "pcc_object.*": (Page.MATERIALS, "choosing"),
    "pcc_scene.*": (Page.PANELS, "scene"),
    "pcc_hiddenobject.*": (Page.PANELS, "hidden-from-capture"),
    "pcc_*": (Page.PANELS, ""),
}
"""Patterns of our types and properties, in the small letters that Blender asks with."""


def address(place: Place) -> str:
    """A page as an address for a browser: what an installed zip or the last build has, else the page's source.

    Raises:
        FileNotFoundError: there is no such page.
    """
    page, anchor = place
    files = (*(folder / f"{page.value}.html" for folder in _BUILT), _SOURCES / f"{page.value}.md")
    for file in files:
        if file.is_file():
            return file.as_uri() + (f"#{anchor}" if anchor else "")
    raise FileNotFoundError(f"the manual's page '{page.value}' is not where the add-on is ({_ADDON}): install it again")


def draw_button(layout: bpy.types.UILayout, place: Place) -> None:
    """A question mark, for the header of a panel."""
    page, anchor = place
    button = layout.operator("pcc.manual", text="", icon="HELP", emboss=False)
    button.page, button.anchor = page.name, anchor


class Helped:
    """A base of panels beside `bpy.types.Panel`: a question mark in the header leads to `about`."""

    about: Place

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_button(self.layout, self.about)


def _manual_map() -> tuple[str, tuple[tuple[str, str], ...]]:
    found = [(f"bpy.ops.pcc.{name}", place) for name, place in OPERATORS.items()]
    found += [(f"bpy.types.{name}", place) for name, place in PROPERTIES.items()]
    try:
        return "", tuple((pattern, address(place)) for pattern, place in found)
    except FileNotFoundError:  # Blender then says that there is no page, and finds its own
        return "", ()


def register() -> None:
    bpy.utils.register_manual_map(_manual_map)


def unregister() -> None:
    bpy.utils.unregister_manual_map(_manual_map)
