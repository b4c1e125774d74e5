"""The node groups of formulas, shared by all who use them. Versioned, rebuilt in place."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

import bpy

from ...core.effects.lookup import PARALLAX
from ...core.effects.surface import SurfaceEffects, surface_formula
from ...core.expression import Formula
from .. import marks, unrecorded
from . import node_builder

VERSION = 9
SPARE = 32  # groups of formulas that may be without users
SPARE_COPIES = 200
_asked_for: dict[int, int] = {}  # by session uid: when
_count = count()
_FORMULA = "formula: "  # how the roles of these groups begin


def formula_group(formula: Formula) -> bpy.types.ShaderNodeTree:
    """The group of a formula; built where there is none, rebuilt in place where an older version built it.

    One without users that was not asked for in a while becomes the new one: dragging a slider leaves few behind.
    """
    tree = _known(formula)
    if tree is None:
        tree = _empty()
        _name(tree, formula)
    _asked_for[tree.session_uid] = next(_count)
    if marks.noted(tree, marks.VERSION) != VERSION:
        marks.note(tree, marks.VERSION, VERSION)
        node_builder.emit(tree, formula.outputs, node_builder.Surroundings(group_of=formula_group))
    return tree


def preparing(formula: Formula) -> Iterator[None]:
    """Make the group of a formula where there is none, those that it calls first; milliseconds between two yields.

    It has no users yet, and is nobody's until it is whole. What goes on after an undo begins anew: nodes may be gone.

    Raises:
        ReferenceError: the group was removed meanwhile.
    """
    if (known := _known(formula)) is not None:
        _asked_for[known.session_uid] = next(_count)
        return
    for called in formula.called:
        yield from preparing(called)
    tree = _empty()
    marks.tag(tree, _FORMULA)
    _asked_for[tree.session_uid] = next(_count)
    surroundings = node_builder.Surroundings(group_of=formula_group)
    for _ in node_builder.emitting(tree, formula.outputs, surroundings):
        yield
        tree.id_data  # noqa: B018  # unlike its nodes it tells whether it is still there
    if _known(formula) is None:
        _name(tree, formula)
        marks.note(tree, marks.VERSION, VERSION)


def surface_group(effects: SurfaceEffects) -> bpy.types.ShaderNodeTree:
    """The group that lights a surface by a radiance; shared by all surfaces with these effects."""
    return formula_group(surface_formula(effects))


def parallax_nodes() -> list[bpy.types.Node]:
    """The nodes that correct the lookups of all probes in the file; muted, they leave the classic ones."""
    role = _FORMULA + PARALLAX.title
    trees = [tree for tree in bpy.data.node_groups if marks.role(tree) == role]
    return [node for tree in trees for node in tree.nodes if node.bl_idname == "ShaderNodeVectorMath"]


def drop_unused_groups() -> None:
    """Remove what nothing uses: groups of formulas, copies, groups for shaders made by hand, and what only they used.

    Only where what follows is no undo to a step that knows them (`unrecorded`). Probe groups stay with their probes.
    """
    while unused := _unused(_FORMULA, marks.BY_HAND, marks.TWIN_GROUP):
        for tree in unused:
            bpy.data.node_groups.remove(tree)


def drop_oldest_copies() -> None:
    """Remove copies of users' groups that have been without users for long."""
    unused = sorted(_unused(marks.TWIN_GROUP), key=lambda tree: tree.session_uid)
    bpy.data.batch_remove(unused[:-SPARE_COPIES])


def _empty() -> bpy.types.ShaderNodeTree:
    """A group to be that of a formula."""
    tree = _spare() or unrecorded.new_group("PCC")
    marks.forget(tree, marks.VERSION)
    return tree


def _name(tree: bpy.types.ShaderNodeTree, formula: Formula) -> None:
    role, tree.name = _names(formula)
    marks.tag(tree, role)


def _names(formula: Formula) -> tuple[str, str]:
    """The role of a formula's group, and its name unless a user gave it another."""
    return _FORMULA + formula.title, f"PCC {formula.title}"


def _spare() -> bpy.types.ShaderNodeTree | None:
    """A formula's group without users that was last asked for long ago, where enough others are left for undo."""
    spare = _unused(_FORMULA)
    return min(spare, key=lambda tree: _asked_for.get(tree.session_uid, -1)) if len(spare) > SPARE else None


def _unused(*roles: str) -> list[bpy.types.ShaderNodeTree]:
    """The groups without users whose roles begin so."""
    return [t for t in bpy.data.node_groups if not t.users and (marks.role(t) or "").startswith(roles)]


def _known(formula: Formula) -> bpy.types.ShaderNodeTree | None:
    """The group of a formula, of whatever version."""
    role, name = _names(formula)
    named = bpy.data.node_groups.get((name, None))
    if named is not None and marks.role(named) == role:
        return named
    return next((t for t in bpy.data.node_groups if marks.role(t) == role and not t.library), None)
