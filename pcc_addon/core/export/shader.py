"""A probe's lookup as a shader file."""

from __future__ import annotations

from collections.abc import Mapping

from ..backends.printing import functions, identifier
from ..expression import Formula
from .axes import Axes
from .languages import Value
from .lookup import OF_SURFACE, TITLE
from .target import Target

# Some languages know no name of a parameter that is that of a global too.
_GIVEN = {"Position": "p_position", "Incoming": "p_incoming", "Normal": "p_normal", "Roughness": "p_rough"}
_COMPONENTS = {"X": "x", "Y": "y", "Z": "z"}


def shader(of: Formula, numbers: Mapping[str, Value], target: Target, heading: str) -> str:
    """The text of a file that an engine's shader includes.

    Args:
        of: `lookup.formula`.
        numbers: of the probe, by the formula's inputs.
        target: the engine.
        heading: what the file is, in words.
    """
    language, kind = target.language, target.language.dialect.kind
    of_probe = declared_numbers(of)
    declared = [language.declared(kind(of.inputs[name].width), number_name(name), numbers[name]) for name in of_probe]
    given = ", ".join(number_name(name) if name in of_probe else _GIVEN[name] for name in of.inputs)
    read = language.read.format(direction="parallax_probe_sampled(p_direction)", level="p_level")
    vector, vector4 = language.dialect.vector, language.vector4
    return "\n".join(
        [
            *(f"// {line}" for line in heading.splitlines()),
            "//",
            "// parallax_probe(cubemap, position, incoming, normal, rough) is the linear radiance that is mirrored",
            "// and beside it how much of the surface's reflection that is. World space, the engine's axes and units;",
            "// incoming is unit, from the surface to the eye, and normal is unit; the square of rough is GGX's alpha.",
            "",
            *declared,
            "",
            language.dialect.prelude,
            functions(of, language.dialect),
            f"{vector} parallax_probe_sampled({vector} d) {{ return {_turned(vector, target.sampled)}; }}",
            "",
            f"{vector4} parallax_probe({language.picture}, {vector} p_position, {vector} p_incoming, "
            f"{vector} p_normal, float p_rough) {{",
            f"    {vector} p_direction; float p_level; float p_brightness; float p_weight;",
            f"    {identifier(TITLE)}({given}, p_direction, p_level, p_brightness, p_weight);",
            f"    return {vector4}({read} * p_brightness, p_weight);",
            "}",
            "",
        ]
    )


def number_name(name: str) -> str:
    """What a probe's number is called in shaders and in the JSON file."""
    return f"pp_{identifier(name)}"


def _turned(vector: str, axes: Axes) -> str:
    parts = [f"{'-' if side[0] == '-' else ''}d.{_COMPONENTS[side[1]]}" for side in axes.names]
    return f"{vector}({', '.join(parts)})"


def declared_numbers(of: Formula) -> tuple[str, ...]:
    """The names of the probe's numbers that the shader of a formula declares."""
    return tuple(name for name in of.inputs if name not in OF_SURFACE)
