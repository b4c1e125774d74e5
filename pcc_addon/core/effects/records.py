"""What a reflection shader is asked to do. Groups are built from these records and from nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from enum import Enum


class Correction(str, Enum):
    """How the lookup direction is found."""

    NONE = "NONE"  # the reflection vector itself: the classic cubemap
    ALIGNED_BOX = "ALIGNED_BOX"  # box faces along the world axes
    TURNED_BOX = "TURNED_BOX"  # turned about the vertical only
    ORIENTED_BOX = "ORIENTED_BOX"  # any box: rotated, mirrored, sheared

    @property
    def words(self) -> str:
        """The name in plain words."""
        return self.value.lower().replace("_", " ")


class Outside(str, Enum):
    """What a surface outside the influence volume shows."""

    OWN = "OWN"  # fades to the surface's own lobe, as without a probe
    UNCORRECTED = "UNCORRECTED"  # fades to the classic lookup
    BLACK = "BLACK"  # fades to black


@dataclass(frozen=True)
class LookupEffects:
    """The effects of one direction lookup; equal records share one node group.

    Attributes:
        correction: how the direction is found.
        outside: what a surface outside the influence volume shows, or None where no surface lies outside, so that
            nothing need be tested or faded.
        offset: whether the capture point is apart from the box's centre.
        facing: whether surfaces on the box's boundary or beyond may be seen from outside, where they face away from
            what the probe shows; requires `outside`.
        stretched: whether the picture was not captured in the box, so that its axes are the box's own and it is
            stretched to the box; without a correction it is only turned with it. Excludes `offset`.
        per_face: whether the influence box or its falloff differs from face to face.
        by_normal: whether surfaces that face away from the capture point fade near the border of the influence.
        weighted: whether the probe has less than all of a surface even where it is shown in full.
        hardening: whether rough surfaces show the sharper what is nearer to them.
        on_walls: whether rays may leave from the box's walls, where the way to them is 0, or from beyond.
        steps: places on a ray that are looked at for something captured before the box's wall; 0: none. Excludes
            `stretched`.
        refinements: how often the interval between two of them is halved.
    """

    correction: Correction = Correction.ORIENTED_BOX
    outside: Outside | None = Outside.OWN
    offset: bool = True
    facing: bool = False
    stretched: bool = False
    per_face: bool = False
    by_normal: bool = False
    weighted: bool = False
    hardening: bool = False
    on_walls: bool = True
    steps: int = 0
    refinements: int = 0

    def to_plain(self) -> dict[str, str | bool | int]:
        """Its fields as plain values."""
        plain = asdict(self) | {"correction": self.correction.value}
        return plain | {"outside": self.outside.value if self.outside else ""}

    @classmethod
    def of_plain(cls, plain: Mapping[str, object]) -> LookupEffects:
        """The record of what `to_plain` gave."""
        outside = str(plain["outside"])
        steps, refinements = (int(str(plain.get(name, 0))) for name in ("steps", "refinements"))
        others = {"correction", "outside", "steps", "refinements"}
        flags = {name: bool(value) for name, value in plain.items() if name not in others}
        found = cls(Correction(plain["correction"]), Outside(outside) if outside else None, **flags)
        return replace(found, steps=steps, refinements=refinements)

    @property
    def label(self) -> str:
        """A short name, unique for the record, for the node group's title."""
        words = [self.correction.words]
        if self.correction is not Correction.NONE:
            words.append(f"outside {self.outside.value.lower()}" if self.outside else "inside")
            words.append("offset" if self.offset else "centred")
            words += ["seen from outside"] * self.facing
            words += ["per face"] * self.per_face
            words += ["by normal"] * self.by_normal
            words += ["off the walls"] * (not self.on_walls)
            words += [f"relief {self.steps} + {self.refinements}"] * bool(self.steps)
        words += ["along the box's axes" if self.correction is Correction.NONE else "stretched"] * self.stretched
        words += ["weighted"] * self.weighted
        words += ["hardening"] * self.hardening
        return ", ".join(words)
