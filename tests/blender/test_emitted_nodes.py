"""Which nodes and sockets formulas become; what they compute is in `test_node_builder.py`."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender.shade.node_builder import Surroundings, emit
from pcc_addon.core.expression import Expr, Formula, Sample, Section, combine, dot, lift, scalar, vector
from tests.blender.places import check_places, drawn

pytestmark = pytest.mark.usefixtures("scene")

A, B = vector("a"), vector("b")
S, T = scalar("s"), scalar("t")


def group(name: str = "Group") -> bpy.types.ShaderNodeTree:
    return bpy.data.node_groups.new(name, "ShaderNodeTree")


def of_kind(tree: bpy.types.ShaderNodeTree, kind: str) -> list[bpy.types.Node]:
    return [node for node in tree.nodes if node.bl_idname == f"ShaderNode{kind}"]


def sockets(tree: bpy.types.ShaderNodeTree, in_out: str) -> dict[str, str]:
    return {
        i.name: i.bl_socket_idname.removeprefix("NodeSocket") for i in tree.interface.items_tree if i.in_out == in_out
    }


def source_of(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    [link] = socket.links
    return link.from_socket


def test_sockets_have_the_kinds_of_what_goes_in_and_comes_out() -> None:
    tree = group()
    emit(tree, {"Vector": A * S, "Colour": A + B, "Number": dot(A, B)}, Surroundings(colors=frozenset({"Colour"})))
    assert sockets(tree, "INPUT") == {"a": "Vector", "s": "Float", "b": "Vector"}
    assert sockets(tree, "OUTPUT") == {"Vector": "Vector", "Colour": "Color", "Number": "Float"}
    emit(tree, {})
    assert sockets(tree, "INPUT") == sockets(tree, "OUTPUT") == {} and [n.bl_idname for n in tree.nodes] == [
        "NodeGroupOutput"
    ]


def test_sockets_that_fit_keep_what_hangs_on_them() -> None:
    tree = group()
    emit(tree, {"Old": A + S, "Kept": A, "Changed": A})
    tree.interface.new_socket("Kept", in_out="OUTPUT", socket_type="NodeSocketVector")
    user = group("User")
    node, sink = user.nodes.new("ShaderNodeGroup"), user.nodes.new("ShaderNodeVectorMath")
    node.node_tree = tree
    user.links.new(node.outputs["Kept"], sink.inputs[0])
    emit(tree, {"New": S, "Kept": B, "Changed": S})
    assert sockets(tree, "OUTPUT") == {"Kept": "Vector", "New": "Float", "Changed": "Float"}
    assert len([i for i in tree.interface.items_tree if i.in_out == "OUTPUT"]) == 3
    assert source_of(sink.inputs[0]).name == "Kept"


def test_a_picture_is_sampled_once_for_each_direction() -> None:
    images = {name: bpy.data.images.new(name, 4, 2) for name in ("First", "Second")}
    tree = group()
    outputs = {
        "One": Sample("First", A + B), "Again": Sample("First", vector("a") + B), "Turned": Sample("First", A - B),
        "Other": Sample("Second", A + B),
    }  # fmt: skip
    emit(tree, outputs, Surroundings(images=images))
    textures = of_kind(tree, "TexEnvironment")
    found = sorted((node.image.name, node.label, source_of(node.inputs["Vector"]).node.operation) for node in textures)
    assert found == [("First", "First", "ADD"), ("First", "First", "SUBTRACT"), ("Second", "Second", "ADD")]
    sink = next(node for node in tree.nodes if node.bl_idname == "NodeGroupOutput")
    shown = {name: source_of(sink.inputs[name]) for name in outputs}
    assert shown["One"] == shown["Again"] and all(socket.name == "Color" for socket in shown.values())
    assert len({socket.node.name for socket in shown.values()}) == 3
    assert textures[0].name.startswith("First")


def test_a_formula_that_is_called_is_one_group_node_for_equal_arguments() -> None:
    double, inner = Formula("Double, or half", {"Twice": S * 2.0, "Half": S / 2.0}), group("Inner")
    inner.interface.new_socket("s", in_out="INPUT", socket_type="NodeSocketFloat")
    for name in ("Twice", "Half"):
        inner.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketFloat")
    call, other = double(s=T + 1.0), double(s=T)
    outputs = {"A": call["Twice"], "B": call["Half"], "C": double(s=T + 1.0)["Half"], "D": other["Half"]}
    tree = group()
    emit(tree, outputs, Surroundings(group_of=lambda _: inner))
    assert sorted(node.label for node in of_kind(tree, "Group")) == ["Double", "Double"]
    sink = next(node for node in tree.nodes if node.bl_idname == "NodeGroupOutput")
    shown = {name: source_of(sink.inputs[name]) for name in outputs}
    assert shown["A"].node == shown["B"].node == shown["C"].node != shown["D"].node
    assert [shown[name].name for name in "ABCD"] == ["Twice", "Half", "Half", "Half"]
    assert source_of(shown["A"].node.inputs["s"]).node.operation == "ADD"
    assert all(node.node_tree == inner for node in of_kind(tree, "Group"))
    with pytest.raises(LookupError, match="no node group is known for formula 'Double, or half'"):
        emit(group(), outputs)


def test_inputs_that_are_given_are_made_once_and_are_no_sockets() -> None:
    tree, made = group(), []

    def give() -> bpy.types.NodeSocket:
        made.append(tree.nodes.new("ShaderNodeNewGeometry"))
        return made[-1].outputs["Position"]

    emit(tree, {"One": A + B, "Two": vector("a") - B}, Surroundings({"a": give}))
    assert len(made) == 1 and sockets(tree, "INPUT") == {"b": "Vector"}
    for node in of_kind(tree, "VectorMath"):
        assert source_of(node.inputs[0]).node == made[0] and source_of(node.inputs[1]).name == "b"


def test_components_share_a_node_and_constants_stand_in_sockets() -> None:
    tree = group()
    emit(tree, {"Turned": combine(A.y, A.z, A.x), "Sum": A + 2.5, "Product": A * (1.0, 2.0, 3.0), "Number": lift(4.0)})
    [separate], [join] = of_kind(tree, "SeparateXYZ"), of_kind(tree, "CombineXYZ")
    assert [source_of(socket).name for socket in join.inputs] == ["Y", "Z", "X"] and separate.inputs[0].is_linked
    plain = {node.operation: tuple(node.inputs[1].default_value) for node in of_kind(tree, "VectorMath")}
    assert plain == {"ADD": (2.5, 2.5, 2.5), "MULTIPLY": (1.0, 2.0, 3.0)}
    assert (
        next(node for node in tree.nodes if node.bl_idname == "NodeGroupOutput").inputs["Number"].default_value == 4.0
    )


def test_an_expression_used_twice_is_looked_at_once() -> None:
    """Otherwise this takes 2⁴⁰ looks."""
    doubled: Expr = S
    for _ in range(40):
        doubled = doubled + doubled
    tree = group()
    emit(tree, {"Result": doubled})
    assert len(of_kind(tree, "Math")) == 40


def test_nodes_stand_behind_what_they_need_and_sections_in_frames() -> None:
    tree = group()
    outer = Section("Outer", (Section("Inner", A + B) * S) - 1.0)
    emit(tree, {"Result": outer.content * 1.0 + Section("Other", B * T), "Outer": outer})
    places = {node.location_absolute.x for node in of_kind(tree, "VectorMath")}
    [given] = [node for node in tree.nodes if node.bl_idname == "NodeGroupInput"]
    assert given.location_absolute.x + given.width < min(places) == 0.0
    check_places(drawn(tree))
    assert given.parent is None, "what is in no section is in no frame"
    framed = {(node.operation, node.parent.label if node.parent else "") for node in of_kind(tree, "VectorMath")}
    assert ("ADD", "Inner") in framed and ("SCALE", "Other") in framed and ("MULTIPLY_ADD", "") not in framed
