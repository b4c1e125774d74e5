"""What a surface's effects see of it where its user forces some of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from .decisions import Effect, Forced
from .effects.thin_film import is_coated
from .readings import SurfaceReading, Value


def as_forced(surface: SurfaceReading, forced: Forced) -> SurfaceReading:
    """A surface as its effects see it: what is forced on may vary, what is forced off is nowhere."""
    changed: dict[str, Value] = {}
    for effect, inputs in DECIDING.items():
        for name, without in inputs.items():
            if effect in forced.off:
                changed[name] = without
            elif effect in forced.on and effect.lossless and surface.has(name) and _is(surface.value(name), without):
                changed[name] = None
    if Effect.DIELECTRIC in forced.off:
        changed["Specular IOR Level"] = 0.0
    elif Effect.DIELECTRIC in forced.on and surface.has("Metallic") and surface.value("Metallic") != 0.0:
        keeps_film = surface.films_on_both or not is_coated(surface)  # the metal's, that is
        changed["Metallic"] = None if keeps_film else surface.value("Metallic")
    if Effect.ROUGHNESS in forced.off:
        changed["Roughness"] = 0.0
    kept = tuple((name, changed.get(name, value)) for name, value in surface.inputs)
    chosen = {"MULTI_GGX": "GGX"} if Effect.MULTISCATTER in forced.off else {}
    chosen |= {"GGX": "MULTI_GGX"} if Effect.MULTISCATTER in forced.on else {}
    return replace(surface, inputs=kept, distribution=chosen.get(surface.distribution, surface.distribution))


def _is(value: Value, other: Value) -> bool:
    """Whether two values are the same, apart from the alpha of colours."""
    return value == other or (isinstance(value, tuple) and isinstance(other, tuple) and value[:3] == other[:3])


DECIDING: Mapping[Effect, Mapping[str, Value]] = {
    Effect.METAL: {"Metallic": 0.0},
    Effect.TINT: {"Specular Tint": (1.0, 1.0, 1.0), "Edge Tint": (1.0, 1.0, 1.0)},
    Effect.TRANSMISSION: {"Transmission Weight": 0.0},
    Effect.FILM: {"Thin Film Thickness": 0.0},
    Effect.ANISOTROPY: {"Anisotropic": 0.0, "Anisotropy": 0.0},
}
"""The inputs that an effect is needed for, with their values where it is not."""
