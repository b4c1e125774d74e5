"""Vectors that follow a probe's transform without Python: driver expressions over its matrix and its drawn size."""

from __future__ import annotations

import re

import bpy

# Entries of the probe's object-to-world matrix, by the names that the driver expressions give them: a b c is the
# first row of the 3×3 part, u v w the translation. Animation paths name the column first. s is half the size that
# the empty is drawn with, which its scale multiplies.
_ENTRIES = {name: f"matrix_world[{k % 3}][{k // 3}]" for k, name in enumerate("abcdefghi")}
_ENTRIES |= {name: f"matrix_world[3][{k}]" for k, name in enumerate("uvw")} | {"s": "empty_display_size"}
_DETERMINANT = "a*(e*i-f*h)-b*(d*i-f*g)+c*(d*h-e*g)"
# Each row is the cross product of two edges of the box, normal to the faces that they span.
_COFACTORS = (
    ("e*i-f*h", "c*h-b*i", "b*f-c*e"),
    ("f*g-d*i", "a*i-c*g", "c*d-a*f"),
    ("d*h-e*g", "b*g-a*h", "a*e-b*d"),
)
_AREAS = tuple(f"max(sqrt({'+'.join(f'pow({n},2)' for n in row)}),1e-300)" for row in _COFACTORS)
_HANDEDNESS = f"(1 if {_DETERMINANT}>0 else -1)"  # of a mirrored box; then the products of its edges point inwards
DRIVEN = {
    "Box Centre": ("u", "v", "w"),
    "Half Widths": tuple(f"s*abs({_DETERMINANT})/{area}" for area in _AREAS),
    "Turn Mirror": ("-sin(atan2(d,a)/2)", "cos(atan2(d,a)/2)", "0"),
    **{
        f"Face Normal {axis}": tuple(f"({n})/{area}*{_HANDEDNESS}" for n in row)
        for axis, row, area in zip("XYZ", _COFACTORS, _AREAS, strict=True)
    },
}

# Blender 5.x turns driven values between 0 and 1e-4 into 0, so the drivers give multiples that a node divides again;
# powers of two change no digit.
_SCALE = 2.0**60


def driven_vector(
    tree: bpy.types.ShaderNodeTree, probe: bpy.types.Object, name: str
) -> tuple[bpy.types.NodeSocket, tuple[bpy.types.Node, ...]]:
    """The output that is one of `DRIVEN` for a probe, wherever that goes; and the new nodes that make it."""
    node, unscale = tree.nodes.new("ShaderNodeCombineXYZ"), tree.nodes.new("ShaderNodeVectorMath")
    node.name = node.label = name
    for axis, expression in enumerate(DRIVEN[name]):
        driver = node.inputs[axis].driver_add("default_value").driver
        driver.type = "SCRIPTED"
        for letter in sorted(_letters(expression)):
            variable = driver.variables.new()
            variable.name = letter
            variable.targets[0].id = probe
            variable.targets[0].data_path = _ENTRIES[letter]
        driver.expression = f"({expression})*{_SCALE:.0f}"
    unscale.operation = "SCALE"
    unscale.inputs["Scale"].default_value = 1.0 / _SCALE
    tree.links.new(node.outputs[0], unscale.inputs["Vector"])
    return unscale.outputs["Vector"], (node, unscale)


def follow(tree: bpy.types.ShaderNodeTree, probe: bpy.types.Object) -> None:
    """Let the drivers of a group follow a probe instead of whom they followed before."""
    for curve in tree.animation_data.drivers if tree.animation_data else ():
        for variable in curve.driver.variables:
            if variable.targets[0].id != probe:
                variable.targets[0].id = probe


def _letters(expression: str) -> set[str]:
    """The one-letter names in a driver expression."""
    return set(re.findall(r"\b[a-z]\b", expression))
