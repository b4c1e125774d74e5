"""The languages that engines take shaders in: what is around the printed formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..backends import glsl, hlsl
from ..backends.printing import Dialect

Value = tuple[float, ...]


@dataclass(frozen=True)
class Language:
    """A shading language as one engine takes it.

    Attributes:
        name: in words.
        suffix: of the file.
        dialect: how formulas are printed.
        declared: the line that makes a probe's value known: of its type, its name and the value itself.
        picture: the parameters of a function that are given the cubemap.
        read: the cubemap's texel, with {direction} and {level}.
        vector4: the type of four numbers.
    """

    name: str
    suffix: str
    dialect: Dialect
    declared: Callable[[str, str, Value], str]
    picture: str
    read: str
    vector4: str = "vec4"

    def number(self, value: Value) -> str:
        """A value as text that gives the same float32."""
        numbers = [f"{component:.9g}" for component in value]
        numbers = [text if any(c in text for c in ".en") else f"{text}.0" for text in numbers]
        return numbers[0] if len(numbers) == 1 else f"{self.dialect.vector}({', '.join(numbers)})"


_GLSL = Dialect("vec3", "vec3({})", glsl.ARITHMETIC)
_READ_GLSL = "textureLod(p_cubemap, {direction}, {level}).rgb"


def _uniform(kind: str, name: str, value: Value) -> str:
    return f"uniform {kind} {name};"


def _uniform_with_value(kind: str, name: str, value: Value) -> str:
    return f"uniform {kind} {name} = {GODOT.number(value)};"


def _constant(kind: str, name: str, value: Value) -> str:
    return f"static const {kind} {name} = {UNREAL.number(value)};"


GLSL = Language("GLSL ES 3.00 and GLSL 3.30", "glsl", _GLSL, _uniform, "samplerCube p_cubemap", _READ_GLSL)
GODOT = Language(
    "the Godot shading language", "gdshaderinc", _GLSL, _uniform_with_value, "samplerCube p_cubemap", _READ_GLSL
)
_PICTURE_HLSL = "TextureCube p_cubemap, SamplerState p_sampler"
_READ_HLSL = "p_cubemap.SampleLevel(p_sampler, {direction}, {level}).rgb"
UNITY = Language("HLSL for Unity", "hlsl", hlsl.DIALECT, _constant, _PICTURE_HLSL, _READ_HLSL, "float4")
UNREAL = Language("HLSL for Unreal Engine", "ush", hlsl.DIALECT, _constant, _PICTURE_HLSL, _READ_HLSL, "float4")
