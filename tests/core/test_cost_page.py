"""cost.html: whole, alone, and the same for a browser as for us; the plots and pictures in it."""

from __future__ import annotations

import base64
import io
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.accuracy import files, page, plots, plotting, png
from pcc_addon.core.accuracy.advice import advice
from pcc_addon.core.accuracy.front import error_of
from pcc_addon.core.accuracy.records import CostReport, Kind
from pcc_addon.core.errors import PccError

from .cost_reports import example, ladder, path, probe, report

KEPT = Path(__file__).resolve().parents[1] / "output" / "cost"  # to be looked at
VOID = {"meta", "img", "br"}


def picture(height: int = 27, width: int = 48) -> np.ndarray:
    y, x = np.mgrid[:height, :width] / 10.0
    return np.stack([np.abs(np.sin(x)), np.abs(np.cos(y)), x * y / 13.0], axis=-1).astype(np.float32)


def with_pictures(found: CostReport, folder: Path) -> CostReport:
    for name, exposure in (("truth.png", 0.0), ("probe.png", 0.2), ("path.png", -0.2), ("heat.png", -2.0)):
        png.write_png(folder / name, picture(), exposure)
    kept = [replace(m, picture="path.png" if m.settings.kind is Kind.PATH else "probe.png") for m in found.measurements]
    return replace(found, measurements=tuple(kept), heat_map="heat.png")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole report of a part of the ladder, with plots where there is matplotlib."""
    place = tmp_path_factory.mktemp("cost")
    found = with_pictures(example(ladder()[::3]), place)
    files.write_tables(found, place)
    if plotting.find_python():
        plotting.draw_plots(place / "cost.json", place)
    page.write_page(found, place)
    return place


class Checker(HTMLParser):
    """Elements that are closed as they were opened, names that are there once, and the rows of the table."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.uses: list[str] = []
        self.keys: list[str] = []
        self.rows = 0
        self.images: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        told = dict(attributes)
        assert len(told) == len(attributes), f"{tag} has an attribute twice"
        if "id" in told:
            self.ids.append(told["id"] or "")
        self.uses += re.findall(r"url\(#([^)]*)\)", " ".join(value or "" for value in told.values()))
        if tag == "use":
            self.uses.append((told["href"] or "").removeprefix("#"))
        if tag == "img":
            self.images.append(told["src"] or "")
        if tag == "tr":
            self.rows += 1
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open.pop() == tag, f"</{tag}> closes something else"


def test_the_page_is_well_formed(folder: Path) -> None:
    checked = Checker((folder / "cost.html").read_text(encoding="utf-8"))
    assert len(set(checked.ids)) == len(checked.ids)
    assert set(checked.uses) <= set(checked.ids)


def test_the_page_asks_for_nothing_from_outside(folder: Path) -> None:
    text = (folder / "cost.html").read_text(encoding="utf-8")
    assert not re.search(r"https?://|//[a-z]+\.|@import|<link|src=(?!\"data:)", text.replace("<!DOCTYPE", ""))
    assert "default-src 'none'" in text
    assert set(re.findall(r"url\((.)", text)) <= {"#"}


def test_all_measurements_are_there(folder: Path) -> None:
    found = files.read(folder)
    assert found is not None
    text = (folder / "cost.html").read_text(encoding="utf-8")
    assert Checker(text).rows == 1 + len(found.measurements)
    for measurement in found.measurements:
        for value in (measurement.flip, measurement.frame_seconds, error_of(found, measurement)):
            assert f'data-key="{value!r}"' in text
    assert text.count('class="chosen"') == 1


def test_all_sentences_and_presets_are_there(folder: Path) -> None:
    found = files.read(folder)
    assert found is not None
    text = (folder / "cost.html").read_text(encoding="utf-8").replace("&#x27;", "'")
    result = advice(found)
    for sentence in (*result.sentences, *(preset.sentence for preset in result.presets), found.where):
        assert sentence in text


def test_the_four_pictures_are_in_the_page(folder: Path) -> None:
    images = Checker((folder / "cost.html").read_text(encoding="utf-8")).images
    inside = [base64.b64decode(image.removeprefix("data:image/png;base64,")) for image in images]
    assert inside == [(folder / f"{name}.png").read_bytes() for name in ("truth", "probe", "path", "heat")]


def test_names_are_text_and_no_markup(tmp_path: Path) -> None:
    odd = replace(
        report(probe(0.1, 1.0, 1.0), path(4, 0.2, 1.0)), probe='<b>"&', file="</title>", camera="<!--", where="<script>"
    )
    text = page.page(odd, tmp_path)
    Checker(text)
    assert "<b>&quot;" not in text and "&lt;b&gt;&quot;&amp;" in text and text.count("<script>") == 1


def test_without_pictures_and_plots_the_table_is_there_and_says_why(tmp_path: Path) -> None:
    found = replace(example(ladder()[::9]), heat_map="../../secret.png")
    text = page.page(found, tmp_path, plotting.HOW_TO_GET)
    assert Checker(text).images == [] and "<svg" not in text
    assert "python3 -m pip install matplotlib" in text and Checker(text).rows == 1 + len(found.measurements)


def test_a_report_of_nothing_is_a_page_too(tmp_path: Path) -> None:
    assert Checker(page.page(report(), tmp_path)).rows == 1


def test_the_picture_beside_the_probe_took_about_the_same_time() -> None:
    ones = [replace(path(n, 0.2, seconds), picture=f"{n}.png") for n, seconds in ((4, 0.4), (16, 1.5), (64, 9.0))]
    found = report(probe(0.1, 5.0, 2.0), *ones, path(32, 0.1, 2.0))  # of the last no picture was kept
    assert page.equal_time(found, advice(found)) == ones[1]
    assert page.equal_time(report(*ones), advice(report(*ones))) is None


def test_a_picture_of_another_time_does_not_claim_the_same(tmp_path: Path) -> None:
    png.write_png(tmp_path / "a.png", picture())
    for seconds, words in ((2.4, "in about the same time"), (2.6, "nearest in time")):
        found = report(probe(0.1, 5.0, 2.0), replace(path(4, 0.2, seconds), picture="a.png"))
        assert f"Without a probe, {words}" in page.page(found, tmp_path)


def test_the_table_as_text_is_in_the_order_of_measuring() -> None:
    found = report(probe(0.1, 5.0, 2.0), path(32, 0.05, 2.0))
    rows = page.table_rows(found)
    assert rows[0][:4] == ["What", "Frame", "Error", "FLIP"]
    assert rows[1][:4] == ["box, 256 px faces, 64 samples denoised", "64 samples", "10 %", "0.050"]
    assert rows[2][0] == "path tracing" and rows[2][4:7] == ["–", "–", "2.0 s"]


def test_a_picture_is_what_other_programs_read(tmp_path: Path) -> None:
    images = pytest.importorskip("PIL.Image", reason="pip install pillow")
    shown = picture()
    shown[0, 0], shown[0, 1], shown[0, 2] = np.nan, np.inf, -1.0
    shown[1, 0] = [1.0, 0.2140411, 0.002]  # sRGB: 255, 127.5, and 12.92 × 0.002 × 255 = 6.6
    png.write_png(tmp_path / "a.png", shown)
    read = np.asarray(images.open(tmp_path / "a.png").convert("RGB"))
    assert read.shape == shown.shape
    assert read[0, :3].tolist() == [[0] * 3, [255] * 3, [0] * 3]
    assert read[1, 0].tolist() in ([255, 127, 7], [255, 128, 7])
    brighter = np.asarray(images.open(io.BytesIO(png.png_of(shown / 4.0, 2.0))).convert("RGB"))
    assert np.abs(brighter.astype(int) - read).max() <= 1


def test_only_pictures_of_three_bytes_are_written() -> None:
    with pytest.raises(ValueError, match="bytes of uint8"):
        png.png_of_bytes(np.zeros((2, 2, 4), np.uint8))
    with pytest.raises(ValueError, match="bytes of uint8"):
        png.png_of_bytes(np.zeros((2, 2, 3)))


needs_matplotlib = pytest.mark.skipif(plotting.find_python() is None, reason=plotting.HOW_TO_GET)


@needs_matplotlib
def test_plots_are_drawn_as_png_and_svg(folder: Path) -> None:
    images = pytest.importorskip("PIL.Image", reason="pip install pillow")
    for name in plots.NAMES:
        drawn = np.asarray(images.open(folder / f"{name}.png").convert("RGB"))
        assert drawn.shape[1] > 800 and 0.01 < (drawn.min(axis=2) < 200).mean() < 0.5
        assert (folder / f"{name}.svg").read_text(encoding="utf-8").count("<path") > 10


@needs_matplotlib
def test_the_script_runs_by_its_path_without_the_add_on(folder: Path, tmp_path: Path) -> None:
    """From another folder, from a copy that has nothing beside it, with our modules out of reach."""
    copy = shutil.copy(Path(plots.__file__), tmp_path / "plots.py")
    python = plotting.find_python()
    surroundings = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [str(python), str(copy), str(folder / "cost.json"), str(tmp_path / "drawn")]
    done = subprocess.run(command, cwd=tmp_path, env=surroundings, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == len(list((tmp_path / "drawn").iterdir())) == 6


@pytest.mark.sweep
@needs_matplotlib
@pytest.mark.parametrize(
    "found",
    [
        report(),
        report(path(4, 0.2, 1.0), probe(0.0, 0.0, 0.0)),
        replace(example(ladder()[::11]), probe="$x_1$ & <b>", target=0.1),
    ],
    ids=["nothing", "errors of 0", "odd names"],
)
def test_small_and_odd_reports_are_drawn(found: CostReport, tmp_path: Path) -> None:
    files.keep(found, tmp_path)
    assert len(plotting.draw_plots(tmp_path / "cost.json", tmp_path)) == 6
    page.write_page(found, tmp_path)
    Checker((tmp_path / "cost.html").read_text(encoding="utf-8"))


def test_the_script_says_how_it_is_called_and_what_is_missing(tmp_path: Path) -> None:
    script = str(Path(plots.__file__))
    assert subprocess.run([sys.executable, script], capture_output=True, timeout=60).returncode == 2
    (tmp_path / "matplotlib.py").write_text("raise ImportError")
    surroundings = {**os.environ, "PYTHONPATH": str(tmp_path)}
    command = [sys.executable, script, "cost.json", str(tmp_path)]
    done = subprocess.run(command, env=surroundings, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "pip install matplotlib" in done.stderr


def test_a_python_that_is_named_is_taken_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(PccError, match=r"'.*nothing' is no Python that can import matplotlib"):
        plotting.find_python(str(tmp_path / "nothing"))
    monkeypatch.setenv(plotting.VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(PccError, match="nowhere"):
        plotting.find_python()


def test_where_no_python_has_matplotlib_words_say_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plotting, "_can_draw", lambda python: False)
    monkeypatch.delenv(plotting.VARIABLE, raising=False)
    with pytest.raises(PccError, match="python3 -m pip install matplotlib"):
        plotting.draw_plots(tmp_path / "cost.json", tmp_path)


@needs_matplotlib
def test_a_plot_that_fails_says_why(tmp_path: Path) -> None:
    (tmp_path / "cost.json").write_text(json.dumps({}))
    with pytest.raises(PccError, match=r"could not draw the plots \(KeyError"):
        plotting.draw_plots(tmp_path / "cost.json", tmp_path)


BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)
needs_browser = pytest.mark.skipif(BROWSER is None, reason="needs Chromium (Debian: apt install chromium)")
_DARK, _LIGHT = 0, 1


def browse(page_file: Path, *options: str) -> str:
    """What a headless browser says to a page."""
    command = [str(BROWSER), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", *options]
    place = page_file.parent / "profile"
    done = subprocess.run(
        [*command, f"--user-data-dir={place}", page_file.as_uri()], capture_output=True, encoding="utf-8", timeout=120
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@needs_browser
@pytest.mark.parametrize(
    ("name", "width", "scheme"), [("light", 1200, _LIGHT), ("dark", 1200, _DARK), ("phone", 390, _DARK)]
)
def test_a_browser_shows_it(folder: Path, name: str, width: int, scheme: int) -> None:
    """Light on dark or dark on light, with the pictures' colours; kept to be looked at."""
    images = pytest.importorskip("PIL.Image", reason="pip install pillow")
    KEPT.mkdir(parents=True, exist_ok=True)
    shot = KEPT / f"{name}.png"
    shot.unlink(missing_ok=True)
    sized = (f"--window-size={width},2400", f"--blink-settings=preferredColorScheme={scheme}")
    browse(folder / "cost.html", f"--screenshot={shot}", *sized)
    shown = np.asarray(images.open(shot).convert("RGB")).astype(float)
    assert shown.shape[1] == width
    paper = np.median(shown.reshape(-1, 3), axis=0)
    assert paper.max() < 60 if scheme == _DARK else paper.min() > 230
    assert (np.abs(shown - paper).max(axis=2) > 100).mean() > 0.03  # words, pictures, plots
    assert (np.ptp(shown, axis=2) > 100).mean() > 0.01  # in colours


@needs_browser
def test_a_click_sorts_the_table_and_nothing_is_wider_than_a_phone(folder: Path, tmp_path: Path) -> None:
    """Clicks on *Bake*, twice: first the least, then the most."""
    text = (folder / "cost.html").read_text(encoding="utf-8")
    asks = """
    const bake = heads.findIndex((head) => head.textContent === "Bake");
    const column = () => [...table.tBodies[0].rows].map((row) => Number(row.cells[bake].dataset.key));
    const told = { wide: document.documentElement.scrollWidth, room: window.innerWidth };
    heads[bake].firstElementChild.click(); told.up = column();
    heads[bake].firstElementChild.click(); told.down = column(); told.order = heads[bake].ariaSort;
    heads[0].firstElementChild.click(); told.names = [...table.tBodies[0].rows].map((row) => row.cells[0].textContent);
    document.title = JSON.stringify(told);
    </script>"""
    (tmp_path / "asked.html").write_text(text.replace("</script>", asks), encoding="utf-8")
    dom = browse(tmp_path / "asked.html", "--dump-dom", "--window-size=390,900")
    found = re.search(r"<title>(.*?)</title>", dom)
    assert found is not None
    told = json.loads(found[1].replace("&amp;", "&"))
    kept = files.read(folder)
    assert kept is not None
    assert told["up"] == sorted(m.bake_seconds for m in kept.measurements)
    assert told["down"] == told["up"][::-1] and told["order"] == "descending"
    assert told["names"][0].startswith("box, 64 px") and told["names"][-1].startswith("relief (16 steps")
    assert told["wide"] <= told["room"]
