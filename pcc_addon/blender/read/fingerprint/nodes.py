"""Node trees as digests, from the outputs back: what does not reach one does not count, and names do not.

A node's digest is made of its kind, its settings and, for each input, its value or the digest of what feeds it. The
inside of a group is read once, whoever uses it: what reaches its outputs from its inputs is put together outside.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ... import marks
from ..nodes import group_output
from .digests import COLOR, EVALUATED, FRAME, INDEX, MATERIAL_INDEX, NOTHING, RANDOM, Found, Read, digest, plain
from .pictures import PLAYED, image
from .properties import Refer, named, settings

_BOOKKEEPING = frozenset(p.identifier for p in bpy.types.Node.bl_rna.properties) | {"image_user", "node_tree"}
# Node types whose output has a value that is set on the socket itself.
_VALUES = {"ShaderNodeValue", "ShaderNodeRGB", "ShaderNodeNormal"}
_OF_OBJECTS: dict[str, Read] = {
    "Color": COLOR,
    "Alpha": COLOR,
    "Object Index": INDEX,
    "Material Index": MATERIAL_INDEX,
    "Random": RANDOM,
}
_NAMES = {
    "ShaderNodeUVMap": "uv_map",
    "ShaderNodeNormalMap": "uv_map",
    "ShaderNodeTangent": "uv_map",
    "ShaderNodeVertexColor": "layer_name",
}
_FOLLOWING = {
    "GeometryNodeInputSceneTime": EVALUATED,
    "GeometryNodeSimulationOutput": FRAME,
    "GeometryNodeBake": FRAME,
}
# Settings that what is open or chosen in an editor is called.
_OPEN = frozenset(
    {"active_index", "active_item", "active_input_index", "active_generation_index", "active_main_index"}
    | {"inspection_index", "is_active_output", "target", "paired_output"}
)


class Trees:
    """The node trees of a file, each read once."""

    def __init__(self, refer: Refer, frame: int) -> None:
        """Refer: what stands for data blocks that nodes name; frame: of the scene, for sequences of images."""
        self._refer, self._frame = refer, frame
        self._known: dict[int, _Tree] = {}
        self._images: dict[int, bytes] = {}

    def reaching(self, output: bpy.types.Node) -> Found:
        """What reaches the inputs of an output node."""
        return self._of(output.id_data).reaching(output)

    def group(self, tree: bpy.types.NodeTree) -> Found:
        """What a group gives from all its outputs."""
        output = group_output(tree)
        return NOTHING if output is None else self.reaching(output)

    def given(self, tree: bpy.types.NodeTree, identifier: str) -> Found:
        """What a group gives from one output."""
        output = group_output(tree)
        sockets = [socket for socket in output.inputs if socket.identifier == identifier] if output else []
        return self._of(tree).fed(sockets[0]) if sockets else NOTHING

    def image(self, picture: bpy.types.Image, user: bpy.types.ImageUser | None = None) -> bytes:
        """`pictures.image`, of still ones once."""
        if picture.source in PLAYED:
            return image(picture, user, self._frame)
        key = picture.as_pointer()
        if key not in self._images:
            self._images[key] = image(picture)
        return self._images[key]

    def refer(self, item: bpy.types.ID, reads: set[Read]) -> bytes:
        return self._refer(item, reads)

    def _of(self, tree: bpy.types.NodeTree) -> _Tree:
        key = tree.as_pointer()
        if key not in self._known:
            self._known[key] = _Tree(tree, self)
        return self._known[key]


class _Tree:
    """A tree whose links have been sorted by the inputs that they end in; our own nodes and their links left out."""

    def __init__(self, tree: bpy.types.NodeTree, trees: Trees) -> None:
        self._trees = trees
        self._feeding: dict[int, list[tuple[bpy.types.Node, bpy.types.NodeSocket]]] = {}
        self._begins: dict[int, list[bpy.types.Node]] = {}  # by a zone's last node its first ones
        self._whole: dict[int, Found] = {}  # by node
        self._is_ours = {node.as_pointer() for node in tree.nodes if marks.role(node)}
        for link in tree.links:
            source = link.from_node
            if not link.is_muted and link.is_valid and source.as_pointer() not in self._is_ours:
                self._feeding.setdefault(link.to_socket.as_pointer(), []).append((source, link.from_socket))
        for node in tree.nodes:
            end = getattr(node, "paired_output", None)
            if end is not None:
                self._begins.setdefault(end.as_pointer(), []).append(node)

    def reaching(self, output: bpy.types.Node) -> Found:
        self._read([output])
        return self._whole[output.as_pointer()]

    def fed(self, socket: bpy.types.NodeSocket) -> Found:
        """What feeds one input of an output node."""
        self._read(source for source, _ in self._feeding.get(socket.as_pointer(), ()))
        return self._input(socket)

    def _read(self, nodes: Iterable[bpy.types.Node]) -> None:
        """Read nodes after all that feed them; a long chain of nodes would be too deep for functions in functions."""
        waiting = [(node, False) for node in nodes]
        begun = set()
        while waiting:
            node, is_fed = waiting.pop()
            key = node.as_pointer()
            if key in self._whole:
                continue
            if is_fed:
                self._whole[key] = self._node(node)
            elif key not in begun:
                begun.add(key)
                waiting.append((node, True))
                waiting += [(begin, False) for begin in self._begins.get(key, ())]
                for socket in node.inputs:
                    waiting += [(source, False) for source, _ in self._feeding.get(socket.as_pointer(), ())]

    def _node(self, node: bpy.types.Node) -> Found:
        """What a node makes of its inputs, as far as all its outputs share it."""
        kind = node.bl_idname
        if node.mute or kind in {"NodeReroute", "NodeGroupInput"} or (_has_inside(node) and not is_by_hand(node)):
            return NOTHING  # each output for itself
        reads: set[Read] = set(_reads_of(node))
        parts = ["by hand" if is_by_hand(node) else kind]
        if not is_by_hand(node):
            parts.append(self._settings(node, reads))
        inputs: frozenset[str] = frozenset()
        for each in (node, *self._begins.get(node.as_pointer(), ())):
            for socket in each.inputs:
                parts.append(socket.identifier)
                if socket.as_pointer() not in self._feeding:
                    parts.append(_value(socket, self._trees, reads))
                    continue
                found = self._input(socket)
                parts += ["fed", found.digest]
                reads |= found.reads
                inputs |= found.inputs
        return Found(digest(*parts), frozenset(reads), inputs)

    def _settings(self, node: bpy.types.Node, reads: set[Read]) -> bytes:
        kind = node.bl_idname
        without = _BOOKKEEPING | _OPEN
        parts = []
        if kind == "ShaderNodeTexCoord":  # where an object is, whatever it is
            without |= {"object"}
            parts.append(plain(node.object.matrix_world if node.object else None))
        picture = getattr(node, "image", None)
        if isinstance(picture, bpy.types.Image):
            without |= {"image"}
            user = getattr(node, "image_user", None)
            parts.append(self._trees.image(picture, user))
            if isinstance(user, bpy.types.ImageUser):
                parts.append(named(user, ("multilayer_layer", "multilayer_pass", "multilayer_view")))
        if kind in _VALUES:
            parts += [_value(socket, self._trees, reads) for socket in node.outputs]
        parts.append(settings(node, self._trees.refer, reads, without))
        return digest(*parts)

    def _output(self, node: bpy.types.Node, socket: bpy.types.NodeSocket) -> Found:
        kind = node.bl_idname
        if node.mute:
            passed = [link.from_socket for link in node.internal_links if link.to_socket == socket]
            return self._input(passed[0]) if passed else NOTHING
        if kind == "NodeReroute":
            return self._input(node.inputs[0])
        if kind == "NodeGroupInput":
            return Found(digest("group input", socket.identifier), frozenset(), frozenset({socket.identifier}))
        if _has_inside(node) and not is_by_hand(node):
            return self._group(node, socket)
        whole = self._whole.get(node.as_pointer(), NOTHING)  # nothing where a shader feeds itself
        name = socket.name if is_by_hand(node) else socket.identifier
        reads = {_OF_OBJECTS[name]} if kind == "ShaderNodeObjectInfo" and name in _OF_OBJECTS else set()
        return Found(digest(whole.digest, name), whole.reads | reads, whole.inputs)

    def _group(self, node: bpy.types.Node, socket: bpy.types.NodeSocket) -> Found:
        if node.node_tree is None:
            return NOTHING
        inside = self._trees.given(node.node_tree, socket.identifier)
        parts, reads, inputs = [inside.digest], inside.reads, frozenset()
        for given in node.inputs:
            if given.identifier in inside.inputs:
                found = self._input(given)
                parts.append(digest(given.identifier, found.digest))
                reads |= found.reads
                inputs |= found.inputs
        return Found(digest("group", *parts), reads, inputs)

    def _input(self, socket: bpy.types.NodeSocket) -> Found:
        sources = self._feeding.get(socket.as_pointer())
        if not sources:
            reads: set[Read] = set()
            value = _value(socket, self._trees, reads)
            return Found(digest("value", value), frozenset(reads))
        found = [self._output(node, source) for node, source in sources]
        if len(found) == 1:
            return found[0]
        return Found(
            digest("several", *(each.digest for each in found)),
            frozenset().union(*(each.reads for each in found)),
            frozenset().union(*(each.inputs for each in found)),
        )


def _has_inside(node: bpy.types.Node) -> bool:
    return hasattr(node, "node_tree")


def is_by_hand(node: bpy.types.Node) -> bool:
    """Whether captures see a group black, whatever is in it."""
    inner = getattr(node, "node_tree", None)
    return inner is not None and marks.role(inner) == marks.BY_HAND


def _value(socket: bpy.types.NodeSocket, trees: Trees, reads: set[Read]) -> bytes:
    value = getattr(socket, "default_value", None)
    if isinstance(value, bpy.types.ID):
        return trees.refer(value, reads)
    if isinstance(value, str) and value and socket.type == "STRING":
        reads.add(("attribute", "GEOMETRY", value))
    return plain(value).encode()


def _reads_of(node: bpy.types.Node) -> Iterable[Read]:
    kind = node.bl_idname
    if kind == "ShaderNodeAttribute":
        yield ("attribute", node.attribute_type, node.attribute_name)
    if kind in _NAMES and getattr(node, _NAMES[kind]):
        yield ("attribute", "GEOMETRY", getattr(node, _NAMES[kind]))
    if kind in _FOLLOWING:
        yield _FOLLOWING[kind]
