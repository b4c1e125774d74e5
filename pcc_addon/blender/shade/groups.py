"""The node groups that shaders use: one per set of effects, one per probe. Versioned, rebuilt in place."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

import bpy

from ...core.effects.lookup import lookup, off_poles, steepest_slope
from ...core.effects.records import LookupEffects, Outside, SurfaceEffects
from ...core.effects.reflectance import surface
from ...core.expression import Expr
from ...core.probe import ProbeSpec
from ..marks import role, tag
from . import node_builder

VERSION = 2
_VERSION = "pcc_version"
_BUILT_FOR = "pcc_built_for"  # the matrix of the probe when its group was built
_LOOKUP, _SURFACE, _GUARD = "Lookup, ", "Surface, ", "Off Poles"

# Entries of the probe's object-to-world matrix, by the names that the driver expressions give them: a b c is the
# first row of the 3×3 part, u v w the translation. Animation paths name the column first.
_ENTRIES = {name: f"matrix_world[{k % 3}][{k // 3}]" for k, name in enumerate("abcdefghi")}
_ENTRIES |= {name: f"matrix_world[3][{k}]" for k, name in enumerate("uvw")}
_DETERMINANT = "a*(e*i-f*h)-b*(d*i-f*g)+c*(d*h-e*g)"
# Each row is the cross product of two edges of the box, normal to the faces that they span.
_COFACTORS = (
    ("e*i-f*h", "c*h-b*i", "b*f-c*e"),
    ("f*g-d*i", "a*i-c*g", "c*d-a*f"),
    ("d*h-e*g", "b*g-a*h", "a*e-b*d"),
)
_AREAS = tuple(f"max(sqrt({'+'.join(f'pow({n},2)' for n in row)}),1e-300)" for row in _COFACTORS)
_DRIVEN = {
    "Box Centre": ("u", "v", "w"),
    "Half Widths": tuple(f"abs({_DETERMINANT})/{area}" for area in _AREAS),
    "Turn Mirror": ("-sin(atan2(d,a)/2)", "cos(atan2(d,a)/2)", "0"),
    **{
        f"Face Normal {axis}": tuple(f"({n})/{area}" for n in row)
        for axis, row, area in zip("XYZ", _COFACTORS, _AREAS, strict=True)
    },
}


# Blender 5.x turns driven values between 0 and 1e-4 into 0, so the drivers give multiples that a node divides again;
# powers of two change no digit.
_DRIVER_SCALE = 2.0**60


def lookup_group(effects: LookupEffects) -> bpy.types.ShaderNodeTree:
    """The group that finds the lookup direction; shared by all probes with these effects."""
    return _formula_group(f"{_LOOKUP}{effects.label}", lambda: lookup(effects))


def surface_group(effects: SurfaceEffects) -> bpy.types.ShaderNodeTree:
    """The group that lights a surface by a radiance; shared by all surfaces with these effects."""
    return _formula_group(f"{_SURFACE}{effects.label}", lambda: surface(effects))


def _formula_group(title: str, outputs: Callable[[], Mapping[str, Expr]]) -> bpy.types.ShaderNodeTree:
    """The group with this title; built where there is none, rebuilt in place where an older version built it."""
    own = [tree for tree in bpy.data.node_groups if role(tree) == title and not tree.library]
    tree = own[0] if own else bpy.data.node_groups.new(f"PCC {title}", "ShaderNodeTree")
    if tree.get(_VERSION) != VERSION:
        tag(tree, title)
        tree[_VERSION] = VERSION
        node_builder.emit(tree, outputs())
    return tree


def drop_unused_groups() -> None:
    """Remove formula groups that nothing uses; probe groups stay with their probes."""
    for tree in list(bpy.data.node_groups):
        if str(role(tree)).startswith((_LOOKUP, _SURFACE, _GUARD)) and tree.users == 0:
            bpy.data.node_groups.remove(tree)


def shown_effects(probe_group: bpy.types.ShaderNodeTree) -> str:
    """The label of the lookup effects that a probe's group was built for."""
    roles = [str(role(n.node_tree)) for n in probe_group.nodes if n.bl_idname == "ShaderNodeGroup"]
    return next(r.removeprefix(_LOOKUP) for r in roles if r.startswith(_LOOKUP))


def level_output(roughness: float) -> str:
    """The name of a probe group's output for one level."""
    return f"Radiance {roughness:.4f}"


def build_probe_group(
    probe: bpy.types.Object, spec: ProbeSpec, effects: LookupEffects, capture_point: tuple[float, float, float]
) -> bpy.types.ShaderNodeTree:
    """Build or rebuild a probe's group: box, capture point and pictures in, one radiance per level out.

    The box follows the probe object through drivers without Python; the capture point stays where the pictures
    were taken. Materials that use the group keep using it.
    """
    tree = probe.pcc_probe.group
    if tree is None or tree.library or _owner(tree) not in (None, probe):
        tree = bpy.data.node_groups.new(f"PCC Probe {probe.name}", "ShaderNodeTree")
        tag(tree, "probe")
        probe.pcc_probe.group = tree
    tree.nodes.clear()
    tree.animation_data_clear()
    tree[_BUILT_FOR] = _matrix(probe)
    levels = [level_output(level.roughness) for level in probe.pcc_probe.levels]
    node_builder.declare_sockets(tree, "OUTPUT", dict.fromkeys(levels, "NodeSocketColor"))
    node_builder.declare_sockets(tree, "INPUT", {"Normal": "NodeSocketVector"})

    nodes, links = tree.nodes, tree.links
    source, sink = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    geometry, find = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeGroup")
    find.node_tree = lookup_group(effects)
    find.label = "Lookup"
    given = {
        "Position": geometry.outputs["Position"],
        "Incoming": geometry.outputs["Incoming"],
        "Normal": source.outputs["Normal"],
    }
    constants = {
        "Capture Point": capture_point,
        "Padding": spec.influence_padding,
        "Falloff": spec.influence_falloff,
    }
    for k, socket in enumerate(find.inputs):
        if socket.name in given:
            links.new(given[socket.name], socket)
        elif socket.name in constants:
            socket.default_value = constants[socket.name]
        else:
            links.new(_driven_vector(tree, probe, socket.name, -180.0 * k), socket)
    for k, level in enumerate(probe.pcc_probe.levels):
        picture = nodes.new("ShaderNodeTexEnvironment")
        picture.image = level.image
        picture.label = f"roughness {level.roughness:.4f}"
        picture.location = (300, -280 * k)
        guard = nodes.new("ShaderNodeGroup")
        guard.node_tree = _formula_group(_GUARD, off_poles)
        guard.label = "Off Poles"
        guard.location = (120, -280 * k)
        guard.inputs["Steepest"].default_value = steepest_slope(level.image.size[1])
        links.new(find.outputs["Direction"], guard.inputs["Direction"])
        links.new(guard.outputs["Direction"], picture.inputs["Vector"])
        radiance = picture.outputs["Color"]
        if effects.outside is Outside.BLACK:
            fade = nodes.new("ShaderNodeVectorMath")
            fade.operation = "SCALE"
            fade.location = (560, -280 * k)
            links.new(radiance, fade.inputs["Vector"])
            links.new(find.outputs["Weight"], fade.inputs["Scale"])
            radiance = fade.outputs["Vector"]
        links.new(radiance, sink.inputs[level_output(level.roughness)])
    source.location, geometry.location, sink.location = (-850, 0), (-850, -200), (800, 0)
    return tree


def set_padding(probe_group: bpy.types.ShaderNodeTree, padding: float) -> None:
    """Let the influence begin to fade elsewhere, in metres beyond the box; nothing is rebuilt."""
    for node in probe_group.nodes:
        if node.label == "Lookup" and "Padding" in node.inputs:
            socket = node.inputs["Padding"]
            if abs(socket.default_value - padding) > 1e-6 * padding:  # setting it asks for another update
                socket.default_value = padding


def was_moved(probe: bpy.types.Object) -> bool:
    """Whether a probe stands elsewhere than when its group was built."""
    return list(probe.pcc_probe.group.get(_BUILT_FOR, ())) != _matrix(probe)


def _matrix(probe: bpy.types.Object) -> list[float]:
    return [float(value) for row in probe.matrix_world for value in row]


def _owner(tree: bpy.types.ShaderNodeTree) -> bpy.types.Object | None:
    """The probe that a group was built for: a copy of a probe starts out with the original's group."""
    curves = tree.animation_data.drivers if tree.animation_data else ()
    variables = (variable for curve in curves for variable in curve.driver.variables)
    followed = next((variable.targets[0].id for variable in variables), None)
    return followed or next((o for o in bpy.data.objects if o.pcc_probe.is_probe and o.pcc_probe.group == tree), None)


def _driven_vector(
    tree: bpy.types.ShaderNodeTree, probe: bpy.types.Object, name: str, y: float
) -> bpy.types.NodeSocket:
    """A vector that follows the probe's transform."""
    node, unscale = tree.nodes.new("ShaderNodeCombineXYZ"), tree.nodes.new("ShaderNodeVectorMath")
    node.name = node.label = name
    node.location, unscale.location = (-600, y), (-400, y)
    for axis, expression in enumerate(_DRIVEN[name]):
        driver = node.inputs[axis].driver_add("default_value").driver
        driver.type = "SCRIPTED"
        for letter, path in _ENTRIES.items():
            if letter in _letters(expression):
                variable = driver.variables.new()
                variable.name = letter
                variable.targets[0].id = probe
                variable.targets[0].data_path = path
        driver.expression = f"({expression})*{_DRIVER_SCALE:.0f}"
    unscale.operation = "SCALE"
    unscale.inputs["Scale"].default_value = 1.0 / _DRIVER_SCALE
    tree.links.new(node.outputs[0], unscale.inputs["Vector"])
    return unscale.outputs["Vector"]


def _letters(expression: str) -> set[str]:
    """The one-letter names in a driver expression."""
    return set(re.findall(r"\b[a-z]\b", expression))
