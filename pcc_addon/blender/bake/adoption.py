"""How a probe takes a bake that another Blender made of it, whatever became of both meanwhile."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import bpy

from ...core.errors import BakeError, PccError
from ...core.lookup_plan import Receivers
from ...core.sidecar import Sidecar, read_file, renamed
from ...core.workplace import link
from .. import handlers
from ..probes import ensure_uid
from ..read.holders import Holders
from ..read.probes import probe_spec
from ..shade import live
from ..shade.probe_group import UNKNOWN_RECEIVERS
from ..shade.twin import shown_probe_groups
from ..store import pictures
from ..store.keeping import folder_for_parts, take_in
from .job import BakedProbe
from .showing import files_of, show


def told_bake(event: Mapping[str, Any]) -> BakedProbe:
    """What the shell tells of a baked probe."""
    known = {field.name: event[field.name] for field in fields(BakedProbe)}
    plain = {name: tuple(value) if isinstance(value, list) else value for name, value in known.items()}
    return BakedProbe(**{**plain, "receivers": Receivers(**event["receivers"])})


def probe_of(session_uid: int) -> bpy.types.Object | None:
    """The probe with an identity, whatever undo or its user made of it; None where it is gone."""
    found = (item for item in bpy.data.objects if item.session_uid == session_uid)
    return next((item for item in found if item.pcc_probe.is_probe and item.users_scene), None)


def adopt(baked: BakedProbe, probe: bpy.types.Object, folder: Path | None, roughness_limit: float) -> BakedProbe:
    """Let a probe have a bake whose files lie beside its sidecar, which stay there.

    What was changed since the bake began is stale afterwards: its record says what it saw.

    Args:
        baked: what was told of it.
        probe: the probe object.
        folder: where its pictures go; None packs them.
        roughness_limit: rougher surfaces keep their own lobe.

    Returns:
        What became of it here.

    Raises:
        PccError: the files cannot be read or stored; the old bake stays.
    """
    with handlers.paused():
        with ExitStack() as stack:
            stack.enter_context(pictures.desk())
            record = _taken_in(stack, Path(baked.sidecar), probe, folder)
        here = replace(baked, probe=probe.name, files=files_of(probe), sidecar="")
        try:
            moved = probe_spec(probe).box.matrix != record.matrix
            show(probe, UNKNOWN_RECEIVERS if moved else baked.receivers, baked.shares)
            showing = [m for m in bpy.data.materials if m.node_tree and probe.pcc_probe.group in shown_probe_groups(m)]
            live.follow(showing, roughness_limit, make_levels=True)
        except PccError as error:
            here = replace(here, warnings=(*here.warnings, f"it has its new bake, which cannot be shown: {error}"))
    return here


def _taken_in(stack: ExitStack, sidecar: Path, probe: bpy.types.Object, folder: Path | None) -> Sidecar:
    """Move second names of all files into place: whoever baked them may still read them by the first."""
    holders = Holders()
    try:
        record = Sidecar.from_json(read_file(sidecar), sidecar.name)
        parts = folder_for_parts(stack, folder)
        uid = ensure_uid(probe, holders, folder)
        for level in record.levels:
            link(sidecar.with_name(level.file), parts / renamed(level.file, probe.name, uid))
    except OSError as error:
        why = f"its new pictures cannot be stored ({error.strerror}); free space on the disk, and bake again"
        raise BakeError(f"probe '{probe.name}': {why}") from error
    levels = tuple(replace(level, file=renamed(level.file, probe.name, uid)) for level in record.levels)
    record = replace(record, uid=uid, levels=levels)
    take_in(probe, record, parts, folder, holders)
    return record
