"""A report as one file that any browser opens: cost.html. It asks for nothing from outside, and cannot.

Not called `html.py`: `plots.py` is run by its path, and then this folder comes before the standard library.
"""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from ..words import listed
from . import labels, plots
from .advice import Advice, Winner, advice
from .files import write_aside
from .front import Axis, error_of, front
from .page_style import SCRIPT, STYLE
from .records import CostReport, Kind, Measurement

HTML_NAME = "cost.html"
_CAPTIONS = {
    "error_frame": "Error against the seconds of a frame. What is further down and to the left is better.",
    "error_bake": "Error of the probe against the seconds of its bake.",
    "error_rungs": "The error of each setting.",
}
_VERDICTS = {
    Winner.PROBE: "Better with the probe",
    Winner.PATH: "Better without the probe",
    Winner.UNKNOWN: "Not compared",
}
_NEAR = math.log(1.25)
_SORTED_BY = "Error"
# No script but ours, which fetches nothing; no picture but those in the file.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


@dataclass(frozen=True)
class Column:
    """One column of the table of measurements.

    Attributes:
        head: its title.
        cells: text and what it is sorted by, for each measurement.
    """

    head: str
    cells: tuple[tuple[str, str | float], ...]


def write_page(report: CostReport, folder: Path, no_plots: str = "") -> Path:
    """Write cost.html from a report, and from the pictures and plots in its folder as far as they are there.

    Args:
        no_plots: why there are no plots, in words.

    Raises:
        PccError: it cannot be written.
    """
    path = folder / HTML_NAME
    write_aside(path, page(report, folder, no_plots).encode("utf-8", "replace"))
    return path


def page(report: CostReport, folder: Path, no_plots: str = "") -> str:
    """The text of cost.html; as `write_page`."""
    found = advice(report)
    title = f"What accuracy costs: probe '{report.probe}' in {report.file}"
    body = "\n".join(
        (
            f"<h1>{escape(title)}</h1>",
            *_head(report),
            *_advice(found),
            *_pictures(report, found, folder),
            *_plots(folder, no_plots),
            *_table(report, found),
            *_notes(report),
        )
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n{body}\n</main>\n"
        f"<script>{SCRIPT}</script>\n</body>\n</html>\n"
    )


def columns(report: CostReport, found: Advice) -> tuple[Column, ...]:
    """All measurements, as columns in their order."""
    measured = report.measurements
    fronts = {axis: set(front(report, axis)) for axis in Axis}
    marks = []
    for i in range(len(measured)):
        told = ["recommended"] if i == found.recommended else []
        told += [preset.name for preset in found.presets if preset.measurement == i]
        if on := [f"{axis.value.lower()} time" for axis in Axis if i in fronts[axis]]:
            told.append(f"front of {listed(on)}")
        marks.append((", ".join(told), float(-len(told))))
    return (
        Column("What", tuple(_text(_what(m)) for m in measured)),
        Column(
            "Frame", tuple(_number(m.settings.frame_samples, labels.samples_of_frame(m.settings)) for m in measured)
        ),
        Column(_SORTED_BY, tuple(_number(e, labels.error(e)) for e in (error_of(report, m) for m in measured))),
        Column("FLIP", tuple(_number(m.flip, f"{m.flip:.3f}") for m in measured)),
        Column("Flicker", tuple(_maybe(m.flicker) for m in measured)),
        Column("Bake", tuple(_number(m.bake_seconds, _seconds(m.bake_seconds)) for m in measured)),
        Column("A frame", tuple(_number(m.frame_seconds, _seconds(m.frame_seconds)) for m in measured)),
        Column("MB", tuple(_number(m.megabytes, f"{m.megabytes:.1f}" if m.megabytes else "–") for m in measured)),
        Column("Samplers", tuple(_number(m.samplers, str(m.samplers) if m.samplers else "–") for m in measured)),
        Column("Marks", tuple(marks)),
    )


def equal_time(report: CostReport, found: Advice) -> Measurement | None:
    """The path tracing with a picture whose frame took about as long as the recommended probe's; None: none has one."""
    kept = [m for m in report.measurements if m.settings.kind is Kind.PATH and m.picture and m.frame_seconds > 0.0]
    if found.recommended is None or not kept:
        return None
    goal = max(report.measurements[found.recommended].frame_seconds, 1e-9)
    return min(kept, key=lambda m: (abs(math.log(m.frame_seconds / goal)), m.rmse))


def _head(report: CostReport) -> Iterator[str]:
    scene = f"scene '{report.scene}', camera '{report.camera}'"
    engine = "EEVEE" if report.engine.value == "EEVEE" else "Cycles"
    frames = labels.counted(len(report.frames), "frame")
    yield (
        f'<p class="quiet">{escape(scene)}, {report.width} × {report.height} pixels, {frames}, {engine}. Measured on '
        f"{escape(report.where or 'an unnamed machine')} in {labels.seconds(report.seconds)}.</p>"
    )


def _advice(found: Advice) -> Iterator[str]:
    yield f'<section class="advice {found.winner.value.lower()}"><h2>{_VERDICTS[found.winner]}</h2>'
    yield from (f"<p>{escape(sentence)}</p>" for sentence in found.sentences)
    yield "</section>"
    if found.presets:
        yield "<section><h2>Presets from these measurements</h2><ul>"
        yield from (f"<li>{escape(preset.sentence)}</li>" for preset in found.presets)
        yield "</ul></section>"


def _pictures(report: CostReport, found: Advice, folder: Path) -> Iterator[str]:
    truth = report.truth
    shown = [("Truth", truth.picture, f"path traced, {labels.counted(truth.samples, 'sample')}")]
    if found.recommended is not None:
        rung = report.measurements[found.recommended]
        shown.append(("Probe", rung.picture, f"{labels.label(rung.settings)}: {_measured(report, rung)}"))
        if rival := equal_time(report, found):
            near = abs(math.log(rival.frame_seconds / max(rung.frame_seconds, 1e-9))) < _NEAR
            name = f"Without a probe, {'in about the same time' if near else 'nearest in time'}"
            shown.append((name, rival.picture, f"{labels.label(rival.settings)}: {_measured(report, rival)}"))
    shown.append(("Where the error is", report.heat_map, "of the recommended probe: the brighter, the larger"))
    figures = [
        f'<figure><img src="{uri}" alt="{escape(name)}">'
        f"<figcaption><b>{escape(name)}</b><br>{escape(words)}</figcaption></figure>"
        for name, file, words in shown
        if (uri := _data_uri(folder, file))
    ]
    if figures:
        yield "<section><h2>Pictures</h2>"
        yield f'<div class="pictures">{"".join(figures)}</div></section>'


def _measured(report: CostReport, measurement: Measurement) -> str:
    return f"error {labels.error(error_of(report, measurement))}, {labels.seconds(measurement.frame_seconds)} a frame"


def _plots(folder: Path, no_plots: str) -> Iterator[str]:
    found = [(name, svg) for name in plots.NAMES if (svg := _inline_svg(folder / f"{name}.svg", name))]
    if found:
        yield "<section><h2>Plots</h2>"
        for name, svg in found:
            yield f'<figure class="plot"><div>{svg}</div><figcaption>{_CAPTIONS[name]}</figcaption></figure>'
        yield "</section>"
    elif no_plots:
        yield f'<p class="quiet">{escape(no_plots)}.</p>'


def _table(report: CostReport, found: Advice) -> Iterator[str]:
    table = columns(report, found)
    yield "<section><h2>All measurements</h2>"
    yield '<p class="quiet">A click on a title sorts by it. Errors are without what the truth\'s own noise adds.</p>'
    heads = "".join(_title(column.head) for column in table)
    yield f'<div class="wide"><table id="measurements"><thead><tr>{heads}</tr></thead><tbody>'
    for i in sorted(range(len(report.measurements)), key=lambda i: (error_of(report, report.measurements[i]), i)):
        mark = ' class="chosen"' if i == found.recommended else ""
        yield f"<tr{mark}>{''.join(_cell(*column.cells[i]) for column in table)}</tr>"
    yield "</tbody></table></div></section>"


def _title(head: str) -> str:
    order = ' aria-sort="ascending"' if head == _SORTED_BY else ""
    return f'<th scope="col"{order}><button type="button">{head}</button></th>'


def _cell(text: str, key: str | float) -> str:
    kind = "" if isinstance(key, str) else ' class="number"'
    return f'<td{kind} data-key="{escape(key) if isinstance(key, str) else repr(key)}">{escape(text)}</td>'


def _notes(report: CostReport) -> Iterator[str]:
    truth = report.truth
    yield "<section><h2>What the numbers mean</h2><dl>"
    words = {
        "Error": (
            "root mean square of the difference to the truth over that of the truth, over the pixels that the probe "
            f"serves ({truth.served:.0%} of the picture), in linear light."
        ),
        "Truth": (
            f"path traced with {labels.counted(truth.samples, 'sample')} in {labels.seconds(truth.seconds)}; its own "
            f"noise is {labels.error(truth.noise)}, estimated from two independent halves of the samples. Errors near "
            "that are uncertain."
        ),
        "FLIP": (
            "HDR-FLIP (Andersson et al. 2021): how much of the difference one notices when both pictures are shown in "
            "turn, 0 to 1, at the exposure where it is largest."
        ),
        "Flicker": "error of the change from frame to frame, over the truth's change; – where one frame was measured.",
        "Bake": "seconds for all pictures that the probe needs. A frame: seconds to render one frame with them.",
    }
    yield from (f"<dt>{name}</dt><dd>{escape(meaning)}</dd>" for name, meaning in words.items())
    yield "</dl></section>"


def _what(measurement: Measurement) -> str:
    settings = measurement.settings
    if settings.kind is Kind.PATH:
        return labels.without_probes(settings.engine)
    return labels.of_bake(settings)


def _text(text: str) -> tuple[str, str | float]:
    return text, text


def _number(value: float, text: str) -> tuple[str, str | float]:
    return text, float(value)


def _maybe(value: float | None) -> tuple[str, str | float]:
    return ("–", math.inf) if value is None else (labels.error(value), value)


def _seconds(value: float) -> str:
    return labels.seconds(value) if value > 0.0 else "–"


def _data_uri(folder: Path, name: str) -> str:
    """A picture in the report's folder as an address that holds it; empty where it is not there."""
    try:
        return f"data:image/png;base64,{base64.b64encode((folder / Path(name).name).read_bytes()).decode()}" * bool(
            name
        )
    except OSError:
        return ""


def _inline_svg(path: Path, name: str) -> str:
    """A plot as part of the page: words in its colour, names of its own; empty where it is not there."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        return ""
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'\s+xmlns(:\w+)?="[^"]*"', "", text)
    text = text.replace("xlink:href=", "href=").replace(plots.INK, "currentColor")
    text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{name}-", text)
    opening = rf'<svg viewBox="\1" role="img" aria-label="{_CAPTIONS[name]}">'
    return re.sub(r'<svg [^>]*?viewBox="([^"]*)"[^>]*>', opening, text, count=1)


def table_rows(report: CostReport) -> Sequence[Sequence[str]]:
    """The table of all measurements as text, its titles first, for panels and shells."""
    table = columns(report, advice(report))
    heads = [column.head for column in table]
    return [heads, *([column.cells[i][0] for column in table] for i in range(len(report.measurements)))]
