"""Panels drawn without a window, into a layout that writes down what it is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from types import FunctionType, MethodType, SimpleNamespace
from typing import Any

import bpy

UNIT = 20.0


@dataclass
class Drawn:
    """What a panel asked for.

    Attributes:
        labels: their texts.
        properties: (data, name) of each that can be edited.
        operators: their identifiers, with what was set of each.
        texts: of their buttons, where these have one of their own.
        icons: values of pictures.
    """

    labels: list[str] = field(default_factory=list)
    properties: list[tuple[Any, str]] = field(default_factory=list)
    operators: list[tuple[str, SimpleNamespace]] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    icons: list[int] = field(default_factory=list)

    @property
    def text(self) -> str:
        return " ".join(self.labels)


class Layout:
    """Takes the place of `bpy.types.UILayout`; refuses what Blender would."""

    def __init__(self, drawn: Drawn) -> None:
        self._drawn = drawn

    def _part(self, **_: object) -> Layout:
        return Layout(self._drawn)

    row = column = split = box = grid_flow = _part

    def separator(self, **_: object) -> None:
        pass

    def label(self, text: str = "", icon: str = "NONE", **_: object) -> None:
        _check_icon(icon)
        self._drawn.labels.append(text)

    def prop(self, data: Any, name: str, icon: str = "NONE", **_: object) -> None:
        _check_icon(icon)
        assert name in data.bl_rna.properties, f"{data} has no '{name}'"
        self._drawn.properties.append((data, name))

    def operator(self, name: str, icon: str = "NONE", text: str = "", **_: object) -> SimpleNamespace:
        _check_icon(icon)
        self._drawn.texts.append(text)
        asked = SimpleNamespace()
        assert hasattr(bpy.types, _type_name(name)) or name.startswith("wm."), f"there is no {name}"
        self._drawn.operators.append((name, asked))
        return asked

    def prop_search(self, data: Any, name: str, among: Any, prop: str, icon: str = "NONE", **_: object) -> None:
        assert hasattr(among, prop)
        self.prop(data, name, icon)

    def progress(self, factor: float = 0.0, text: str = "", **_: object) -> None:
        assert 0.0 <= factor <= 1.0
        self.label(text)

    def operator_menu_enum(self, name: str, prop: str, icon: str = "NONE", **_: object) -> None:
        self.operator(name, icon)

    def template_icon(self, value: int, scale: float = 1.0) -> None:
        assert scale > 0.0
        self._drawn.icons.append(value)

    def template_list(self, kind: str, name: str, data: Any, prop: str, active: Any, index: str, **_: object) -> None:
        assert hasattr(bpy.types, kind) and hasattr(data, prop) and hasattr(active, index)

    def menu(self, name: str, icon: str = "NONE", **_: object) -> None:
        _check_icon(icon)
        assert hasattr(bpy.types, name)

    def popover(self, panel: str, icon: str = "NONE", **_: object) -> None:
        self.menu(panel, icon)


def _type_name(operator: str) -> str:
    module, name = operator.split(".")
    return f"{module.upper()}_OT_{name}"


def _check_icon(icon: str) -> None:
    assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items, icon


def context_of(width: float, space: str = "PROPERTIES") -> SimpleNamespace:
    """What panels read of a context, with a region so many pixels wide in an editor of a kind."""
    view = SimpleNamespace(region_to_view=lambda x, y: (x, y))
    context = bpy.context
    return SimpleNamespace(
        scene=context.scene,
        view_layer=context.view_layer,
        object=context.view_layer.objects.active,
        selected_objects=list(context.view_layer.objects.selected),
        material=context.view_layer.objects.active.active_material if context.view_layer.objects.active else None,
        mode="OBJECT",
        preferences=context.preferences,
        window_manager=context.window_manager,
        area=SimpleNamespace(type=space),
        region=SimpleNamespace(width=width, type="WINDOW", view2d=view),
    )


def draw(panel: type, width: float = 300.0) -> Drawn | None:
    """What a panel draws for the open scene; None where it is not shown."""
    context = context_of(width, panel.bl_space_type)
    parent = getattr(panel, "bl_parent_id", "")
    if not all(cls.poll(context) for cls in (panel, getattr(bpy.types, parent, panel)) if hasattr(cls, "poll")):
        return None
    drawn = Drawn()
    panel.draw(_Panel(panel, Layout(drawn)), context)
    return drawn


class _Panel:
    """A panel of a class, which Blender alone can make."""

    def __init__(self, kind: type, layout: Layout) -> None:
        self._kind, self.layout = kind, layout

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._kind, name)
        return MethodType(found, self) if isinstance(found, FunctionType) else found


def ours(kind: type) -> Iterator[type]:
    """The registered classes of ours of a kind."""
    for cls in kind.__subclasses__():
        if cls.__name__.startswith("PCC_") and cls.is_registered:
            yield cls
