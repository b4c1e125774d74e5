"""The same zip from the same commit: nothing in it depends on when, where and in which order it was packed."""

from __future__ import annotations

import os
import subprocess
import time
import zipfile
from pathlib import Path

_FIRST = 315_532_800  # 1980, with which the times of zips begin, in seconds since 1970


def moment(root: Path) -> int:
    """When what is packed was made, in seconds since 1970: `SOURCE_DATE_EPOCH`, or that of the commit, or long ago."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not given:
        try:
            asked = ["git", "-C", str(root), "log", "-1", "--format=%ct"]
            given = subprocess.run(asked, capture_output=True, text=True).stdout.strip()
        except OSError:  # no git here
            given = ""
    return int(given) if given.isdigit() else 0


def make_plain(archive: Path, seconds: int) -> None:
    """Pack a zip anew: its files by name, all of one moment and with the same rights, and no folders.

    Args:
        archive: it.
        seconds: the moment, since 1970.
    """
    part = archive.with_name(f"{archive.name}.part")
    at = time.gmtime(max(seconds, _FIRST))[:6]
    with zipfile.ZipFile(archive) as packed, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as plain:
        for name in sorted(name for name in packed.namelist() if not name.endswith("/")):
            entry = zipfile.ZipInfo(name, at)
            entry.create_system, entry.external_attr, entry.compress_type = 3, 0o100644 << 16, zipfile.ZIP_DEFLATED
            plain.writestr(entry, packed.read(name))
    os.replace(part, archive)
