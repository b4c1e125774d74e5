"""Materials as plain data: the surfaces that reach their outputs, with each input constant or varying."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ...core.readings import MaterialReading, SurfaceReading
from .. import compat, marks
from ..effect_settings import forced_of_material
from .nodes import Scope, constant, group_output, outputs, source

_TEXTURES = {"ShaderNodeTexImage", "ShaderNodeTexEnvironment"}
_DEEPEST = 200  # nodes between an output and a surface


class _Obstacle(Exception):
    """Why a material must be left as it is, in words that follow its name."""


def read_material(material: bpy.types.Material) -> MaterialReading:
    """One material; whatever is wrong with it becomes an obstacle."""
    shown = tuple(sorted({g.name for g in _probe_groups(material.node_tree)})) if material.node_tree else ()
    if material.library:
        obstacle = f"is linked from '{material.library.filepath}': inject it there, or make it local"
    elif material.override_library:
        library = material.override_library.reference.library
        obstacle = f"is a library override, whose nodes are those of '{library.filepath}': inject it there"
    elif material.grease_pencil:
        obstacle = "is a grease pencil material"
    elif not compat.uses_nodes(material):
        obstacle = "uses no nodes: switch Use Nodes on"
    else:
        return _read_nodes(material, shown)
    return MaterialReading(material.name_full, obstacles=(obstacle,), shown=shown, allowed=allowed_probes(material))


def allowed_probes(material: bpy.types.Material) -> frozenset[str] | None:
    """Names of the only probes that its user lets a material show; None: all, empty: none."""
    settings = marks.original(material).pcc
    if not settings.show_probes:
        return frozenset()
    return frozenset({settings.probe.name_full}) if settings.probe else None


def _read_nodes(material: bpy.types.Material, shown: tuple[str, ...]) -> MaterialReading:
    surfaces: dict[tuple[str, ...], SurfaceReading] = {}
    emits, obstacles = False, []
    try:
        for output in outputs(material):
            for node, scope in _leaves(output.inputs["Surface"], Scope(material.node_tree), (), set()):
                emits = emits or _glows(node, scope)
                if node.bl_idname.startswith(("ShaderNodeBsdf", "ShaderNodeEeveeSpecular")):
                    surfaces.setdefault(scope.path(node), _surface(node, scope))
    except _Obstacle as obstacle:
        obstacles.append(str(obstacle))
    return MaterialReading(
        name=material.name_full,
        surfaces=tuple(surfaces[path] for path in sorted(surfaces)),
        obstacles=tuple(obstacles),
        textures=len(_textures(material.node_tree, set())),
        emits=emits,
        slab=material.thickness_mode == "SLAB",
        bends_normals=material.cycles.use_bump_map_correction,
        shown=shown,
        forced=forced_of_material(marks.original(material)),
        allowed=allowed_probes(material),
    )


def _leaves(
    socket: bpy.types.NodeSocket, scope: Scope, above: tuple[tuple, ...], done: set[tuple]
) -> Iterator[tuple[bpy.types.Node, Scope]]:
    """The shader nodes without shader inputs that feed a socket, and where they are, each once."""
    feeding = source(socket)
    if feeding is None or feeding.type != "SHADER" or feeding.node.mute:
        return
    node = feeding.node
    key = (scope.nodes, node.name)
    if key in above:
        raise _Obstacle(f"has shaders that feed themselves (at '{node.name}'): cut the loop")
    if (*key, feeding.identifier) in done:
        return
    done.add((*key, feeding.identifier))
    if len(above) > _DEEPEST:
        raise _Obstacle(f"has more than {_DEEPEST} shaders one behind the other")
    if "Repeat" in node.bl_idname or "Closure" in node.bl_idname:
        raise _Obstacle(f"has a zone of shaders ('{node.name}'), which is not handled: write it out")
    above = (*above, key)
    shaders = [s for s in node.inputs if s.type == "SHADER"]
    if node.bl_idname == "ShaderNodeGroup" and node.node_tree:
        inner = group_output(node.node_tree)
        index = list(node.outputs).index(feeding)
        if inner is not None and index < len(inner.inputs):
            yield from _leaves(inner.inputs[index], scope.inside(node), above, done)
    elif not shaders:
        yield node, scope
    for shader in shaders:
        yield from _leaves(shader, scope, above, done)


def _surface(node: bpy.types.Node, scope: Scope) -> SurfaceReading:
    inputs = tuple((socket.name, constant(socket, scope)) for socket in node.inputs if socket.enabled)
    return SurfaceReading(
        scope.path(node),
        node.bl_idname,
        inputs,
        getattr(node, "distribution", ""),
        getattr(node, "fresnel_type", ""),
        compat.FILMS_ON_METAL,
        compat.FILMS_ON_BOTH,
    )


def _glows(node: bpy.types.Node, scope: Scope) -> bool:
    """Whether a shader emits light of its own."""
    names = {
        "ShaderNodeEmission": ("Color", "Strength"),
        "ShaderNodeBsdfPrincipled": ("Emission Color", "Emission Strength"),
    }.get(node.bl_idname)
    if names is None:
        return False
    color, strength = (constant(node.inputs[name], scope) for name in names)
    return strength != 0.0 and (color is None or any(color[:3]))


def _textures(tree: bpy.types.NodeTree, seen: set[str]) -> set[bpy.types.Image]:
    """The images that the user's nodes sample."""
    found = set()
    for node in tree.nodes:
        if marks.role(node):
            continue
        if node.bl_idname in _TEXTURES and node.image:
            found.add(node.image)
        inner = getattr(node, "node_tree", None)
        if inner is not None and inner.name_full not in seen:
            seen.add(inner.name_full)
            found |= _textures(inner, seen)
    return found


def _probe_groups(tree: bpy.types.NodeTree) -> Iterator[bpy.types.NodeTree]:
    for node in tree.nodes:
        if marks.role(node) and node.bl_idname == "ShaderNodeGroup" and node.node_tree:
            if marks.role(node.node_tree) == "probe":
                yield node.node_tree
            elif marks.role(node.node_tree) == marks.TWIN_GROUP:
                yield from _probe_groups(node.node_tree)
