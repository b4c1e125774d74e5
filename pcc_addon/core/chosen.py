"""What artists choose of the probes that materials and objects show, and what comes of it, in words."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from .readings import MaterialReading, SceneReading
from .words import named


def told_choices(material: MaterialReading, excluded: Collection[str]) -> Iterator[str]:
    """What was chosen, in words.

    Args:
        material: it.
        excluded: its objects that are to show no probe.
    """
    if material.allowed is not None:
        names = named(sorted(material.allowed))
        yield f"its Probe is {names}, which it shows alone" if material.allowed else "its Show Probes is off"
    if excluded and material.allowed != frozenset():
        yield f"Show Probes of {named(sorted(excluded))} is off"


def told_unserved(material: MaterialReading, scene: SceneReading) -> Iterator[str]:
    """Why a material shows none of the probes that were chosen for it, in words that follow its name."""
    known = {probe.name: probe for probe in scene.probes}
    for name in sorted(material.allowed or ()):
        if name not in known:
            yield f"is to show '{name}' alone, which is no probe of scene '{scene.name}': choose another"
        elif known[name].spec is None:
            yield f"is to show '{name}' alone, which is faulty: mend it or choose another"
        else:
            yield f"is to show '{name}' alone, and none of its objects may show that: move it or choose another"
