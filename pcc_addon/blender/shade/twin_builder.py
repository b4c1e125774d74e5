"""Builds the twin of one node tree, surface by surface, as it is ordered."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import bpy

from ...core.effects import choice
from ...core.effects.normal import VALID_NORMAL
from ...core.effects.roughness import level_name, mixed_formula, neighbours
from ...core.expression import Formula
from ...core.plan import SurfacePlan
from .. import marks
from ..read.nodes import Scope, group_output, is_given, source
from . import groups
from .twin_order import ShownProbe, TwinOrder

PROBE, GLOW = "probe", "glow"  # roles of a twin's nodes that are looked for later
VALUES = "values"  # note on a twin's node: which of its inputs repeat which of the original's
OF = "of"  # note on a twin's node: the name of the original
_FROM_THE_PROBE = {"Base Color", "Metallic", "Specular IOR Level"}  # inputs of the diffuse part that are not copied
_ShaderOf = Callable[[bpy.types.Node, bpy.types.Node, SurfacePlan, int], bpy.types.NodeSocket]
_ROW = 320.0  # between the probes of one surface
_DROP = -700.0  # how far below the original its twin is drawn


class TwinBuilder:
    """Builds the twins of one node tree."""

    def __init__(self, tree: bpy.types.ShaderNodeTree, scope: Scope, order: TwinOrder, material: str) -> None:
        self.tree, self.scope, self.order, self.material = tree, scope, order, material
        self._twins: dict[tuple[int, str], bpy.types.NodeSocket] = {}
        self._geometry: bpy.types.Node | None = None
        self._normals: dict[str, bpy.types.NodeSocket] = {}
        self._frame: bpy.types.Node | None = None

    def new(self, kind: str, beside: bpy.types.Node, right: float = 0.0, down: float = 0.0) -> bpy.types.Node:
        """A node of ours, drawn below `beside`."""
        node = self.tree.nodes.new(kind)
        node.select = False
        marks.tag(node, "twin")
        place = beside.location_absolute if hasattr(beside, "location_absolute") else beside.location
        node.location = (place.x + right, place.y + _DROP - down)
        node.parent = self._framed()
        return node

    def _framed(self) -> bpy.types.Node:
        """The frame around all that is ours in the tree."""
        if self._frame is None:
            self._frame = self.tree.nodes.new("NodeFrame")
            self._frame.select = False
            self._frame.name = self._frame.label = "PCC Parallax Probes"
            marks.tag(self._frame, "frame")
        return self._frame

    def keep_probes(self, beside: bpy.types.Node) -> None:
        """Remember the probes where no surface can show them at present."""
        for row, shown in enumerate(self.order.probes):
            probe = self.new("ShaderNodeGroup", beside, right=-240.0, down=_ROW * row)
            probe.node_tree = shown.group
            marks.tag(probe, PROBE)

    def twin(self, socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
        """The output that does for a twin what the source of `socket` does for the original."""
        feeding = source(socket)
        if feeding is None or feeding.type != "SHADER":
            return feeding
        key = (feeding.node.as_pointer(), feeding.identifier)
        if key not in self._twins:
            self._twins[key] = self._twin_of(feeding)
        return self._twins[key]

    def _twin_of(self, feeding: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        node = feeding.node
        if node.mute:
            return feeding
        surface = self.order.surfaces.get(self.scope.path(node))
        if surface is not None:
            return self._surface(node, surface)
        is_group = node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None
        if not is_group and not any(s.type == "SHADER" for s in node.inputs):
            return feeding
        copy = self.new(node.bl_idname, node)
        copy.name = f"PCC {node.name}"
        if is_group:
            copy.node_tree = self._group(node)
        else:
            _copy_settings(node, copy)
        self._fill(node, copy)
        return copy.outputs[list(node.outputs).index(feeding)]

    def _fill(self, node: bpy.types.Node, copy: bpy.types.Node, without: set[str] = frozenset()) -> None:
        """Feed the inputs of `copy` as those of `node` are fed, shaders by their twins."""
        for old, new in zip(node.inputs, copy.inputs, strict=True):
            if old.name in without:
                continue
            if old.type == "SHADER":
                feeding = self.twin(old)
                if feeding is not None:
                    self.tree.links.new(feeding, new)
            elif hasattr(old, "default_value") or source(old) is not None:
                self._feed(old, new)

    def _feed(self, old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
        """Let an input of the twin read what an input of the original reads, or repeat its value."""
        feeding = source(old)
        if feeding is not None:
            self.tree.links.new(feeding, new)
            return
        repeat_value(old, new)
        marks.note(new.node, OF, old.node.name)
        marks.note(new.node, VALUES, {**dict(marks.noted(new.node, VALUES, {})), new.identifier: old.identifier})

    def _group(self, node: bpy.types.ShaderNodeGroup) -> bpy.types.ShaderNodeTree:
        """A copy of a group's tree whose shaders are twins."""
        inside = self.scope.inside(node)
        tree = node.node_tree.copy()
        tree.name = f"PCC {node.node_tree.name}, {self.material}"
        marks.tag(tree, "copy")
        sink = group_output(tree)
        if sink is None:
            return tree
        builder = TwinBuilder(tree, Scope(tree, inside.nodes), self.order, self.material)
        for socket in [s for s in sink.inputs if s.type == "SHADER"]:
            feeding = builder.twin(socket)
            if feeding is not None:
                tree.links.new(feeding, socket)
        return tree

    def _surface(self, node: bpy.types.Node, plan: SurfacePlan) -> bpy.types.NodeSocket:
        """A surface without its specular lobe, plus what the probes reflect in its place."""
        lit = self._lit(node, plan, 0)
        base = self._base(node, lit, plan) if plan.effects.leaves_base else None
        if not self.order.probes:
            return base or self._nothing(node)
        if plan.layered:
            reflection, coverage = self._reflections(node, plan, lit, self._under_layers)
            seen = self._mix(node, 680.0, 0, 1.0, base, reflection)
            marks.tag(seen.node, GLOW)
        else:
            seen, coverage = self._reflections(node, plan, lit, self._glow)
            if base is not None:
                total = self.new("ShaderNodeAddShader", node, right=680.0)
                self.tree.links.new(base, total.inputs[0])
                self.tree.links.new(seen, total.inputs[1])
                seen = total.outputs[0]
        return self._over_own_lobe(node, plan, seen, coverage)

    def _nothing(self, node: bpy.types.Node) -> bpy.types.NodeSocket:
        """A shader that is black."""
        black = self.new("ShaderNodeEmission", node)
        black.inputs["Strength"].default_value = 0.0
        return black.outputs[0]

    def _base(
        self, node: bpy.types.Node, lit: bpy.types.Node, plan: SurfacePlan, *, layers: bool = False
    ) -> bpy.types.NodeSocket:
        """The shader of what a Principled surface has beside its lobe; without coat, which shows in no capture."""
        base = self.new(node.bl_idname, node)
        base.name = f"PCC {node.name}"
        _copy_settings(node, base)
        without = _FROM_THE_PROBE if layers or not plan.layered else _FROM_THE_PROBE | {"Coat Weight"}
        self._fill(node, base, without=without)
        for name in without - {"Base Color"}:
            base.inputs[name].default_value = 0.0
        self.tree.links.new(lit.outputs["Diffuse Color"], base.inputs["Base Color"])
        return base.outputs[0]

    def _glow(self, node: bpy.types.Node, lit: bpy.types.Node, plan: SurfacePlan, row: int) -> bpy.types.NodeSocket:
        """The shader of a reflection with nothing over it."""
        glow = self.new("ShaderNodeEmission", node, right=280.0, down=_ROW * row)
        marks.tag(glow, GLOW)
        self.tree.links.new(lit.outputs["Reflection"], glow.inputs["Color"])
        if "Alpha" in node.inputs:
            self._feed(node.inputs["Alpha"], glow.inputs["Strength"])
        return glow.outputs[0]

    def _under_layers(
        self, node: bpy.types.Node, lit: bpy.types.Node, plan: SurfacePlan, row: int
    ) -> bpy.types.NodeSocket:
        """The shader of a whole surface that emits the reflection: coat and sheen dim it as they dim its own light."""
        whole = self._base(node, lit, plan, layers=True)
        add = self.new("ShaderNodeVectorMath", node, right=-240.0, down=_ROW * row + 200.0)
        add.operation = "MULTIPLY_ADD"
        self._feed(node.inputs["Emission Color"], add.inputs[0])
        self._feed(node.inputs["Emission Strength"], add.inputs[1])
        self.tree.links.new(lit.outputs["Reflection"], add.inputs[2])
        self.tree.links.new(add.outputs[0], whole.node.inputs["Emission Color"])
        for link in whole.node.inputs["Emission Strength"].links:
            self.tree.links.remove(link)
        _forget_value(whole.node, "Emission Strength")
        whole.node.inputs["Emission Strength"].default_value = 1.0
        return whole

    def _mix(
        self,
        node: bpy.types.Node,
        right: float,
        row: int,
        share: bpy.types.NodeSocket | float,
        first: bpy.types.NodeSocket,
        second: bpy.types.NodeSocket,
    ) -> bpy.types.NodeSocket:
        """The second shader over the first; muted, it is the first."""
        mix = self.new("ShaderNodeMixShader", node, right=right, down=_ROW * row)
        if isinstance(share, float):
            mix.inputs[0].default_value = share
        else:
            self.tree.links.new(share, mix.inputs[0])
        self.tree.links.new(first, mix.inputs[1])
        self.tree.links.new(second, mix.inputs[2])
        return mix.outputs[0]

    def _over_own_lobe(
        self, node: bpy.types.Node, plan: SurfacePlan, seen: bpy.types.NodeSocket, coverage: bpy.types.NodeSocket | None
    ) -> bpy.types.NodeSocket:
        """The probes' reflection where they cover the surface, the original elsewhere and for diffuse rays.

        A path from a diffuse wall that finds a lamp's picture by chance is a firefly; with the original it is the
        caustic that the renderer filters and clamps as ever. Walls then are lit as without the probe.
        """
        path = self.new("ShaderNodeLightPath", node, right=680.0, down=200.0)
        share = path.outputs["Is Diffuse Ray"]
        if coverage is not None or plan.handed_over is not None:
            own = self._call(choice.own_share(plan.handed_over), node, 880.0, 0, {"Diffuse Ray": share})
            if coverage is None:
                own.inputs["Coverage"].default_value = 1.0
            else:
                self.tree.links.new(coverage, own.inputs["Coverage"])
            if plan.handed_over is not None:
                self._feed(node.inputs["Roughness"], own.inputs["Roughness"])
            share = own.outputs["Share"]
        mixed = self._mix(node, 1080.0, 0, share, seen, node.outputs[0])
        marks.tag(mixed.node, GLOW)
        return mixed

    def _lit(self, node: bpy.types.Node, plan: SurfacePlan, row: int) -> bpy.types.Node:
        """The group node that makes a surface's reflection of a radiance."""
        lit = self.new("ShaderNodeGroup", node, right=-240.0, down=_ROW * row)
        lit.node_tree = groups.surface_group(plan.effects)
        lit.name, lit.label = f"PCC Surface of {node.name}", "Reflectance"
        for socket in lit.inputs:
            if socket.name == "Normal":
                self.tree.links.new(self._normal(node), socket)
            elif socket.name == "Incoming":
                self.tree.links.new(self._geometry_of(node).outputs["Incoming"], socket)
            elif socket.name != "Radiance":
                self._feed(node.inputs[socket.name], socket)
        return lit

    def _reflections(
        self, node: bpy.types.Node, plan: SurfacePlan, lit: bpy.types.Node, shader_of: _ShaderOf
    ) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket | None]:
        """The shader that emits what the probes reflect, each where it is the right one, and how much they cover.

        A Mix Shader is skipped by Cycles on the side that has no share, so only the probes of the place are read.
        """
        shader = distance = coverage = None
        for row, shown in enumerate(self.order.probes):
            probe = self.new("ShaderNodeGroup", node, right=-760.0, down=_ROW * row)
            probe.node_tree = shown.group
            probe.name, probe.label = f"PCC Probe of {node.name}", shown.group.name
            marks.tag(probe, PROBE)
            self.tree.links.new(self._normal(node), probe.inputs["Normal"])
            if row > 0:
                lit = self._lit(node, plan, row)
            self.tree.links.new(self._radiance(node, plan, shown, probe, row), lit.inputs["Radiance"])
            one = shader_of(node, lit, plan, row)
            weight = probe.outputs.get("Weight")
            if shader is None:
                shader, coverage = one, weight
                if len(self.order.probes) > 1:
                    start = self._call(choice.START, node, -500.0, 0, {"Depth": probe.outputs["Depth"]})
                    distance = start.outputs["Distance"]
                continue
            known = {"Depth": probe.outputs["Depth"], "Distance": distance, "Coverage": coverage, "Weight": weight}
            given = {name: socket for name, socket in known.items() if socket is not None}
            step = self._call(choice.NEXT, node, -500.0, row, given)
            step.inputs["Fade"].default_value = shown.fade
            for name in known.keys() - given.keys():  # a probe that has all of what is its share
                step.inputs[name].default_value = 1.0
            shader = self._mix(node, 480.0, row, step.outputs["Share"], shader, one)
            coverage, distance = step.outputs["Coverage"], step.outputs["Distance"]
        return shader, coverage

    def _radiance(
        self, node: bpy.types.Node, plan: SurfacePlan, shown: ShownProbe, probe: bpy.types.Node, row: int
    ) -> bpy.types.NodeSocket:
        """What a probe shows at the surface's roughness."""
        levels = neighbours(shown.rungs, *plan.roughness)
        if len(levels) == 1:
            return probe.outputs[level_name(levels[0])]
        formula = mixed_formula(tuple(shown.rungs[k] for k in levels))
        given = {level_name(i): probe.outputs[level_name(k)] for i, k in enumerate(levels)}
        mixed = self._call(formula, node, -500.0, row, given)
        self._feed(node.inputs["Roughness"], mixed.inputs["Roughness"])
        return mixed.outputs["Radiance"]

    def _call(
        self,
        formula: Formula,
        node: bpy.types.Node,
        right: float,
        row: int,
        given: Mapping[str, bpy.types.NodeSocket],
    ) -> bpy.types.Node:
        """A node of a formula's group, some of its inputs linked."""
        call = self.new("ShaderNodeGroup", node, right=right, down=_ROW * row)
        call.node_tree = groups.formula_group(formula)
        call.label = formula.title
        for name, socket in given.items():
            self.tree.links.new(socket, call.inputs[name])
        return call

    def _normal(self, node: bpy.types.Node) -> bpy.types.NodeSocket:
        """The normal that a surface mirrors by."""
        if node.name not in self._normals:
            self._normals[node.name] = self._made_normal(node)
        return self._normals[node.name]

    def _made_normal(self, node: bpy.types.Node) -> bpy.types.NodeSocket:
        geometry = self._geometry_of(node)
        if not is_given(node.inputs["Normal"], self.scope):
            return geometry.outputs["Normal"]
        feeding = source(node.inputs["Normal"])
        if not self.order.surfaces[self.scope.path(node)].bends_normals:
            return feeding
        known = {
            "Normal": feeding,
            "True Normal": geometry.outputs["True Normal"],
            "Incoming": geometry.outputs["Incoming"],
        }
        return self._call(VALID_NORMAL, node, -1240.0, 0, known).outputs["Normal"]

    def _geometry_of(self, node: bpy.types.Node) -> bpy.types.Node:
        if self._geometry is None:
            self._geometry = self.new("ShaderNodeNewGeometry", node, right=-1480.0)
        return self._geometry


def repeat_value(old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
    """Give an input the value of another, which may be of another width; nothing happens where it has it already."""
    value = old.default_value
    if hasattr(new.default_value, "__len__"):
        wide = len(new.default_value)
        value = tuple(value)[:wide] if hasattr(value, "__len__") else (value,) * wide
        if tuple(new.default_value) != value:
            new.default_value = value
    elif new.default_value != value:
        new.default_value = value


def _forget_value(node: bpy.types.Node, name: str) -> None:
    """Let an input of a twin no longer repeat that of the original."""
    values = dict(marks.noted(node, VALUES, {}))
    values.pop(node.inputs[name].identifier, None)
    marks.note(node, VALUES, values)


def _copy_settings(node: bpy.types.Node, copy: bpy.types.Node) -> None:
    """Copy what is special to the node's type, such as a distribution; not its name or place."""
    common = {p.identifier for p in bpy.types.Node.bl_rna.properties}
    for prop in node.bl_rna.properties:
        if prop.identifier not in common and not prop.is_readonly:
            setattr(copy, prop.identifier, getattr(node, prop.identifier))
