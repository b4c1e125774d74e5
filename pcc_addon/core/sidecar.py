"""The JSON file beside a probe's pictures: what they show, where from, and how they were made."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from dataclasses import asdict, dataclass
from pathlib import Path

from .cubemap import FACES
from .errors import BakeError
from .probe import ProbeSpec

VERSION = 1
_UNSAFE = re.compile(r"[^A-Za-z0-9_-]+")
_NUMBERS = {"matrix": 16, "capture_point": 3, "clip": 2}


@dataclass(frozen=True)
class Level:
    """One picture: the capture as a GGX lobe of this roughness sees it."""

    roughness: float
    file: str
    width: int
    height: int


@dataclass(frozen=True)
class Sidecar:
    """The record of one bake.

    Attributes:
        probe: the object's name at the time.
        uid: the probe's lasting identity.
        matrix: 16 floats, row by row: the proxy box, [−1, 1]³ to world, metres.
        capture_point: world space, metres.
        resolution, samples, engine, denoise: as baked.
        clip: near and far plane, metres.
        seconds: wall time of the six renders and of assembling them.
        content_hash: of everything that the pictures depend on; another hash means a stale bake.
        blender, addon: versions.
        levels: the pictures, sharpest first.
        replaced_pixels: what was wrong in the capture, in words.
    """

    probe: str
    uid: str
    matrix: tuple[float, ...]
    capture_point: tuple[float, float, float]
    resolution: int
    samples: int
    engine: str
    denoise: bool
    clip: tuple[float, float]
    seconds: float
    content_hash: str
    blender: str
    addon: str
    levels: tuple[Level, ...]
    replaced_pixels: tuple[str, ...] = ()

    @classmethod
    def of_bake(
        cls,
        spec: ProbeSpec,
        uid: str,
        *,
        seconds: float,
        content_hash: str,
        blender: str,
        addon: str,
        replaced_pixels: tuple[str, ...] = (),
    ) -> Sidecar:
        """The record of a bake of `spec`, as yet without levels."""
        return cls(
            probe=spec.name,
            uid=uid,
            matrix=spec.box.matrix,
            capture_point=tuple(float(c) for c in spec.capture_point),
            resolution=spec.resolution,
            samples=spec.samples,
            engine=spec.engine.value,
            denoise=spec.denoise,
            clip=(spec.clip_start, spec.clip_end),
            seconds=seconds,
            content_hash=content_hash,
            blender=blender,
            addon=addon,
            levels=(),
            replaced_pixels=replaced_pixels,
        )

    def to_json(self) -> str:
        """The sidecar's text, with the format's version and the face convention."""
        faces = [asdict(face) for face in FACES]
        convention = {
            "picture": "equirectangular, u = 1/2 - atan2(y, x) / 2 pi, v = 1/2 + asin(z) / pi from the bottom",
            "space": "world axes, Z up, right-handed, metres, scene-linear radiance",
            "faces": faces,
        }
        document = {"format": "parallax-probe", "version": VERSION, **asdict(self), "convention": convention}
        return json.dumps(document, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str, origin: str) -> Sidecar:
        """Read a sidecar's text; `origin` names it in messages.

        Raises:
            BakeError: it is not a sidecar, or one of a later version.
        """
        try:
            document = json.loads(text)
            version = document["version"]
            if document["format"] != "parallax-probe" or not isinstance(version, int):
                raise ValueError("not a parallax-probe file")
            if version > VERSION:
                raise BakeError(f"'{origin}' was written by a later version of the add-on; update it, or bake again")
            fields = {name: document[name] for name in cls.__dataclass_fields__}
            fields["levels"] = tuple(Level(**level) for level in fields["levels"])
            for name in (*_NUMBERS, "replaced_pixels"):
                fields[name] = tuple(fields[name])
            for name, count in _NUMBERS.items():
                if len(fields[name]) != count or not all(math.isfinite(number) for number in fields[name]):
                    raise ValueError(f"'{name}' is not {count} finite numbers")
            return cls(**fields)
        except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
            raise BakeError(f"'{origin}' is not a probe's sidecar ({error}); bake the probe again") from error


def file_stem(name: str, uid: str) -> str:
    """A file name for a probe that is safe on every system and differs wherever the uid differs."""
    readable = _UNSAFE.sub("_", name).strip("_-")[:40] or "probe"
    return f"{readable}-{hashlib.blake2b(uid.encode(), digest_size=4).hexdigest()}"


def level_file(stem: str, roughness: float) -> str:
    """The name of a level's picture."""
    return f"{stem}.r{round(roughness * 10000):05d}.exr"


def move_into_place(parts: Path, target: Path, names: list[str]) -> None:
    """Move finished files from one folder of a disk to another, the last one last; each appears whole or not at all."""
    for name in names:
        os.replace(parts / name, target / name)
