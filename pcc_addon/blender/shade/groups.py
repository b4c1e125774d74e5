"""The node groups of formulas, shared by all who use them. Versioned, rebuilt in place."""

from __future__ import annotations

import bpy

from ...core.effects.surface import SurfaceEffects, surface_formula
from ...core.expression import Formula
from .. import marks
from . import node_builder

VERSION = 7
_FORMULA = "formula: "  # how the roles of these groups begin


def formula_group(formula: Formula) -> bpy.types.ShaderNodeTree:
    """The group of a formula; built where there is none, rebuilt in place where an older version built it."""
    role, name = _FORMULA + formula.title, f"PCC {formula.title}"
    tree = _known(role, name)
    if tree is None:
        tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
        marks.tag(tree, role)
    if marks.noted(tree, marks.VERSION) != VERSION:
        marks.note(tree, marks.VERSION, VERSION)
        surroundings = node_builder.Surroundings(group_of=formula_group)
        node_builder.emit(tree, formula.outputs, surroundings)
    return tree


def surface_group(effects: SurfaceEffects) -> bpy.types.ShaderNodeTree:
    """The group that lights a surface by a radiance; shared by all surfaces with these effects."""
    return formula_group(surface_formula(effects))


def drop_unused_groups() -> None:
    """Remove what nothing uses: groups of formulas and for shaders made by hand, and those that only they used.

    Probe groups stay with their probes.
    """
    ours = (_FORMULA, marks.BY_HAND)
    while unused := [t for t in bpy.data.node_groups if t.users == 0 and (marks.role(t) or "").startswith(ours)]:
        for tree in unused:
            bpy.data.node_groups.remove(tree)


def _known(role: str, name: str) -> bpy.types.ShaderNodeTree | None:
    """The group with a role, which has this name unless a user gave it another."""
    named = bpy.data.node_groups.get((name, None))
    if named is not None and marks.role(named) == role:
        return named
    return next((t for t in bpy.data.node_groups if marks.role(t) == role and not t.library), None)
