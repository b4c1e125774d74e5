"""Pictures that no record refers to any more: removed once a save does not need them, and only what is surely ours.

A picture may be wanted by files that this session knows nothing of, so there are two rules. What this session wrote and
replaced before any save is known to nobody else. In the folder that is named after a .blend, a picture of one of its
probes goes when no .blend or backup beside the folder speaks of it, and no file elsewhere that has said so. Where that
folder is a link nothing goes.
"""

from __future__ import annotations

import contextlib
import gzip
import hashlib
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

import bpy
import numpy as np

from ...core import kept_faces, sidecar
from ...core.errors import BakeError
from ...core.workplace import UNFINISHED, real, remove_abandoned, write_whole
from .. import marks
from .pictures import pictures_folder, read_file

_MOST_BYTES = 2**31  # of neighbouring files that are read through; beyond that nothing is removed
_PIECE, _LONGEST = 2**20, 160  # bytes that are read at a time, and that a picture's name may have
_USED_BY = ".used-by-"  # how a file says that it shows pictures of another file's folder

_written: set[Path] = set()  # by this session, and in no saved file yet
_replaced: set[Path] = set()  # what a save did not need of these and of notes; undo may bring it back meanwhile
_seen: set[Path] = set()  # what the file showed whenever it was opened, baked or saved in this session
_uids: set[str] = set()  # of the probes that it had then


def wrote(paths: Iterable[Path]) -> None:
    """Remember new files of a bake; they are nobody else's until the .blend is saved."""
    _written.update(paths)


def unsaved() -> list[Path]:
    """The files of bakes that no saved file shows yet."""
    return sorted(path for path in _written if path.is_file())


def opened() -> None:
    """Another file is open now."""
    _uids.update(_uids_here())
    _seen.update(_shown())


def closing() -> None:
    """The open file is left: nothing of it can be undone any more."""
    with contextlib.suppress(OSError):
        _remove(_replaced)
    for known in (_written, _replaced, _seen, _uids):
        known.clear()


def after_save(blend: Path) -> None:
    """Remove what the file that was just saved as `blend` needs no more; what cannot be removed stays.

    What undo may bring back stays until the file is closed; in the background nobody undoes.
    """
    if blend.name.startswith(UNFINISHED):
        return
    blend, shown = real(blend), _shown()
    with contextlib.suppress(OSError):
        _say_who_uses(blend, shown)
    if blend == real(bpy.data.filepath):
        _replaced.update(_written)
        _replaced.difference_update(_of_families(_replaced, shown))
        _written.clear()
    else:  # a copy: the open file may still need what it does not show now
        _written.difference_update(_of_families(_written, shown))
    _seen.update(shown | {_family(path) for path in _written | _replaced})
    _uids.update(_uids_here())
    with contextlib.suppress(OSError):
        if bpy.app.background:
            _remove(_replaced)
            _replaced.clear()
        folder = folder_of(blend)
        if folder.is_dir() and not folder.is_symlink():  # what a link leads to may be another file's
            _remove(_unmentioned(folder, shown if bpy.app.background else _seen))
        _mend_sidecars()


def clean() -> list[Path]:
    """Remove leftovers of bakes of the open file that are surely ours and that nobody can want; returns what is gone.

    In the folder that is named after the file: pictures and sidecars that no .blend beside it, no backup and no file
    that has said so shows, if a sidecar there or their own pixels prove that a bake made them; and kept faces. In any
    folder of its pictures: what killed processes of this machine left.

    Raises:
        BakeError: nobody can tell what neighbouring files show, or something cannot be removed.
    """
    blend = real(bpy.data.filepath)
    folder = folder_of(blend)
    places = {folder, *(path.parent for path in _shown())}
    before = {path for place in places if place.is_dir() for path in place.rglob("*") if path.is_file()}
    for place in sorted(places):
        remove_abandoned(UNFINISHED, place)
        remove_abandoned(UNFINISHED, place / kept_faces.FOLDER)
    if folder.is_dir() and not folder.is_symlink():  # as after a save
        if any(path.name.startswith(UNFINISHED) for path in folder.iterdir()):
            raise BakeError(f"a bake into '{folder}' is under way, or one of another machine was; clean up afterwards")
        try:
            _remove(_proved(folder))
            kept_faces.clear(folder)
        except OSError as error:
            raise BakeError(f"'{folder}' cannot be cleaned up ({error.strerror}); make it writable") from error
    return sorted(path for path in before if not path.exists())


def _proved(folder: Path) -> set[Path]:
    """The pictures and sidecars in a file's own folder that are ours and that nobody shows.

    Raises:
        BakeError: nobody can tell what neighbouring files show.
    """
    mentioned = _mentioned(folder)
    if mentioned is None:
        raise BakeError(
            f"it cannot be told which pictures in '{folder}' the files beside it show (one cannot be read, or they are "
            "larger than 2 GiB together); move what is no .blend of this scene elsewhere"
        )
    wanted = {sidecar.file_family(name) for name in mentioned} | {path.name for path in _shown()}
    described: set[str] = set()
    lonely: set[Path] = set()
    for path in filter(_is_named_by_itself, folder.glob("*.json")):
        families = _families(path)
        if path.name not in wanted and families and not families & wanted:
            lonely.add(path)
        described |= families
    pictures = [path for path in folder.glob("*.exr") if sidecar.file_family(path.name) not in wanted]
    return lonely | {
        path
        for path in pictures
        if sidecar.uid_digest_of_file(path.name)
        and (sidecar.file_family(path.name) in described or sidecar.is_named_by_pixels(path.name, _pixels(path)))
    }


def _is_named_by_itself(path: Path) -> bool:
    """Whether a sidecar has the name that the identity in it gives it."""
    try:
        record = sidecar.Sidecar.from_json(sidecar.read_file(path), path.name)
    except (OSError, BakeError, UnicodeDecodeError):
        return False
    return sidecar.uid_digest_of_file(path.name) == sidecar.uid_digest(record.uid)


def _pixels(path: Path) -> np.ndarray | None:
    """Those of a picture; None where it cannot be read."""
    try:
        return read_file(path)
    except (BakeError, RuntimeError):
        return None


def folder_of(blend: Path) -> Path:
    """The folder that is named after a .blend."""
    return blend.with_suffix(".pcc")


def _shown() -> set[Path]:
    """The families of the files of all images that are open, and the sidecars of all probes."""
    images = [image for image in bpy.data.images if image.filepath and not image.packed_file]
    found = {_family(real(bpy.path.abspath(image.filepath, library=image.library))) for image in images}
    return found | {path for path, _ in _sidecars()}


def _family(path: Path) -> Path:
    """A path that all pictures of a sequence have in common, since an image names only the first; else the path."""
    return path.with_name(sidecar.file_family(path.name)) if path.name else path


def _of_families(paths: Iterable[Path], families: set[Path]) -> set[Path]:
    return {path for path in paths if _family(path) in families}


def _sidecars() -> Iterator[tuple[Path, bpy.types.Object]]:
    """Where each probe whose pictures are files has its sidecar, and the probe."""
    for probe in _probes():
        folder = pictures_folder(probe)
        if folder is not None:
            yield folder / sidecar.sidecar_file(probe.name, probe.pcc_probe.uid), probe


def _mend_sidecars() -> None:
    """Let sidecars whose pictures were removed, as where a bake was undone, describe those that are saved."""
    for path, probe in _sidecars():
        if path.is_file() and not all((path.parent / name).is_file() for name in _described(path)):
            write_whole(path, probe.pcc_probe.bake_record)


def _probes() -> list[bpy.types.Object]:
    return [o for o in bpy.data.objects if o.pcc_probe.is_probe and not marks.is_foreign(o)]


def _uids_here() -> set[str]:
    return {probe.pcc_probe.uid for probe in _probes()} - {""}


def _remove(paths: Iterable[Path]) -> None:
    for path in paths:
        path.unlink(missing_ok=True)


def _unmentioned(folder: Path, shown: set[Path]) -> set[Path]:
    """What lies in a file's own folder, belongs to a probe that it has or had, and is mentioned nowhere."""
    here = _uids_here()
    ours = {sidecar.uid_digest(uid): uid in here for uid in _uids | here}
    found = {path: mark for path in folder.iterdir() if (mark := sidecar.uid_digest_of_file(path.name)) in ours}
    sidecars = sorted((path for path in found if path.suffix == ".json"), key=lambda path: path.stat().st_mtime)
    newest = {found[path]: path for path in sidecars if ours[found[path]]}
    kept = {path.name for path in shown} | {path.name for path in newest.values()}
    for path in newest.values():  # another session may have baked and not saved yet
        kept |= _families(path)
    doubtful = {path for path in found if sidecar.file_family(path.name) not in kept}
    if not doubtful:
        return set()
    mentioned = _mentioned(folder)
    if mentioned is None:
        return set()
    mentioned = {sidecar.file_family(name) for name in mentioned}
    gone = {path for path in doubtful if path.suffix != ".json" and sidecar.file_family(path.name) not in mentioned}
    lonely = {path for path in doubtful if path.suffix == ".json" and not _families(path) & (mentioned | kept)}
    return gone | lonely


def _families(path: Path) -> set[str]:
    """The families of the pictures that a sidecar describes."""
    return {sidecar.file_family(name) for name in _described(path)}


def _described(path: Path) -> set[str]:
    """The pictures that a sidecar describes; none where it cannot be read."""
    try:
        return {level.file for level in sidecar.Sidecar.from_json(sidecar.read_file(path), path.name).levels}
    except (OSError, BakeError, UnicodeDecodeError):
        return set()


def _mentioned(folder: Path) -> set[str] | None:
    """The pictures that .blend files and backups beside a folder show, and files elsewhere; None: nobody can tell."""
    beside = [path for path in folder.parent.glob("*.blend*") if path.is_file()]
    if sum(path.stat().st_size for path in beside) > _MOST_BYTES:
        return None
    found: set[str] = set()
    try:
        for path in beside:
            for piece in filter(_has_picture, _pieces(path)):
                found.update(name.decode() for name in sidecar.PICTURE_NAME.findall(piece))
        for path in folder.glob(f"{_USED_BY}*"):
            said = json.loads(sidecar.read_file(path))
            if Path(said["blend"]).exists():
                found.update(said["files"])
    except Exception:  # whatever is wrong with a neighbour: it may show any picture
        return None
    return found


def _has_picture(piece: bytes) -> bool:
    return b".exr" in piece  # sooner than a pattern finds out


def _pieces(path: Path) -> Iterator[bytes]:
    """A .blend's bytes, unpacked, a piece at a time; each repeats the end of the one before.

    Raises:
        OSError: it cannot be read.
        ImportError: nothing is there that unpacks it.
    """
    with path.open("rb") as file, _unpacked(file) as source:
        end = b""
        while piece := source.read(_PIECE):
            yield end + piece
            end = piece[-_LONGEST:]


def _unpacked(file: BinaryIO) -> BinaryIO:
    start = file.read(4)
    file.seek(0)
    if start[:2] == b"\x1f\x8b":
        return gzip.open(file)
    if start == b"\x28\xb5\x2f\xfd":
        import zstandard  # comes with Blender

        return zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True)
    return file


def _say_who_uses(blend: Path, shown: set[Path]) -> None:
    """Tell the folders of other files that a saved file shows pictures of theirs, as after Save As or an append.

    What was told to those whose pictures it showed in this session and shows no more is taken back.
    """
    used: dict[Path, list[str]] = {path.parent: [] for path in _seen if _is_of_another(blend, path)}
    for path in shown:
        if _is_of_another(blend, path):
            used.setdefault(path.parent, []).append(path.name)
    mark = hashlib.blake2b(str(blend).encode(), digest_size=4).hexdigest()
    for folder, names in used.items():
        note = folder / f"{_USED_BY}{mark}.json"
        if names and folder.is_dir():
            _replaced.discard(note)
            write_whole(note, json.dumps({"blend": str(blend), "files": sorted(names)}))
        elif not names:
            _replaced.add(note)  # undo may bring them back, too


def _is_of_another(blend: Path, path: Path) -> bool:
    """Whether a path is that of a picture in the folder of another file."""
    return path.suffix == ".exr" and path.parent.suffix == ".pcc" and path.parent != folder_of(blend)
