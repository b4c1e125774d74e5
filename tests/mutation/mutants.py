"""One-line changes of a module's source, each of which a test should notice."""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

_COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
}
_UNTOUCHED = (ast.Import, ast.ImportFrom, ast.JoinedStr)
_NOT_RUN = {"annotation", "returns", "decorator_list", "bases"}  # fields that tests have no say in


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
        number: its place among all of the module.
        kind: what sort of change, such as "comparison".
        line: where, counted from 1.
        before, after: what is replaced by what.
    """

    number: int
    kind: str
    line: int
    before: str
    after: str


@dataclass(frozen=True)
class _Site:
    """A node within its parent, and what to put in its place."""

    kind: str
    parent: Any
    place: str | int
    old: ast.AST
    new: ast.AST | None
    line: int

    def apply(self) -> None:
        if self.new is None:
            del self.parent[self.place]
        elif isinstance(self.place, int):
            self.parent[self.place] = self.new
        else:
            setattr(self.parent, self.place, self.new)


def mutants(source: str) -> list[Mutant]:
    """All changes of a module's source text, in the order of the text."""
    return [
        Mutant(number, site.kind, site.line, ast.unparse(site.old), ast.unparse(site.new) if site.new else "")
        for number, site in enumerate(_sites(ast.parse(source)))
    ]


def mutated(source: str, number: int) -> str:
    """The source text with one of its changes made."""
    tree = ast.parse(source)
    list(_sites(tree))[number].apply()
    return ast.unparse(ast.fix_missing_locations(tree))


def sample(found: list[Mutant], count: int, seed: int) -> list[Mutant]:
    """Some of the changes, as evenly from all kinds as there are; the same ones for the same seed."""
    dice = random.Random(seed)
    kinds: dict[str, list[Mutant]] = {}
    for mutant in found:
        kinds.setdefault(mutant.kind, []).append(mutant)
    for group in kinds.values():
        dice.shuffle(group)
    turns = [(turn, dice.random(), mutant) for group in kinds.values() for turn, mutant in enumerate(group)]
    turns.sort(key=lambda entry: entry[:2])
    return sorted((mutant for _, _, mutant in turns[:count]), key=lambda mutant: mutant.number)


def _sites(node: ast.AST) -> Iterator[_Site]:
    for name, value in ast.iter_fields(node):
        if name in _NOT_RUN:
            continue
        children = list(enumerate(value)) if isinstance(value, list) else [(name, value)]
        parent = value if isinstance(value, list) else node
        for place, child in children:
            if not isinstance(child, ast.AST) or _is_idle(child):
                continue
            line = getattr(child, "lineno", 0)
            for kind, new in _replacements(
                child, is_test=name in {"test", "ifs"}, of_while=isinstance(node, ast.While)
            ):
                yield _Site(kind, parent, place, child, new, line)
            yield from _droppable(child)
            yield from _sites(child)


def _is_idle(node: ast.AST) -> bool:
    """Whether a node does nothing that a test could see: imports, docstrings, what only type checkers read."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True
    checks_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    return isinstance(node, _UNTOUCHED) or checks_types


def _replacements(node: ast.AST, *, is_test: bool, of_while: bool) -> Iterator[tuple[str, ast.AST]]:
    match node:
        case ast.Compare(ops=[operator]):
            for other in _COMPARISONS[type(operator)]:
                yield "comparison", ast.Compare(node.left, [other()], node.comparators)
        case ast.BinOp() if type(node.op) in _OPERATORS:
            yield "operator", ast.BinOp(node.left, _OPERATORS[type(node.op)](), node.right)
        case ast.BoolOp():
            yield "and/or", ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values)
        case ast.UnaryOp(op=ast.Not() | ast.USub()):
            yield "negation dropped", node.operand
        case ast.Constant():
            yield from (("constant", ast.Constant(value)) for value in _other_values(node.value))
        case ast.Return(value=ast.AST()) if ast.unparse(node.value) != "None":
            yield "value not returned", ast.Return(ast.Constant(None))
        case ast.Expr() | ast.AugAssign() | ast.Raise() | ast.Continue() | ast.Break():
            yield "statement removed", ast.Pass()
        case ast.Assign(targets=[ast.Attribute() | ast.Subscript()]):
            yield "statement removed", ast.Pass()
        case ast.IfExp():
            yield "condition forced", node.body
            yield "condition forced", node.orelse
    if is_test and not isinstance(node, ast.Constant):
        yield "condition forced", ast.Constant(False)
        if not of_while:
            yield "condition forced", ast.Constant(True)


def _other_values(value: object) -> list[object]:
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, float):
        return [value * 1.5 if value else 1.0]
    return [f"{value}?"] if isinstance(value, str) else []


def _droppable(node: ast.AST) -> Iterator[_Site]:
    """Elements of displays and named arguments of calls that could be missing."""
    line = getattr(node, "lineno", 0)
    if isinstance(node, (ast.List, ast.Set, ast.Tuple)) and len(node.elts) > 1:
        if not isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del)):
            yield from (
                _Site("element dropped", node.elts, k, element, None, line) for k, element in enumerate(node.elts)
            )
    elif isinstance(node, ast.Call):
        arguments = enumerate(node.keywords)
        yield from (_Site("argument dropped", node.keywords, k, word, None, line) for k, word in arguments)
