"""Probes go out with Blender's glTF exporter, and come back with its importer."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import bpy

from ..core.errors import PccError
from ..core.export import gltf
from ..core.export.targets import target_of
from .export import cubemap_file
from .read.probes import bake_record, is_own_probe, probe_spec
from .setting_groups import Group

_OF_THIS_FILE = {"picture", "hidden_collection", "hidden_objects", "receivers", "excluded", "effects"}
_NAMES = [name for group in Group for name in group.names if name not in _OF_THIS_FILE] + ["capture_offset"]
_WIDEST = 256  # texels across a face: what is seen from other tools, in a file that is sent about


def export_node(node: Any, item: bpy.types.Object | None, export_settings: Mapping[str, Any]) -> None:
    """Give a probe's node its extension; called by Blender's exporter for each node."""
    if item is None or not is_own_probe(item):
        return
    from io_scene_gltf2.io.com.gltf2_io_extensions import Extension
    from io_scene_gltf2.io.exp.binary_data import BinaryData

    try:
        spec = probe_spec(item)
        y_up = bool(export_settings["gltf_yup"])
        plain = gltf.extension(spec, item.empty_display_size, _settings(item), y_up=y_up)
        if bake_record(item) is not None and y_up:
            made = cubemap_file(item, target_of("three"), _WIDEST)
            view = BinaryData(made.ktx2)
            plain["levels"] = gltf.levels(view, made.roughnesses, made.width, made.captured_at)
    except PccError as error:
        export_settings["log"].warning(str(error))
        return
    node.extensions = {**(node.extensions or {}), gltf.NAME: Extension(gltf.NAME, plain, required=False)}


def import_node(node: Any, item: bpy.types.Object, log: Any) -> None:
    """Make the empty of a node with the extension a probe; called by Blender's importer for each node."""
    found = (getattr(node, "extensions", None) or {}).get(gltf.NAME)
    if found is None or item is None or item.type != "EMPTY":
        return
    try:
        size, settings = gltf.settings_of(found, item.name)
    except PccError as error:
        log.warning(str(error))
        return
    item.pcc_probe.is_probe = True
    item.empty_display_type, item.empty_display_size = "CUBE", size
    for name in _NAMES:
        if name in settings:
            with suppress(TypeError, ValueError, OverflowError):  # what anybody may have written
                setattr(item.pcc_probe, name, settings[name])


def _settings(probe: bpy.types.Object) -> dict[str, Any]:
    return {name: _plain(getattr(probe.pcc_probe, name)) for name in _NAMES}


def _plain(value: Any) -> Any:
    return value if isinstance(value, (bool, int, float, str)) else [float(component) for component in value]
