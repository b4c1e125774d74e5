"""Emits formulas as shader nodes. The only module that knows which node computes what."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import bpy

from ...core.expression import (
    Call,
    Constant,
    Expr,
    Formula,
    Input,
    Op,
    Operation,
    Sample,
    Section,
    Texel,
    arguments_of,
    lift,
    maximum,
)
from .node_layout import NodeLayout

_MATH = {
    Op.ADD: "ADD",
    Op.SUBTRACT: "SUBTRACT",
    Op.MULTIPLY: "MULTIPLY",
    Op.DIVIDE: "DIVIDE",
    Op.MINIMUM: "MINIMUM",
    Op.MAXIMUM: "MAXIMUM",
    Op.ABSOLUTE: "ABSOLUTE",
    Op.SIGN: "SIGN",
    Op.FLOOR: "FLOOR",
    Op.CROSS: "CROSS_PRODUCT",
    Op.SQRT: "SQRT",
    Op.EXP2: "POWER",
    Op.COSINE: "COSINE",
    Op.MULTIPLY_ADD: "MULTIPLY_ADD",
    Op.DOT: "DOT_PRODUCT",
    Op.LENGTH: "LENGTH",
    Op.NORMALIZE: "NORMALIZE",
    Op.REFLECT: "REFLECT",
}
_COMPONENTS = {Op.COMPONENT_X: 0, Op.COMPONENT_Y: 1, Op.COMPONENT_Z: 2}
_SOCKETS = {1: "NodeSocketFloat", 3: "NodeSocketVector"}


def _no_group(formula: Formula) -> bpy.types.ShaderNodeTree:
    raise LookupError(f"no node group is known for formula '{formula.title}'")


@dataclass(frozen=True)
class Surroundings:
    """What a formula meets in Blender.

    Attributes:
        given: makes the output that feeds an input, for inputs that are no sockets of the group; called once each.
        images: the pictures by name.
        group_of: the node group of a formula that is called.
        colors: inputs and outputs that are colours and not vectors.
    """

    given: Mapping[str, Callable[[], bpy.types.NodeSocket]] = field(default_factory=dict)
    images: Mapping[str, bpy.types.Image] = field(default_factory=dict)
    group_of: Callable[[Formula], bpy.types.ShaderNodeTree] = _no_group
    colors: frozenset[str] = frozenset()


def emit(tree: bpy.types.ShaderNodeTree, outputs: Mapping[str, Expr], surroundings: Surroundings | None = None) -> None:
    """Make a node group compute `outputs`: an interface socket per input and output, a node per operation.

    Equal operations on equal arguments become one node. What the group computed before is replaced; sockets that stay
    keep their links in the trees that use it. Nodes stand from left to right, each section of the formula in a frame.
    """
    for _ in emitting(tree, outputs, surroundings):
        pass


def emitting(
    tree: bpy.types.ShaderNodeTree, outputs: Mapping[str, Expr], surroundings: Surroundings | None = None
) -> Iterator[None]:
    """`emit`, about a node between two yields: each takes the longer the more nodes there are, a group up to 0.5 s.

    Whoever goes on makes sure that the tree and its nodes are still there.
    """
    surroundings = surroundings or Surroundings()
    tree.nodes.clear()
    inputs = Formula("", outputs).inputs
    kinds = {
        name: "NodeSocketColor" if name in surroundings.colors else _SOCKETS[part.width]
        for name, part in (inputs | dict(outputs)).items()
    }
    declare_sockets(tree, "INPUT", {name: kinds[name] for name in inputs if name not in surroundings.given})
    declare_sockets(tree, "OUTPUT", {name: kinds[name] for name in outputs})
    emitter = _Emitter(tree, surroundings)
    for expr in outputs.values():
        yield from emitter.making(expr)
    sink = tree.nodes.new("NodeGroupOutput")
    depths = [emitter.connect(expr, sink.inputs[name]) for name, expr in outputs.items()]
    emitter.layout.add(sink, max(depths, default=0), "")
    emitter.layout.arrange()


def declare_sockets(tree: bpy.types.ShaderNodeTree, in_out: str, wanted: Mapping[str, str]) -> None:
    """Give a group's inputs or outputs these names and socket types; sockets that fit already are kept."""
    fitting = set()
    for item in [i for i in tree.interface.items_tree if i.in_out == in_out]:
        if wanted.get(item.name) == item.socket_type and item.name not in fitting:
            fitting.add(item.name)
        else:
            tree.interface.remove(item)
    for name, kind in wanted.items():
        if name not in fitting:
            tree.interface.new_socket(name, in_out=in_out, socket_type=kind)


class _Emitter:
    """One walk over expressions; remembers what it has made. A socket's depth is how many nodes lead to it."""

    def __init__(self, tree: bpy.types.ShaderNodeTree, surroundings: Surroundings) -> None:
        self.tree, self.layout = tree, NodeLayout(tree)
        self._surroundings = surroundings
        self._source: bpy.types.Node | None = None
        self._section = ""
        self._numbers: dict[tuple, int] = {}
        self._number_of: dict[Expr, int] = {}
        self._sockets: dict[int, tuple[bpy.types.NodeSocket, int]] = {}
        self._shared: dict[tuple, tuple[bpy.types.Node, int]] = {}

    def connect(self, expr: Expr, socket: bpy.types.NodeSocket) -> int:
        """Feed `expr` into `socket`; returns its depth."""
        if isinstance(expr, Constant):
            wide = hasattr(socket.default_value, "__len__")
            socket.default_value = (expr.value * 3)[: len(socket.default_value)] if wide else expr.value[0]
            return 0
        result, depth = self._socket(expr)
        self.tree.links.new(result, socket)
        return depth

    def _number(self, expr: Expr) -> int:
        """The same number for the same value (value numbering)."""
        if isinstance(expr, Section):
            return self._number(expr.content)
        if expr not in self._number_of:  # by identity, and kept from being forgotten
            self._number_of[expr] = self._numbers.setdefault(self._key(expr), len(self._numbers))
        return self._number_of[expr]

    def _key(self, expr: Expr) -> tuple:
        if isinstance(expr, Constant):
            return ("constant", expr.value)
        if isinstance(expr, Input):
            return ("input", expr.name)
        if isinstance(expr, Sample):
            return ("sample", expr.picture, self._number(expr.direction))
        if isinstance(expr, Texel):
            return ("texel", expr.picture, self._number(expr.place), expr.width)
        if isinstance(expr, Call):
            return (*self._call_key(expr), expr.output)
        assert isinstance(expr, Operation)
        return (expr.op, *(self._number(argument) for argument in expr.args))

    def _call_key(self, call: Call) -> tuple:
        return ("call", call.calls.formula.title, *(self._number(argument) for argument in call.calls.arguments))

    def making(self, expr: Expr) -> Iterator[None]:
        """Make the nodes of an expression and of what it is made of, arguments first; one between two yields."""
        number = self._number(expr)
        if number in self._sockets or isinstance(expr, Constant):
            return
        outer = self._section
        while isinstance(expr, Section):
            self._section, expr = expr.title, expr.content
        for argument in arguments_of(expr):
            yield from self.making(argument)
        self._sockets[number] = self._make(expr)
        self._section = outer
        yield

    def _socket(self, expr: Expr) -> tuple[bpy.types.NodeSocket, int]:
        for _ in self.making(expr):
            pass
        return self._sockets[self._number(expr)]

    def _make(self, expr: Expr) -> tuple[bpy.types.NodeSocket, int]:
        if isinstance(expr, Input):
            return self._input(expr), 0
        if isinstance(expr, Sample):
            return self._sample(expr)
        if isinstance(expr, Texel):
            node, depth = self._once(("flat", expr.picture, self._number(expr.place)), lambda: self._texel(expr))
            return node.outputs["Color" if expr.width == 3 else "Alpha"], depth
        if isinstance(expr, Call):
            node, depth = self._once(self._call_key(expr), lambda: self._call(expr))
            return node.outputs[expr.output], depth
        assert isinstance(expr, Operation)
        if expr.op in _COMPONENTS:
            node, depth = self._once(("separate", self._number(expr.args[0])), lambda: self._separate(expr.args[0]))
            return node.outputs[_COMPONENTS[expr.op]], depth
        return self._operation(expr)

    def _once(self, key: tuple, make: Callable[[], tuple[bpy.types.Node, int]]) -> tuple[bpy.types.Node, int]:
        """A node that several expressions take outputs of."""
        if key not in self._shared:
            self._shared[key] = make()
        return self._shared[key]

    def _input(self, expr: Input) -> bpy.types.NodeSocket:
        if expr.name in self._surroundings.given:
            return self._surroundings.given[expr.name]()
        if self._source is None:
            self._source = self.tree.nodes.new("NodeGroupInput")
            self.layout.add(self._source, -1, "")
        return self._source.outputs[expr.name]

    def _sample(self, expr: Sample) -> tuple[bpy.types.NodeSocket, int]:
        node = self.tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = self._surroundings.images[expr.picture]
        node.name = node.label = expr.picture
        depth = self.connect(expr.direction, node.inputs["Vector"])
        return node.outputs["Color"], self.layout.add(node, depth, self._section)

    def _texel(self, expr: Texel) -> tuple[bpy.types.Node, int]:
        node = self.tree.nodes.new("ShaderNodeTexImage")
        node.image, node.extension = self._surroundings.images[expr.picture], "CLIP"
        node.name = node.label = expr.picture
        return node, self.layout.add(node, self.connect(expr.place, node.inputs["Vector"]), self._section)

    def _call(self, expr: Call) -> tuple[bpy.types.Node, int]:
        formula = expr.calls.formula
        node = self.tree.nodes.new("ShaderNodeGroup")
        node.node_tree = self._surroundings.group_of(formula)
        node.label = formula.title.partition(",")[0]
        given = zip(formula.inputs, expr.calls.arguments, strict=True)
        depth = max((self.connect(argument, node.inputs[name]) for name, argument in given), default=0)
        return node, self.layout.add(node, depth, self._section)

    def _separate(self, vector: Expr) -> tuple[bpy.types.Node, int]:
        node = self.tree.nodes.new("ShaderNodeSeparateXYZ")
        return node, self.layout.add(node, self.connect(vector, node.inputs[0]), self._section)

    def _operation(self, expr: Operation) -> tuple[bpy.types.NodeSocket, int]:
        targets, args = None, expr.args
        if expr.op is Op.RANDOM:
            node = self.tree.nodes.new("ShaderNodeTexWhiteNoise")
            node.noise_dimensions = "3D"
            depth = self.connect(expr.args[0], node.inputs["Vector"])
            return node.outputs["Color"], self.layout.add(node, depth, self._section)
        if expr.op is Op.COMBINE:
            node = self.tree.nodes.new("ShaderNodeCombineXYZ")
        elif all(part.width == 1 for part in (expr, *expr.args)):
            node = self.tree.nodes.new("ShaderNodeMath")
            node.operation = _MATH[expr.op]
            args = (lift(2.0), *args) if expr.op is Op.EXP2 else args
        elif expr.op in (Op.SQRT, Op.EXP2):  # vectors have but powers, which engines take differently below 0
            node = self.tree.nodes.new("ShaderNodeVectorMath")
            node.operation = "POWER"
            args = (maximum(*args, 0.0), lift(0.5)) if expr.op is Op.SQRT else (lift(2.0), *args)
        else:
            node = self.tree.nodes.new("ShaderNodeVectorMath")
            if expr.op is Op.MULTIPLY and 1 in (part.width for part in expr.args):
                node.operation = "SCALE"
                vector_first = expr.args[0].width == 3
                targets = [node.inputs["Vector"], node.inputs["Scale"]][:: 1 if vector_first else -1]
            else:
                node.operation = _MATH[expr.op]
        targets = targets or [socket for socket in node.inputs if socket.enabled]
        depth = max(self.connect(part, socket) for part, socket in zip(args, targets, strict=True))
        output = next(socket for socket in node.outputs if socket.enabled)
        return output, self.layout.add(node, depth, self._section)
