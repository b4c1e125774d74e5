"""What of a file is the user's, as lines to compare before and after."""

from __future__ import annotations

import bpy

from pcc_addon.blender import marks
from tests.rna_dump import dump


def of_the_user() -> dict[str, str]:
    """All materials, objects, textures and groups of the user's; and which node of each tree is active."""
    bpy.context.view_layer.update()
    ours = [tree for tree in bpy.data.node_groups if marks.role(tree)]
    used = [tree for tree in bpy.data.node_groups if tree.users]
    ours += [image for image in bpy.data.images if image.name.startswith("PCC ")]
    kinds = ("materials", "objects", "meshes", "node_groups", "images", "actions", "texts")
    lines = {path: value for path, value in dump(kinds, ours).items() if "pcc_probe" not in path}
    lines["images.names"] = repr([i.name for i in bpy.data.images if i not in ours])
    belonging = ("None", "copy", "formula: Surface")  # what goes with a material; lookups go with their probes
    lines["node_groups.names"] = repr([t.name for t in used if str(marks.role(t)).startswith(belonging)])
    for tree in [m.node_tree for m in bpy.data.materials if m.node_tree] + list(bpy.data.node_groups):
        if tree not in ours:
            lines[f"active in {tree.name} of {tree.id_data.name}"] = str(getattr(tree.nodes.active, "name", None))
    return lines


def settled() -> dict[str, str]:
    """The same, read twice: some properties come into being when they are first read."""
    of_the_user()
    return of_the_user()


def material_lines(material: bpy.types.Material) -> dict[str, str]:
    """One material, and the groups that go with it."""
    goes_with_it = ("copy", "formula: Surface")
    belonging = [t for t in bpy.data.node_groups if str(marks.role(t)).startswith(goes_with_it) and t.users]
    ours = [tree for tree in bpy.data.node_groups if tree not in belonging]
    others = [m for m in bpy.data.materials if m != material]
    dump(("materials",), others)  # some properties come into being when they are first read
    lines = dump(("materials", "node_groups"), [*others, *ours])
    lines["node_groups.names"] = repr([tree.name for tree in belonging])
    return lines
