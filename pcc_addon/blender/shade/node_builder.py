"""Emits expressions as shader nodes. The only module that knows which node computes what."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import bpy

from ...core.expression import Constant, Expr, Input, Op, Operation

_MATH = {
    Op.ADD: "ADD",
    Op.SUBTRACT: "SUBTRACT",
    Op.MULTIPLY: "MULTIPLY",
    Op.DIVIDE: "DIVIDE",
    Op.MINIMUM: "MINIMUM",
    Op.MAXIMUM: "MAXIMUM",
    Op.ABSOLUTE: "ABSOLUTE",
    Op.SIGN: "SIGN",
    Op.SQRT: "SQRT",
    Op.MULTIPLY_ADD: "MULTIPLY_ADD",
    Op.DOT: "DOT_PRODUCT",
    Op.LENGTH: "LENGTH",
    Op.NORMALIZE: "NORMALIZE",
    Op.REFLECT: "REFLECT",
}
_COMPONENTS = {Op.COMPONENT_X: 0, Op.COMPONENT_Y: 1, Op.COMPONENT_Z: 2}
_COLUMN, _ROW = 180.0, 160.0


def emit(tree: bpy.types.ShaderNodeTree, outputs: Mapping[str, Expr]) -> None:
    """Make a node group compute `outputs`: an interface socket per input and output, a node per operation.

    Equal operations on equal arguments become one node. What the group computed before is replaced; sockets that stay
    keep their links in the trees that use it.
    """
    tree.nodes.clear()
    inputs = {expr.name: expr.width for expr in inputs_of(outputs)}
    declare_sockets(tree, "INPUT", {name: _SOCKETS[width] for name, width in inputs.items()})
    declare_sockets(tree, "OUTPUT", {name: _SOCKETS[expr.width] for name, expr in outputs.items()})
    emitter = _Emitter(tree)
    sink = tree.nodes.new("NodeGroupOutput")
    for name, expr in outputs.items():
        emitter.connect(expr, sink.inputs[name])
    sink.location.x = _COLUMN * (emitter.depth + 1)


def inputs_of(outputs: Mapping[str, Expr]) -> list[Input]:
    """The inputs that some expressions read, each once, in the order of their first use."""
    found: dict[str, Input] = {}
    for expr in outputs.values():
        for part in _walk(expr, set()):
            if isinstance(part, Input):
                found.setdefault(part.name, part)
    return list(found.values())


def _walk(expr: Expr, seen: set[int]) -> Iterator[Expr]:
    if id(expr) in seen:
        return
    seen.add(id(expr))
    for argument in expr.args if isinstance(expr, Operation) else ():
        yield from _walk(argument, seen)
    yield expr


_SOCKETS = {1: "NodeSocketFloat", 3: "NodeSocketVector"}


def declare_sockets(tree: bpy.types.ShaderNodeTree, in_out: str, wanted: Mapping[str, str]) -> None:
    """Give a group's inputs or outputs these names and socket types; sockets that fit already are kept."""
    fitting = set()
    for item in [i for i in tree.interface.items_tree if i.in_out == in_out]:
        if wanted.get(item.name) == item.bl_socket_idname:
            fitting.add(item.name)
        else:
            tree.interface.remove(item)
    for name, kind in wanted.items():
        if name not in fitting:
            tree.interface.new_socket(name, in_out=in_out, socket_type=kind)


class _Emitter:
    """One walk over expressions; remembers what it has made."""

    def __init__(self, tree: bpy.types.ShaderNodeTree) -> None:
        self.tree = tree
        self.source = tree.nodes.new("NodeGroupInput")
        self.depth = 0
        self._numbers: dict[tuple, int] = {}
        self._number_of: dict[int, int] = {}
        self._sockets: dict[int, tuple[bpy.types.NodeSocket, int]] = {}
        self._separated: dict[int, bpy.types.Node] = {}
        self._rows: dict[int, int] = {}

    def connect(self, expr: Expr, socket: bpy.types.NodeSocket) -> int:
        """Feed `expr` into `socket`; returns how many nodes deep it is."""
        if isinstance(expr, Constant):
            wide = hasattr(socket.default_value, "__len__")
            socket.default_value = (expr.value * 3)[:3] if wide else expr.value[0]
            return 0
        result, depth = self._socket(expr)
        self.tree.links.new(result, socket)
        return depth

    def _number(self, expr: Expr) -> int:
        """The same number for the same value (value numbering)."""
        if id(expr) not in self._number_of:
            if isinstance(expr, Constant):
                key: tuple = ("constant", expr.value)
            elif isinstance(expr, Input):
                key = ("input", expr.name)
            else:
                key = (expr.op, *(self._number(argument) for argument in expr.args))
            self._number_of[id(expr)] = self._numbers.setdefault(key, len(self._numbers))
        return self._number_of[id(expr)]

    def _socket(self, expr: Expr) -> tuple[bpy.types.NodeSocket, int]:
        number = self._number(expr)
        if number not in self._sockets:
            if isinstance(expr, Input):
                self._sockets[number] = self.source.outputs[expr.name], 0
            else:
                assert isinstance(expr, Operation)
                self._sockets[number] = self._operation(expr)
        return self._sockets[number]

    def _operation(self, expr: Operation) -> tuple[bpy.types.NodeSocket, int]:
        if expr.op in _COMPONENTS:
            number = self._number(expr.args[0])
            if number not in self._separated:
                node = self.tree.nodes.new("ShaderNodeSeparateXYZ")
                self._place(node, self.connect(expr.args[0], node.inputs[0]))
                self._separated[number] = node
            node = self._separated[number]
            return node.outputs[_COMPONENTS[expr.op]], int(node.location.x / _COLUMN)
        sockets = None
        if expr.op is Op.COMBINE:
            node = self.tree.nodes.new("ShaderNodeCombineXYZ")
        elif all(part.width == 1 for part in (expr, *expr.args)):
            node = self.tree.nodes.new("ShaderNodeMath")
            node.operation = _MATH[expr.op]
        else:
            node = self.tree.nodes.new("ShaderNodeVectorMath")
            if expr.op is Op.MULTIPLY and 1 in (part.width for part in expr.args):
                node.operation = "SCALE"
                vector_first = expr.args[0].width == 3
                sockets = [node.inputs["Vector"], node.inputs["Scale"]][:: 1 if vector_first else -1]
            else:
                node.operation = _MATH[expr.op]
        targets = sockets or [socket for socket in node.inputs if socket.enabled]
        depth = max(self.connect(part, socket) for part, socket in zip(expr.args, targets, strict=True))
        self._place(node, depth)
        output = next(socket for socket in node.outputs if socket.enabled)
        return output, depth + 1

    def _place(self, node: bpy.types.Node, depth: int) -> None:
        row = self._rows.get(depth, 0)
        self._rows[depth] = row + 1
        node.location = (_COLUMN * (depth + 1), -_ROW * row)
        self.depth = max(self.depth, depth + 1)
