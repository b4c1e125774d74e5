"""What a material's twins are to show: the plan of a material with the node groups that stand for its probes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import bpy

from ...core.effects.roughness import rung_name
from ...core.surface_plan import SurfacePlan


@dataclass(frozen=True)
class ShownProbe:
    """A probe as twins show it.

    Attributes:
        group: its node group.
        rungs: the roughnesses of its levels, ascending.
        fade: metres over which it fades beyond its box.
        outputs: names of the group's outputs.
        beside: those before it in its material, by their index, whose boxes are apart from its own.
    """

    group: bpy.types.ShaderNodeTree
    rungs: tuple[float, ...]
    fade: float
    outputs: tuple[str, ...] = ()
    beside: tuple[int, ...] = ()

    def level(self, k: int) -> str:
        """The name of the output at the k-th of its roughnesses."""
        return rung_name(self.rungs[k])

    @property
    def hardening(self) -> bool:
        """Whether it shows the sharper what is nearer to a rough surface."""
        return "Spread" in self.outputs


@dataclass(frozen=True)
class TwinOrder:
    """What to build.

    Attributes:
        probes: each shown over those before it; empty: the diffuse part alone, as captures need it.
        surfaces: by path; those that are missing keep their own lobes.
        emits: whether the material is a light of its own, which Cycles goes on sampling.
    """

    probes: tuple[ShownProbe, ...]
    surfaces: Mapping[tuple[str, ...], SurfacePlan]
    emits: bool = False
