"""Readings of small scenes, to plan without Blender."""

from __future__ import annotations

import numpy as np

from pcc_addon.core.probe import Box, ProbeSpec
from pcc_addon.core.readings import MaterialReading, PlacementReading, ProbeReading, SurfaceReading, Value

INPUTS: dict[str, Value] = {
    "Base Color": (0.8, 0.8, 0.8, 1.0),
    "Metallic": 0.0,
    "Roughness": 0.25,
    "IOR": 1.5,
    "Specular IOR Level": 0.5,
    "Specular Tint": (1.0, 1.0, 1.0, 1.0),
    "Transmission Weight": 0.0,
    "Coat Weight": 0.0,
    "Sheen Weight": 0.0,
    "Anisotropic": 0.0,
    "Thin Film Thickness": 0.0,
    "Thin Film IOR": 1.33,
}


def surface(name: str = "Principled BSDF", distribution: str = "GGX", **inputs: Value) -> SurfaceReading:
    """A Principled BSDF; inputs by name with underscores for spaces."""
    given = {**INPUTS, **{key.replace("_", " "): value for key, value in inputs.items()}}
    return SurfaceReading((name,), "ShaderNodeBsdfPrincipled", tuple(given.items()), distribution)


def material(name: str, *surfaces: SurfaceReading, **more: object) -> MaterialReading:
    """A material of these surfaces, or of a plain one."""
    return MaterialReading(name, surfaces or (surface(),), **more)


def spec(name: str, x: float = 0.0, half: float = 2.0, **settings: object) -> ProbeSpec:
    """A cube with its centre on the x axis."""
    matrix = np.diag([half, half, half, 1.0])
    matrix[0, 3] = x
    return ProbeSpec(name, Box.from_matrix(name, matrix), **{"padding": 0.01, "falloff": 0.25, **settings})


def probe(name: str, x: float = 0.0, half: float = 2.0, **settings: object) -> ProbeReading:
    return ProbeReading(name, spec(name, x, half, **settings))


def placement(
    name: str, *materials: str, x: float = 0.0, size: tuple[float, float, float] = (0.5, 0.5, 0.5)
) -> PlacementReading:
    """An object whose bounds, with these half sizes, have their centre on the x axis."""
    corners = (np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0) * np.array(size) + np.array([x, 0.0, 0.0])
    return PlacementReading(name, materials, corners)
