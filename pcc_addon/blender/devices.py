"""What Cycles renders with: a preference, of which another Blender knows only what was last saved."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

import bpy


@dataclass(frozen=True)
class Devices:
    """Cycles' devices as its preferences have them.

    Attributes:
        kind: their kind, such as "CUDA"; "NONE" for the processor alone; empty: Cycles has no preferences here.
        used: the identities of those that are switched on, among all kinds.
    """

    kind: str = ""
    used: tuple[str, ...] = ()

    def to_json(self) -> str:
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Devices:
        """What `to_json` wrote."""
        plain = json.loads(text)
        return cls(plain["kind"], tuple(plain["used"]))


def chosen() -> Devices:
    """Those of this Blender."""
    settings = _settings()
    if settings is None:
        return Devices()
    return Devices(settings.compute_device_type, tuple(device.id for device in settings.devices if device.use))


def choose(wanted: Devices) -> None:
    """Render with some devices from now on, as far as they are there."""
    settings = _settings()
    if settings is None or chosen() == wanted or wanted.kind not in {kind for kind, *_ in _kinds(settings)}:
        return
    settings.compute_device_type = wanted.kind
    settings.refresh_devices()
    for device in settings.devices:
        device.use = device.id in wanted.used


def _kinds(settings: bpy.types.AddonPreferences) -> list[tuple]:
    return settings.get_device_types(bpy.context)


def _settings() -> bpy.types.AddonPreferences | None:
    addon = bpy.context.preferences.addons.get("cycles")
    return addon.preferences if addon is not None else None
