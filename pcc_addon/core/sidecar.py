"""The JSON file beside a probe's pictures: what they show, where from, and how they were made."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from .cubemap import FACE_NAMES, FACES
from .errors import BakeError
from .pictures import STILL, PictureKey, PictureKind
from .probe import Box, ProbeSpec, Source
from .sequence import Moment
from .workplace import on_disk

VERSION = 2
_AXES = {
    False: "world axes, Z up, right-handed",
    True: "axes of the matrix, to be looked up along its inverse times the corrected direction",
}
_UNSAFE = re.compile(r"[^A-Za-z0-9_-]+")
FORMAT = "parallax-probe"
_OPENING = f'{{\n "format": "{FORMAT}"'.encode()  # of each sidecar
_ENDLESS = 2**53  # beyond it floats skip whole numbers
_LARGEST = 2**28  # bytes; a picture takes some hundred
_INFINITE = float(np.finfo(np.float32).max)  # shaders compute in float32
_NUMBER = r"\.\d{4,}"  # of a picture of a sequence; Blender finds the others by it
_PICTURE = rf"\.(?:[a-z]+-\d+\.[0-9a-f]{{12}}(?:{_NUMBER})?|r\d{{5}})\.exr"  # the last is version 1's
_NUMBERED = re.compile(rf"(\.[0-9a-f]{{12}}){_NUMBER}(\.exr)$")
_FILE_NAME = re.compile(rf"[A-Za-z0-9_-]+-([0-9a-f]{{8}})(?:{_PICTURE}|\.json)")
PICTURE_NAME = re.compile(rf"[A-Za-z0-9_-]{{1,40}}-[0-9a-f]{{8}}{_PICTURE}".encode())
"""The name of a picture, as it stands among the bytes of a .blend."""


@dataclass(frozen=True)
class Level:
    """One picture: the capture as a GGX lobe of this roughness sees it.

    Attributes:
        key: which of the probe's pictures it is.
        roughness: of the lobe.
        file: its name, beside the sidecar.
        width, height: texels.
        size: bytes of the file; 0 where nobody has noted it.
        digest: hexadecimal, of the pixels; empty where nobody has noted it.
    """

    key: PictureKey
    roughness: float
    file: str
    width: int
    height: int
    size: int = 0
    digest: str = ""

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> Level:
        """Read what `Sidecar.to_json` wrote; what it does not know is ignored.

        Raises:
            KeyError, TypeError, ValueError: it is no such thing.
        """
        return cls(
            key=PictureKey.parse(_text(plain["key"])),
            roughness=_number(plain["roughness"]),
            file=_file_name(plain["file"]),
            width=_whole(plain["width"]),
            height=_whole(plain["height"]),
            size=_whole(plain.get("size", 0)),
            digest=_text(plain.get("digest", "")),
        )


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
        source: where the pictures came from.
        moments: of a sequence, one for each of its frames, ascending; empty for a still. Of a sequence, what else is
            said is that of its first picture.
        faces: those that were captured, by name, in the order of `FACES`; where others lie pictures are guessed.
        face_hashes: of what each of the six depends on, in the order of `FACES`; empty where that was not known for
            each alone.
        half_float: whether its pictures are kept in half precision.
        departure: how far what was captured departs from the box at most, over the distance to the box; None where no
            distances were captured.
        date: when it was made, ISO 8601, UTC; empty where nobody has noted it.
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
    source: Source = Source.BAKE
    moments: tuple[Moment, ...] = ()
    faces: tuple[str, ...] = FACE_NAMES
    face_hashes: tuple[str, ...] = ()
    departure: float | None = None
    half_float: bool = False
    date: str = ""

    @property
    def frames(self) -> tuple[int, ...]:
        """Those of a sequence, ascending; none for a still."""
        return tuple(moment.frame for moment in self.moments)

    def capture_point_apart_from(self, place: Sequence[float]) -> tuple[float, float, float]:
        """Where its pictures were taken; of several points the one farthest from a place. World space, metres."""
        points = [self.capture_point, *(moment.capture_point for moment in self.moments)]
        return max(points, key=lambda point: math.dist(point, place))

    def departs_from(self, box: Box) -> float | None:
        """How far what was captured departs from a box at most, over the distance to it; None where nobody knows.

        Infinite where the box is another than at the bake.
        """
        if self.departure is None:
            return None
        return self.departure if box.matrix == self.matrix else math.inf

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
        faces: tuple[str, ...] = FACE_NAMES,
        face_hashes: tuple[str, ...] = (),
        departure: float | None = None,
    ) -> Sidecar:
        """The record of a bake of `spec` that ends now, as yet without levels."""
        x, y, z = spec.capture_point
        return cls(
            probe=spec.name,
            uid=uid,
            matrix=spec.box.matrix,
            capture_point=(float(x), float(y), float(z)),
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
            source=spec.source,
            faces=faces,
            face_hashes=face_hashes,
            departure=departure,
            half_float=spec.half_float,
            date=datetime.now(UTC).isoformat(timespec="seconds"),
        )

    def changed(self, content_hash: str, face_hashes: Sequence[str]) -> tuple[str, ...]:
        """Those of its faces that may show something else now.

        Args:
            content_hash: of what its pictures depend on now.
            face_hashes: of what each face does; empty where that is not known.
        """
        if self.content_hash == content_hash:
            return ()
        if not self.face_hashes or not face_hashes:
            return self.faces
        pairs = zip(FACE_NAMES, self.face_hashes, face_hashes, strict=True)
        return tuple(name for name, before, now in pairs if before != now and name in self.faces)

    def is_of(self, spec: ProbeSpec, content_hash: str, faces: Iterable[str]) -> bool:
        """Whether a bake of a still would give the same.

        Args:
            spec: of the probe.
            content_hash: of what its pictures depend on now.
            faces: those that are needed.
        """
        precise = self.half_float == spec.half_float and not (spec.captures_distance and self.departure is None)
        return precise and self.content_hash == content_hash and not self.lacks(faces)

    def lacks(self, faces: Iterable[str]) -> tuple[str, ...]:
        """Those of some faces that were not captured."""
        return tuple(name for name in faces if name not in self.faces)

    def to_json(self) -> str:
        """The sidecar's text, with the format's version and the face convention."""
        convention = {
            "picture": "equirectangular, u = 1/2 - atan2(y, x) / 2 pi, v = 1/2 + asin(z) / pi from the bottom",
            "space": f"{_AXES[self.source.stretched]}, metres, scene-linear radiance",
            "faces": [asdict(face) for face in FACES],
        }
        levels = [{**asdict(level), "key": level.key.text} for level in self.levels]
        document = {"format": FORMAT, "version": VERSION, **asdict(self), "levels": levels, "convention": convention}
        return json.dumps(document, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str, origin: str) -> Sidecar:
        """Read a sidecar's text, of this version or an earlier one; `origin` names it in messages.

        What it does not know is ignored, and what later releases of a version added has defaults.

        Raises:
            BakeError: it is not a sidecar, or one of a later version.
        """
        try:
            document = json.loads(text)
            version = document["version"]
            if document["format"] != FORMAT or type(version) is not int or version < 1:
                raise ValueError("not a parallax-probe file: its format or version is none")
            if version > VERSION:
                raise BakeError(f"'{origin}' was written by a later version of the add-on; update it, or bake again")
            return cls._from_plain(migrated(document))
        except (KeyError, TypeError, ValueError, OverflowError, RecursionError, AttributeError) as error:
            raise BakeError(
                f"'{origin}' is not a probe's sidecar ({str(error)[:200]}); bake the probe again"
            ) from error

    @classmethod
    def _from_plain(cls, plain: Mapping[str, Any]) -> Sidecar:
        x, y, z = _numbers(plain, "capture_point", 3)
        start, end = _numbers(plain, "clip", 2)
        return cls(
            probe=_text(plain["probe"]),
            uid=_text(plain["uid"]),
            matrix=_numbers(plain, "matrix", 16),
            capture_point=(x, y, z),
            resolution=_whole(plain["resolution"]),
            samples=_whole(plain["samples"]),
            engine=_text(plain["engine"]),
            denoise=bool(plain["denoise"]),
            clip=(start, end),
            seconds=_number(plain["seconds"]),
            content_hash=_text(plain["content_hash"]),
            blender=_text(plain["blender"]),
            addon=_text(plain["addon"]),
            levels=_levels(plain["levels"]),
            replaced_pixels=tuple(_text(words) for words in plain.get("replaced_pixels", ())),
            source=Source(plain.get("source", Source.BAKE.value)),
            moments=tuple(_moment(moment) for moment in plain.get("moments", ())),
            faces=_faces(plain.get("faces", list(FACE_NAMES))),
            face_hashes=_face_hashes(plain.get("face_hashes", [])),
            departure=_departure(plain.get("departure")),
            half_float=bool(plain.get("half_float", False)),
            date=_date(plain.get("date", "")),
        )


def migrated(document: Mapping[str, Any]) -> dict[str, Any]:
    """A document of an earlier version as one of today's.

    Raises:
        KeyError, TypeError: it lacks what its version has.
    """
    document = dict(document)
    if document["version"] == 1:  # levels had no keys: they stood in the order of their roughness
        levels = sorted(document["levels"], key=lambda level: _number(level["roughness"]))
        keys = [PictureKey(PictureKind.RADIANCE, k).text for k in range(len(levels))]
        document["levels"] = [{**level, "key": key} for level, key in zip(levels, keys, strict=True)]
        document["version"] = 2
    return document


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is no text")
    return value


def _file_name(value: object) -> str:
    """The name of a file beside a record; whoever wrote the record may have written a path to anything."""
    name = _text(value)
    if name in ("", ".", "..") or any(sign in name for sign in "/\\:\0"):
        raise ValueError(f"{name!r} is no name of a file")
    return name


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise TypeError(f"{value!r} is no finite number")
    return float(value)


def _whole(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < _ENDLESS:
        raise TypeError(f"{value!r} is no whole number, or too large")
    return value


def _numbers(plain: Mapping[str, Any], name: str, count: int) -> tuple[float, ...]:
    found = plain[name]
    if not isinstance(found, list) or len(found) != count or not all(abs(number) <= _INFINITE for number in found):
        raise ValueError(f"'{name}' is not {count} finite numbers")
    return tuple(_number(number) for number in found)


def _levels(found: object) -> tuple[Level, ...]:
    if not isinstance(found, list):
        raise TypeError("its levels are no list")
    return tuple(Level.from_plain(level) for level in found)


def _faces(found: object) -> tuple[str, ...]:
    if not isinstance(found, list) or not found or not all(isinstance(name, str) for name in found):
        raise TypeError("its faces are no names")
    faces = tuple(name for name in FACE_NAMES if name in found)
    if len(faces) != len(found):
        raise ValueError("its faces are not among the six, each once")
    return faces


def _face_hashes(found: object) -> tuple[str, ...]:
    if not isinstance(found, list) or len(found) not in (0, len(FACE_NAMES)):
        raise TypeError("its faces' hashes are not six")
    return tuple(_text(each) for each in found)


def _departure(found: object) -> float | None:
    return None if found is None else _number(found)


def _date(found: object) -> str:
    text = _text(found)
    if text and datetime.fromisoformat(text).tzinfo is None:
        raise ValueError("its date does not say of which time zone it is")
    return text


def _moment(plain: Mapping[str, Any]) -> Moment:
    x, y, z = _numbers(plain, "capture_point", 3)
    frame = plain["frame"]
    if type(frame) is not int or abs(frame) >= 2**31:
        raise TypeError(f"{frame!r} is no frame")
    return Moment(frame, _text(plain["content_hash"]), _whole(plain["number"]), (x, y, z))


def file_stem(name: str, uid: str) -> str:
    """A file name for a probe that is safe on every system and differs wherever the uid differs."""
    readable = _UNSAFE.sub("_", name).strip("_-")[:40] or "probe"
    return f"{readable}-{uid_digest(uid)}"


def sidecar_file(name: str, uid: str) -> str:
    """The name of a probe's sidecar."""
    return f"{file_stem(name, uid)}.json"


def uid_digest(uid: str) -> str:
    """What file names have of a probe's identity: eight hexadecimal digits."""
    return hashlib.blake2b(uid.encode(), digest_size=4).hexdigest()


def uid_digest_of_file(name: str) -> str | None:
    """The `uid_digest` in the name of a picture or a sidecar, or None where it is neither's."""
    found = _FILE_NAME.fullmatch(name)
    return found[1] if found else None


def level_file(stem: str, key: PictureKey, digest: str) -> str:
    """The name of a picture: another content has another name, so that no file is ever written over by another.

    Args:
        stem: of all files of the probe.
        key: of the picture.
        digest: of its pixels; for a picture of a sequence that of all pictures of its level.
    """
    number = "" if key.number == STILL else f".{key.number:04d}"
    return f"{stem}.{key.family}.{digest[:12]}{number}.exr"


def renamed(file: str, name: str, uid: str) -> str:
    """The name that a picture has as one of another probe, or of one that is called otherwise by now."""
    return f"{file_stem(name, uid)}.{file.partition('.')[2]}"


def file_family(name: str) -> str:
    """The name of a picture without its number: pictures of one sequence, which stay or go together, have it alike."""
    return _NUMBERED.sub(r"\1\2", name)


def digest_of_all(digests: Sequence[str]) -> str:
    """A hexadecimal digest of the digests of a sequence's pictures."""
    return hashlib.blake2b("\n".join(digests).encode(), digest_size=16).hexdigest()


def digest_of(pixels: np.ndarray) -> str:
    """A hexadecimal digest of a picture's pixels."""
    return hashlib.blake2b(np.ascontiguousarray(pixels, np.float32).tobytes(), digest_size=16).hexdigest()


def may_replace(path: Path) -> bool:
    """Whether a sidecar may take the place of what has its name: nothing, an older one, one that a power cut emptied.

    Names can be chosen so that anybody's file has one of ours.

    Raises:
        OSError: it cannot be read.
    """
    if not path.exists():
        return True
    if not path.is_file():  # a pipe would be waited for
        return False
    with path.open("rb") as file:
        start = file.read(len(_OPENING) + 1).replace(b"\r", b"")  # as Windows ends lines
    return not start.strip(b"\0") or start.startswith(_OPENING)


def read_file(path: Path) -> str:
    """The text of a sidecar, or of a note beside it.

    Raises:
        OSError: it cannot be read, or is no file.
        BakeError: it is too large for one.
        UnicodeDecodeError: it is no text.
    """
    if path.exists() and not path.is_file():  # a pipe would be waited for
        raise OSError(f"'{path}' is no file")
    if path.stat().st_size > _LARGEST:
        raise BakeError(f"'{path}' is too large for a probe's sidecar; move it away")
    return path.read_text(encoding="utf-8")


def is_named_by_pixels(name: str, pixels: np.ndarray | None) -> bool:
    """Whether a picture's name has the digest of its pixels; None: they cannot be read."""
    return pixels is not None and f".{digest_of(pixels)[:12]}." in name


def move_into_place(parts: Path, target: Path, names: Sequence[str], *, durable: bool = False) -> None:
    """Move finished files from one folder of a disk to another, the last one last: all of them, or none.

    Args:
        parts: where they are.
        target: where to.
        names: theirs.
        durable: whether to wait until the disk has them, so that a power cut leaves none that is torn.

    Raises:
        OSError: one could not be moved; those before it that were new are gone again.
    """
    made: list[Path] = []
    try:
        for name in names:
            if durable:
                on_disk(parts / name)
            is_new = not (target / name).exists()
            os.replace(parts / name, target / name)
            if is_new:
                made.append(target / name)
    except OSError:
        for path in made:
            path.unlink(missing_ok=True)
        raise
