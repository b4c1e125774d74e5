"""Pages in a headless Chromium, served from here, which hand back a picture as it is in numbers."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from queue import Empty, Queue
from threading import Thread

import numpy as np
import pytest

PAGES = Path(__file__).parent / "pages"
_FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--mute-audio"]
_SECONDS = 300


def chromium() -> str:
    """The program; skips the test where there is none."""
    found = next(
        (path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None
    )
    if found is None:
        pytest.skip("needs Chromium (Debian: chromium)")
    return found


class _Handler(SimpleHTTPRequestHandler):
    """Serves some folders by their first part, and takes what a page posts."""

    extensions_map = {**SimpleHTTPRequestHandler.extensions_map, ".js": "text/javascript", ".mjs": "text/javascript"}

    def __init__(self, folders: Mapping[str, Path], told: Queue[tuple[str, bytes]], *args: object) -> None:
        self._folders, self._told = folders, told
        super().__init__(*args)

    def translate_path(self, path: str) -> str:
        first, _, rest = path.split("?")[0].lstrip("/").partition("/")
        return str(self._folders[first] / rest) if first in self._folders and ".." not in rest else "/nowhere"

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self._told.put((self.path, body))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *args: object) -> None:
        pass


def picture_of(page: str, export: Path, packages: Path, scene: Mapping[str, object]) -> np.ndarray:
    """What a page renders of a scene: (height, width, 3) float32 linear, row 0 at the bottom.

    Args:
        page: its name among the pages.
        export: the folder of the export that it loads.
        packages: a node_modules folder.
        scene: of `views.scene`.

    Raises:
        AssertionError: the page failed; says why.
    """
    program, told = chromium(), Queue()
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        (work / "scene.json").write_text(json.dumps(scene))
        folders = {"pages": PAGES, "export": export, "packages": packages, "view": work}
        server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, folders, told))
        Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/pages/{page}"
        command = [program, *_FLAGS, f"--user-data-dir={work / 'profile'}", address]
        browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            path, body = told.get(timeout=_SECONDS)
        except Empty:
            raise AssertionError(f"{page} told nothing in {_SECONDS} s") from None
        finally:
            browser.terminate()
            browser.wait(30)
            server.shutdown()
            server.server_close()
    assert path == "/picture", f"{page}: {body.decode(errors='replace')}"
    width, height = scene["size"]
    return np.frombuffer(body, np.float32).reshape(height, width, 4)[..., :3]
