"""Builds the twin of one surface: its BSDF without the lobes that probes show, plus what they show instead.

From left to right: the rays that leave the surface, a probe's radiance along each, the share of each probe, how much
of the radiance reaches the eye, and the shader that emits it, over or beside the user's own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import bpy

from ...core.effects import choice
from ...core.effects.normal import VALID_NORMAL
from ...core.effects.roughness import level_name
from ...core.effects.shading import MATT
from ...core.effects.surface import Ray
from ...core.expression import Formula
from ...core.surface_plan import SurfacePlan
from .. import marks
from ..read.nodes import is_given, source
from . import groups
from .sketch import Sketch
from .twin_order import ShownProbe

PROBE, GLOW, CAPTURED = "probe", "glow", "captured"
"""Roles of a twin's nodes that are looked for later: its probes; what emits their reflection and is muted in captures;
what is told by an input "Captured" that there is one."""
_FROM_THE_PROBE = frozenset(
    {"Base Color", "Metallic", "Specular IOR Level", "Transmission Weight", "Thin Film Thickness"}
)  # not copied into the diffuse part
_EMISSION = frozenset({"Emission Color", "Emission Strength"})
_OF_THE_NODE = frozenset(
    {"IOR", "Roughness", "Metallic", "Anisotropic Rotation", "Rotation"}
)  # what rays ask of the user's node
_ShaderOf = Callable[[bpy.types.Node, int], bpy.types.NodeSocket]


class SurfaceBuilder:
    """Builds the twin of one BSDF."""

    def __init__(self, sketch: Sketch, node: bpy.types.Node, plan: SurfacePlan, probes: Sequence[ShownProbe]) -> None:
        self.sketch, self.node, self.plan, self.probes = sketch, node, plan, probes
        self._ways: dict[int, bpy.types.Node] = {}
        self._normal_output: bpy.types.NodeSocket | None = None
        self._distances: dict[tuple[bpy.types.NodeSocket, ...], bpy.types.NodeSocket] = {}

    def build(self) -> bpy.types.NodeSocket:
        """The shader's output; without probes what captures see of the surface, as they need it."""
        if not self.probes:
            return self._mix(1080.0, 0, self._diffuse_depth(), self._captured(), self.node.outputs[0])
        lit = self._lit(0)
        if self.plan.layered:
            reflection, coverage = self._reflections(lit, self._under_layers)
            seen = self._instead(self._base(lit), reflection)
        elif self.plan.effects.leaves_base:
            base = self._base(lit)
            seen, coverage = self._reflections(lit, self._glow)
            total = self._new("ShaderNodeAddShader", right=680.0)
            self.sketch.link(base, total.inputs[0])
            self.sketch.link(seen, total.inputs[1])
            seen = total.outputs[0]
        else:
            seen, coverage = self._reflections(lit, self._glow)
            if not self.plan.captured_whole:
                seen = self._instead(self._matt(), seen)
        return self._over_own_lobe(seen, coverage)

    def _captured(self) -> bpy.types.NodeSocket:
        """What captures see of a surface: its diffuse part, and matt in its colour what has none."""
        if not self.plan.effects.leaves_base:
            return self._matt()
        lit = self._lit(0)
        if "Captured" in lit.inputs:
            lit.inputs["Captured"].default_value = 1.0
        return self._base(lit)

    def _instead(self, captured: bpy.types.NodeSocket, seen: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """A shader, in place of which captures see another."""
        mixed = self._mix(680.0, 0, 1.0, captured, seen)
        marks.tag(mixed.node, GLOW)
        return mixed

    def _matt(self) -> bpy.types.NodeSocket:
        """What captures see of a surface that is nothing but a lobe: its colour, matt."""
        matt = self._new("ShaderNodeBsdfDiffuse")
        dim = self._new("ShaderNodeVectorMath", right=-240.0, row=0.625)
        dim.operation = "SCALE"
        self.sketch.repeat(self.node.inputs["Color" if "Color" in self.node.inputs else "Base Color"], dim.inputs[0])
        dim.inputs["Scale"].default_value = MATT
        self.sketch.link(dim.outputs[0], matt.inputs["Color"])
        self.sketch.link(self._normal(), matt.inputs["Normal"])
        return matt.outputs[0]

    def _base(self, lit: bpy.types.Node, row: int = 0, *, layers: bool = False) -> bpy.types.NodeSocket:
        """The shader of what a Principled surface has beside its lobe; without coat, which shows in no capture."""
        base = self.sketch.copy(self.node, row)
        dark = _FROM_THE_PROBE if layers or not self.plan.layered else _FROM_THE_PROBE | {"Coat Weight"}
        self.sketch.repeat_all(self.node, base, dark | _EMISSION if layers else dark)
        for name in dark - {"Base Color"}:
            base.inputs[name].default_value = 0.0
        self.sketch.link(lit.outputs["Diffuse Color"], base.inputs["Base Color"])
        return base.outputs[0]

    def _glow(self, lit: bpy.types.Node, row: int) -> bpy.types.NodeSocket:
        """The shader of a reflection with nothing over it."""
        glow = self._new("ShaderNodeEmission", right=280.0, row=row)
        marks.tag(glow, GLOW)
        self.sketch.link(lit.outputs["Reflection"], glow.inputs["Color"])
        if "Alpha" in self.node.inputs:
            self.sketch.repeat(self.node.inputs["Alpha"], glow.inputs["Strength"])
        return glow.outputs[0]

    def _under_layers(self, lit: bpy.types.Node, row: int) -> bpy.types.NodeSocket:
        """The shader of a whole surface that emits the reflection: coat and sheen dim it as they dim its own light."""
        whole = self._base(lit, row, layers=True)
        add = self._new("ShaderNodeVectorMath", right=-240.0, row=row)
        add.operation = "MULTIPLY_ADD"
        self.sketch.repeat(self.node.inputs["Emission Color"], add.inputs[0])
        self.sketch.repeat(self.node.inputs["Emission Strength"], add.inputs[1])
        self.sketch.link(lit.outputs["Reflection"], add.inputs[2])
        self.sketch.link(add.outputs[0], whole.node.inputs["Emission Color"])
        whole.node.inputs["Emission Strength"].default_value = 1.0
        return whole

    def _mix(
        self,
        right: float,
        row: int,
        share: bpy.types.NodeSocket | float,
        first: bpy.types.NodeSocket,
        second: bpy.types.NodeSocket,
    ) -> bpy.types.NodeSocket:
        """The second shader over the first; muted, it is the first."""
        mix = self._new("ShaderNodeMixShader", right=right, row=row)
        self.sketch.give(mix.inputs[0], share)
        self.sketch.link(first, mix.inputs[1])
        self.sketch.link(second, mix.inputs[2])
        return mix.outputs[0]

    def _over_own_lobe(self, seen: bpy.types.NodeSocket, coverage: bpy.types.NodeSocket | None) -> bpy.types.NodeSocket:
        """The probes' reflection where they cover the surface, the original elsewhere and behind diffuse surfaces.

        A path from a diffuse wall that finds a lamp's picture by chance is a firefly, over other mirrors too; with the
        original it is the caustic that the renderer filters and clamps as ever. Walls then are lit as without the
        probe.
        """
        limit, own, whole = self.plan.handed_over, self.node.outputs[0], self.plan.captured_whole
        share = self._diffuse_depth()
        if coverage is not None or limit is not None or whole:
            given = {"Diffuse Depth": share, "Coverage": 1.0 if coverage is None else coverage}
            shares = self._call(choice.own_share(limit), 880.0, 0, given)
            marks.tag(shares, CAPTURED)
            if limit is not None:
                self.sketch.repeat(self.node.inputs["Roughness"], shares.inputs["Roughness"])
            share = shares.outputs["Covered" if whole else "Share"]
        if not whole:
            return self._mix(1080.0, 0, share, seen, own)
        mixed = self._mix(1080.0, 0, share, own, seen)
        marks.tag(mixed.node, GLOW)
        return mixed

    def _diffuse_depth(self) -> bpy.types.NodeSocket:
        """How many diffuse surfaces the path to the surface has left; a Mix Shader takes more than one for one."""
        return self._new("ShaderNodeLightPath", right=680.0, row=0.625).outputs["Diffuse Depth"]

    def _lit(self, row: int) -> bpy.types.Node:
        """The group node that makes what reaches the eye of the radiance along each ray."""
        lit = self._new("ShaderNodeGroup", right=-240.0, row=row)
        lit.node_tree = groups.surface_group(self.plan.effects)
        lit.label = "Reflectance"
        radiances = {ray.radiance for ray in self.plan.effects.rays}
        for socket in lit.inputs:
            if socket.name == "Captured":
                marks.tag(lit, CAPTURED)
            elif socket.name in {"Normal", "Incoming", "Backfacing", "Tangent"}:
                self.sketch.link(self._of_the_surface(socket.name), socket)
            elif socket.name not in radiances:
                self.sketch.repeat(self.node.inputs[socket.name], socket)
        return lit

    def _reflections(
        self, lit: bpy.types.Node, shader_of: _ShaderOf
    ) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket | None]:
        """The shader that emits what the probes show, each where it is the right one, and how much they cover.

        A Mix Shader is skipped by Cycles on the side that has no share, so only the probes of the place are read.
        """
        shader = coverage = seen = None
        depths: list[bpy.types.NodeSocket | None] = []
        for row, shown in enumerate(self.probes):
            if row > 0:
                lit = self._lit(row)
            probe = self._light(lit, shown, row)
            one, weight = shader_of(lit, row), probe.outputs.get("Weight")
            depths.append(probe.outputs.get("Depth"))
            if shader is None:
                shader, coverage, seen = one, weight, probe.outputs.get("Seen")
                continue
            covered = 1.0 if coverage is None else coverage  # a probe that has all of what is its share
            weight = 1.0 if weight is None else weight
            sights = {"Seen": probe.outputs.get("Seen", 1.0), "Seen Before": 1.0 if seen is None else seen}
            if "Seen" in probe.outputs:
                told = {**sights, "Weight": weight, "Coverage": covered}
                weight = self._call(choice.YIELDING, -620.0, row, told).outputs["Weight"]
            given = {
                "Depth": depths[row],
                "Coverage": covered,
                "Weight": weight,
                "Fade": shown.fade,
            }
            if shown.beside:
                given["Distance"] = self._nearest(tuple(depths[k] for k in shown.beside), row)
            step = self._call(choice.BESIDE if shown.beside else choice.OVER, -500.0, row, given)
            shader = self._mix(480.0, row, step.outputs["Share"], shader, one)
            coverage = step.outputs["Coverage"]
            if row + 1 < len(self.probes) and (seen is not None or "Seen" in probe.outputs):
                both = {**sights, "Share": step.outputs["Share"]}
                seen = self._call(choice.SEEN_BY_BOTH, -380.0, row, both).outputs["Seen"]
        return shader, coverage

    def _nearest(self, depths: tuple[bpy.types.NodeSocket, ...], row: int) -> bpy.types.NodeSocket:
        """How far outside the nearest of some boxes a point is, from its depths in them; made once for all rows."""
        if depths not in self._distances:
            last = self._call(choice.OUTSIDE, -500.0, row, {"Depth": depths[-1]}).outputs["Distance"]
            if len(depths) > 1:
                given = {"Distance": self._nearest(depths[:-1], row), "Other Distance": last}
                last = self._call(choice.NEARER, -500.0, row, given).outputs["Distance"]
            self._distances[depths] = last
        return self._distances[depths]

    def _light(self, lit: bpy.types.Node, shown: ShownProbe, row: int) -> bpy.types.Node:
        """Feed a surface by a probe along each of its rays; returns the probe's node of the first one."""
        nodes = []
        for k, ray in enumerate(self.plan.effects.rays):
            probe = self._new("ShaderNodeGroup", right=-760.0, row=row)
            probe.node_tree = shown.group
            probe.label = shown.group.name
            marks.tag(probe, PROBE)
            way = self._way(k)
            for name in ("Direction", "Offset"):
                if name in way.outputs and name in probe.inputs:
                    self.sketch.link(way.outputs[name], probe.inputs[name])
            if "Normal" in probe.inputs:
                self.sketch.link(self._normal(), probe.inputs["Normal"])
            self.sketch.link(self._radiance(shown, probe, ray, row), lit.inputs[ray.radiance])
            nodes.append(probe)
        return nodes[0]

    def _way(self, k: int) -> bpy.types.Node:
        """The node that says where one of the surface's rays goes; made once."""
        if k not in self._ways:
            formula = self.plan.effects.rays[k].formula
            way = self._ways[k] = self._call(formula, -1000.0, 0)
            for socket in way.inputs:
                if socket.name in _OF_THE_NODE:
                    self.sketch.repeat(self.node.inputs[socket.name], socket)
                else:
                    self.sketch.link(self._of_the_surface(socket.name), socket)
        return self._ways[k]

    def _of_the_surface(self, name: str) -> bpy.types.NodeSocket:
        """What formulas ask of where they are evaluated."""
        if name == "Normal":
            return self._normal()
        if name == "Tangent" and is_given(self.node.inputs[name], self.sketch.scope):
            return source(self.node.inputs[name])
        if name == "Dimensions":
            attribute = self._new("ShaderNodeAttribute", right=-1240.0)
            attribute.attribute_type, attribute.attribute_name = "OBJECT", "dimensions"
            return attribute.outputs["Vector"]
        if name.startswith("Axis "):
            axis = self._new("ShaderNodeVectorTransform", right=-1480.0)
            axis.vector_type, axis.convert_from, axis.convert_to = "VECTOR", "OBJECT", "WORLD"
            axis.inputs[0].default_value = [float(name[-1] == letter) for letter in "XYZ"]
            unit = self._new("ShaderNodeVectorMath", right=-1240.0)
            unit.operation = "NORMALIZE"
            self.sketch.link(axis.outputs[0], unit.inputs[0])
            return unit.outputs[0]
        return self._geometry(name)

    def _radiance(self, shown: ShownProbe, probe: bpy.types.Node, ray: Ray, row: float) -> bpy.types.NodeSocket:
        """What a probe shows along a ray at the surface's roughness."""
        levels = self.plan.levels(shown.rungs, ray, shown.hardening)
        formula = self.plan.mixing(shown.rungs, ray, shown.hardening)
        if formula is None:
            return probe.outputs[shown.level(levels[0])]
        given = {level_name(i): probe.outputs[shown.level(k)] for i, k in enumerate(levels)}
        if shown.hardening:
            given["Spread"] = probe.outputs["Spread"]
        mixed = self._call(formula, -500.0, row, given)
        self.sketch.repeat(self.node.inputs["Roughness"], mixed.inputs["Roughness"])
        return mixed.outputs["Radiance"]

    def _normal(self) -> bpy.types.NodeSocket:
        """The normal that the surface mirrors by; made once."""
        if self._normal_output is None:
            self._normal_output = self._made_normal()
        return self._normal_output

    def _made_normal(self) -> bpy.types.NodeSocket:
        if not is_given(self.node.inputs["Normal"], self.sketch.scope):
            return self._geometry("Normal")
        feeding = source(self.node.inputs["Normal"])
        if not self.plan.bends_normals:
            return feeding
        given = {"Normal": feeding, **{name: self._geometry(name) for name in ("True Normal", "Incoming")}}
        return self._call(VALID_NORMAL, -1240.0, 0, given).outputs["Normal"]

    def _geometry(self, output: str) -> bpy.types.NodeSocket:
        return self.sketch.geometry(output, self.node)

    def _new(self, kind: str, right: float = 0.0, row: float = 0.0) -> bpy.types.Node:
        return self.sketch.new(kind, self.node, right, row)

    def _call(
        self,
        formula: Formula,
        right: float,
        row: float,
        given: Mapping[str, bpy.types.NodeSocket | float] | None = None,
    ) -> bpy.types.Node:
        return self.sketch.call(formula, self.node, right, row, given)
