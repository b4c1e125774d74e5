"""The JSON file of an export: each probe's box, capture point and influence, in the engine's axes and units."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..effects.records import LookupEffects
from ..errors import PccError
from ..expression import Formula
from ..probe import ProbeSpec
from ..sidecar import Sidecar
from . import lookup
from .shader import declared_numbers, number_name
from .target import Target

NAME = "parallax_probes.json"
FORMAT, VERSION = "parallax-probes-export", 1


@dataclass(frozen=True)
class ExportedProbe:
    """What is said of one probe.

    Attributes:
        spec: the probe.
        record: of its bake.
        captured_at: where the picture was taken, Blender's world, metres.
        effects: of its lookup.
        width: texels across a face of the sharpest level.
        roughnesses: of the levels.
        shader: name of the file.
        pictures: names of files by `Picture` value; of faces six.
    """

    spec: ProbeSpec
    record: Sidecar
    captured_at: tuple[float, float, float]
    effects: LookupEffects
    width: int
    roughnesses: tuple[float, ...]
    shader: str
    pictures: Mapping[str, str | Sequence[str]]

    @property
    def formula(self) -> Formula:
        """Of its lookup."""
        return lookup.formula(self.effects, self.roughnesses)


def document(probes: Sequence[ExportedProbe], target: Target, addon: str, files: Mapping[str, str]) -> str:
    """The text of the file.

    Args:
        probes: those that are exported.
        target: the engine.
        addon: the version that exports.
        files: what was written, with the digest of each.
    """
    plain = {
        "format": FORMAT,
        "version": VERSION,
        "addon": addon,
        "target": target.key,
        "convention": {
            "axes": dict(zip("xyz", (f"{side} of Blender" for side in target.axes.names), strict=True)),
            "handedness": "left" if target.axes.mirrors else "right",
            "units_per_metre": target.units,
            "sampled": dict(zip("xyz", target.sampled.names, strict=True)),
            "cubemap": "faces px nx py ny pz nz, the first row where t is 0, as graphics hardware samples them",
            "colour": "scene-linear radiance, half precision; alpha is 1",
            "roughness": "its square is the alpha of GGX",
            "shader_language": target.language.name,
        },
        "probes": [_probe(probe, target) for probe in probes],
        "files": dict(files),
    }
    return json.dumps(plain, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _probe(probe: ExportedProbe, target: Target) -> dict[str, Any]:
    spec, influence = probe.spec, probe.spec.influence
    numbers = lookup.numbers(spec, probe.captured_at, target)
    low, high = (list(lookup.length(end, target)) for end in spec.influence_reach)
    falloff_low, falloff_high = (list(lookup.length(end, target)) for end in spec.face_falloffs)
    return {
        "name": spec.name,
        "uid": probe.record.uid,
        "shader": probe.shader,
        "pictures": dict(probe.pictures),
        "face_width": probe.width,
        "roughnesses": list(probe.roughnesses),
        "captured_faces": list(probe.record.faces),
        "source": probe.record.source.value,
        "engine": probe.record.engine,
        "box": {
            "centre": list(numbers["Box Centre"]),
            "half_edges": [list(lookup.length(target.axes.matrix @ edge, target)) for edge in spec.box.axes.T],
        },
        "capture_point": list(numbers["Capture Point"]),
        "influence": {
            "reach_low": low,
            "reach_high": high,
            "falloff_low": falloff_low,
            "falloff_high": falloff_high,
            "normal_fade": lookup.length(influence.normal_fade, target)[0],
            "weight": influence.weight,
            "priority": influence.priority,
            "outside": spec.outside.value,
        },
        "corrected": spec.corrected,
        "contact_hardening": spec.contact_hardening,
        "numbers": {
            number_name(name): values[0] if len(values) == 1 else list(values)
            for name, values in ((name, numbers[name]) for name in declared_numbers(probe.formula))
        },
    }


def files_of(text: str, origin: str) -> dict[str, str]:
    """The files that an earlier export wrote beside its JSON, with the digest of each.

    Raises:
        PccError: the text is no such file.
    """
    try:
        plain = json.loads(text)
        if plain["format"] != FORMAT:
            raise ValueError("its format is another")
        return {str(name): str(digest) for name, digest in plain["files"].items()}
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise PccError(f"'{origin}' is not of an export ({error}); move it away, or choose another folder") from error
