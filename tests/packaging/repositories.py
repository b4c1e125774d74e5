"""Two releases, and repositories that have first the one and then the other."""

from __future__ import annotations

import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from .plain_zip import make_plain
from .release import index, release

EARLIER = "0.9.0"


def two_releases(folder: Path) -> tuple[Path, Path]:
    """Folders with an earlier release and with that of this repository."""
    now = release(folder / "now")
    earlier = folder / "earlier" / now.name.replace(_version_of(now), EARLIER)
    earlier.parent.mkdir()
    with zipfile.ZipFile(now) as source, zipfile.ZipFile(earlier, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name == "blender_manifest.toml":
                content = content.replace(f'version = "{_version_of(now)}"'.encode(), f'version = "{EARLIER}"'.encode())
            copy.writestr(name, content)
    make_plain(earlier, 0)
    index(earlier.parent)
    return earlier.parent, now.parent


@contextmanager
def served(folder: Path, by: str) -> Iterator[str]:
    """The address of the index of a folder, as a file or from a web server of this machine."""
    if by == "file":
        yield (folder / "index.json").as_uri()
        return
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Silent, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/index.json"
    finally:
        server.shutdown()
        server.server_close()


class _Silent(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Tests have nothing to say to it."""


def _version_of(archive: Path) -> str:
    return archive.stem.rpartition("-")[2]
