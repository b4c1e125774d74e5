"""What Blender's glTF exporter and importer look for in add-ons, under the names that they ask for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class glTF2ExportUserExtension:
    """Asked for each node that is exported."""

    def gather_node_hook(self, node: Any, item: Any, export_settings: Mapping[str, Any]) -> None:
        from .blender.gltf import export_node

        export_node(node, item, export_settings)


class glTF2ImportUserExtension:
    """Asked for each node that was imported."""

    def gather_import_node_after_hook(self, vnode: Any, node: Any, item: Any, gltf: Any) -> None:
        from .blender.gltf import import_node

        import_node(node, item, gltf.log)
