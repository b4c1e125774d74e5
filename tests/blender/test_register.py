"""Registering and unregistering leaves nothing behind."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import pytest

import pcc_addon


@pytest.fixture
def unregistered() -> Iterator[None]:
    pcc_addon.unregister()
    yield
    pcc_addon.register()


def properties_of(cls: type) -> set[str]:
    return {prop.identifier for prop in cls.bl_rna.properties}


def handlers() -> dict[str, list[str]]:
    """The functions in every handler list, by its name."""
    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    return {name: [f"{f.__module__}.{f.__qualname__}" for f in v] for name, v in lists.items() if isinstance(v, list)}


def draw_functions() -> dict[str, list[str]]:
    """The functions that draw each menu, panel and header that something was appended to."""
    classes = {name: getattr(bpy.types, name) for name in dir(bpy.types)}
    found = {name: getattr(getattr(cls, "draw", None), "_draw_funcs", None) for name, cls in classes.items()}
    return {
        name: [f"{f.__module__}.{f.__qualname__}" for f in functions if not f.__module__.startswith("bl_ui")]
        for name, functions in found.items()
        if functions is not None
    }


def everything() -> dict[str, object]:
    return {
        "types": set(dir(bpy.types)),
        "classes": {
            cls.__name__
            for base in (bpy.types.Operator, bpy.types.Panel, bpy.types.PropertyGroup)
            for cls in base.__subclasses__()
            if cls.__module__.startswith("pcc_addon") and cls.is_registered
        },
        "operators": {f"{module}.{name}" for module in dir(bpy.ops) for name in dir(getattr(bpy.ops, module))},
        "object": properties_of(bpy.types.Object),
        "scene": properties_of(bpy.types.Scene),
        "attributes": {name: set(vars(getattr(bpy.types, name))) for name in ("Object", "Scene")},
        "handlers": handlers(),
        "drawn": {name: functions for name, functions in draw_functions().items() if functions},
    }


def test_unregistering_takes_back_all_that_registering_added(unregistered: None) -> None:
    before = everything()
    pcc_addon.register()
    during = everything()
    pcc_addon.unregister()
    assert {key: value for key, value in everything().items() if value != before[key]} == {}
    unchanged = [key for key in before if during[key] == before[key]]
    assert unchanged == [], "this test sees nothing of these"


def test_registering_again_gives_the_same_as_the_first_time(unregistered: None) -> None:
    pcc_addon.register()
    first = everything()
    pcc_addon.unregister()
    pcc_addon.register()
    assert everything() == first
    pcc_addon.unregister()


def test_the_shell_command_is_registered_once_and_given_back(
    unregistered: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: dict[object, str] = {}
    register, unregister = bpy.utils.register_cli_command, bpy.utils.unregister_cli_command

    def keep(name: str, function: object) -> object:
        handle = register(name, function)
        held[handle] = name
        return handle

    def give_back(handle: object) -> None:
        unregister(handle)
        del held[handle]

    monkeypatch.setattr(bpy.utils, "register_cli_command", keep)
    monkeypatch.setattr(bpy.utils, "unregister_cli_command", give_back)
    pcc_addon.register()
    assert list(held.values()) == ["pcc"]
    pcc_addon.unregister()
    assert held == {}


def test_the_handler_outlives_opening_another_file(scene) -> None:
    names = handlers()["depsgraph_update_post"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert handlers()["depsgraph_update_post"] == names
    assert any("pcc_addon" in name for name in names)


def test_a_file_keeps_its_probes_while_the_add_on_is_away(scene) -> None:
    probe = bpy.data.objects.new("Probe", None)
    probe.pcc_probe.is_probe, probe.pcc_probe.resolution = True, 333
    pcc_addon.unregister()
    pcc_addon.register()
    assert probe.pcc_probe.is_probe and probe.pcc_probe.resolution == 333
