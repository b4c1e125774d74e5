"""What accuracy costs in known scenes: error against seconds, equal-time pictures.

python3 dev.py run benchmarks/accuracy.py [--budget SECONDS] [ROOM.blend …] [-- NAME …]

Each scene goes through `pcc cost`, in Cycles and some in EEVEE; files are furnished rooms of others, which get a fitted
probe where they have none. With names only these scenes are measured anew; the others stay in docs/accuracy.md as they
are. Pages and plots of each run are kept in build/accuracy.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import bpy

from benchmarks.measure import ROOT, open_room, relative_rmse, render, start, table, write_between
from pcc_addon.core.accuracy import files, labels
from pcc_addon.core.accuracy.advice import advice
from pcc_addon.core.accuracy.front import Axis, error_of, front
from pcc_addon.core.accuracy.records import CostReport, Kind, Measurement
from pcc_addon.core.probe import Engine
from sample_blends import glass, scenes
from sample_blends.build import SAMPLES
from sample_blends.ways import Rendered, side_by_side

PAGE, FOLDER, IMAGES = ROOT / "docs" / "accuracy.md", ROOT / "build" / "accuracy", ROOT / "docs" / "images" / "accuracy"
MARK = "written by benchmarks/accuracy.py"


@dataclass(frozen=True)
class Subject:
    """A scene to measure.

    Attributes:
        name: in the page.
        build: makes it the open file, with one probe.
        engines: whose frames are measured.
        share: of the seconds that are given.
    """

    name: str
    build: Callable[[], object]
    engines: tuple[Engine, ...] = (Engine.CYCLES,)
    share: float = 1.0


def main() -> None:
    start()
    options = _options()
    subjects = [
        Subject("emissive room", SAMPLES["emissive_room.blend"], tuple(Engine)),
        Subject("gallery", scenes.gallery),
        Subject("glass", glass.glass),
        *(_furnished(Path(path)) for path in options.rooms),
    ]
    FOLDER.mkdir(parents=True, exist_ok=True)
    IMAGES.mkdir(parents=True, exist_ok=True)
    wanted = set(options.names) or {subject.name for subject in subjects} | {"interior"}
    reports: dict[tuple[str, Engine], CostReport] = {}
    for subject in subjects:
        for engine in subject.engines:
            folder = FOLDER / f"{_file_name(subject.name)}_{engine.value.lower()}"
            if subject.name in wanted:
                _measure(subject, engine, folder, subject.share * options.budget)
            report = files.read(folder)
            if report is not None:
                reports[subject.name, engine] = report
                if subject.name in wanted:
                    _picture(subject.name, engine, report, folder)
    for subject in subjects:
        known = [
            (engine, reports[subject.name, engine]) for engine in subject.engines if (subject.name, engine) in reports
        ]
        if subject.name in wanted and known:
            write_between(PAGE, f"{subject.name}: {MARK}", "\n\n".join(_section(subject.name, *each) for each in known))
    if reports:
        write_between(PAGE, f"summary: {MARK}", _summary(reports))
    if "interior" in wanted:
        write_between(PAGE, f"interior: {MARK}", _interior())


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    parser.add_argument("rooms", nargs="*")
    parser.add_argument("--budget", type=float, default=300.0)
    own, _, names = " ".join(sys.argv[1:]).partition(" -- ")
    options = parser.parse_args(own.split())
    options.names = [name.strip() for name in names.split(",") if name.strip()]
    return options


def _furnished(path: Path) -> Subject:
    return Subject(path.stem.replace("_", " "), partial(open_room, path, fit=True), tuple(Engine), 1.5)


def _file_name(name: str) -> str:
    return name.replace(" ", "_")


def _measure(subject: Subject, engine: Engine, folder: Path, budget: float) -> None:
    """Save the scene and let the shell measure it, as a user would."""
    subject.build()
    path = FOLDER / f"{folder.name}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    command = [sys.executable, "-m", "pcc_addon", "cost", str(path), "--engine", engine.value, "--out", str(folder)]
    subprocess.run([*command, "--budget", str(budget)], cwd=ROOT, check=True)


def _section(name: str, engine: Engine, report: CostReport) -> str:
    """A scene in one engine: what follows, the front, and the pictures."""
    found = advice(report)
    rows = [_row(report, report.measurements[k]) for k in front(report, Axis.BAKE)]
    rows += [_row(report, m) for m in report.measurements if m.settings.kind is not Kind.PROBE]
    head = ["setting", "error", "HDR-FLIP", "bake", "frame", "MB"]
    truth = (
        f"The probe serves {report.truth.served:.0%} of {report.width} × {report.height} pixels; the truth has "
        f"{report.truth.samples} samples and a noise of {labels.error(report.truth.noise)}."
    )
    image = f"images/accuracy/{_file_name(name)}_{engine.value.lower()}.png"
    afresh = ""
    if report.afresh is not None:
        before = next(m for m in report.measurements if m.settings == report.afresh.settings)
        afresh = (
            f"\n\nThe recommended setting once more, with another seed: error {labels.error(report.afresh.rmse)} for "
            f"{labels.error(before.rmse)}, bake {labels.seconds(report.afresh.bake_seconds)} for "
            f"{labels.seconds(before.bake_seconds)}, frame {labels.seconds(report.afresh.frame_seconds)} for "
            f"{labels.seconds(before.frame_seconds)}."
        )
    return (
        f"**{'Cycles' if engine is Engine.CYCLES else 'EEVEE'}.** {truth}\n\n"
        + "\n".join(f"- {sentence}" for sentence in found.sentences)
        + f"{afresh}\n\n![{name}: without probes in the same seconds, the probe, the truth]({image})\n\n"
        f"<details><summary>Measured</summary>\n\n{table(head, rows)}\n\n</details>"
    )


def _row(report: CostReport, each: Measurement) -> list[str]:
    bake = labels.seconds(each.bake_seconds) if each.bake_seconds else ""
    size = f"{each.megabytes:.1f}" if each.megabytes else ""
    error = labels.error(error_of(report, each))
    return [labels.label(each.settings), error, f"{each.flip:.3f}", bake, labels.seconds(each.frame_seconds), size]


def _picture(name: str, engine: Engine, report: CostReport, folder: Path) -> None:
    """Without probes in the time of the probe's frame, the probe, and the truth."""
    chosen = advice(report).recommended
    if chosen is None:
        return
    probe = report.measurements[chosen]
    paths = sorted(
        (m for m in report.measurements if m.settings.kind is Kind.PATH and m.picture), key=lambda m: m.frame_seconds
    )
    in_time = [m for m in paths if m.frame_seconds <= 1.1 * probe.frame_seconds] or paths[:1]
    rival = min(in_time, key=lambda m: error_of(report, m))
    truth = report.truth
    shown = [
        Rendered(labels.of_frame(rival.settings), folder / rival.picture, rival.frame_seconds),
        Rendered("the probe", folder / probe.picture, probe.frame_seconds),
        Rendered("the truth", folder / truth.picture, truth.seconds),
    ]
    path = IMAGES / f"{_file_name(name)}_{engine.value.lower()}.png"
    side_by_side(shown, path)
    _shrink(path)


def _shrink(path: Path) -> None:
    """Fewer colours: a picture for a page, a third of the size."""
    from PIL import Image

    Image.open(path).quantize(256).save(path, optimize=True)


def _summary(reports: dict[tuple[str, Engine], CostReport]) -> str:
    rows = []
    for (name, engine), report in reports.items():
        found = advice(report)
        if found.recommended is None:
            continue
        best = report.measurements[found.recommended]
        same = found.same_time
        rows.append(
            [
                name,
                engine.value.title() if engine is Engine.CYCLES else engine.value,
                labels.of_bake(best.settings),
                labels.error(error_of(report, best)),
                labels.error(same.error) if same else "–",
                labels.seconds(best.bake_seconds),
                labels.seconds(best.frame_seconds),
                found.winner.value.lower(),
                found.paid_after or "never",
            ]
        )
    head = ["scene", "engine", "best of the probe", "its error", "without probes in its frame's time"]
    where = next(iter(reports.values())).where
    return f"Measured on {where}.\n\n{table([*head, 'bake', 'frame', 'better', 'paid after frames'], rows)}"


def _interior() -> str:
    """Rooms that are not there against rooms that are: in the same seconds, and the pictures."""
    from benchmarks import interior as rooms

    scene, room = rooms.furnished_house()
    scene.cycles.use_denoising = False
    rooms.show_rooms(256, 64)
    mask = rooms.seen_panes(scene)
    samples = 32
    shown = render(scene, Engine.CYCLES, samples)
    with rooms.rooms_behind(rooms.FAR_FRONT, room):
        truth = render(scene, Engine.CYCLES, 1024).pixels
        first = render(scene, Engine.CYCLES, samples)
        equal = max(1, round(samples * shown.seconds / first.seconds))
        rival = render(scene, Engine.CYCLES, equal)
    clip = [picture.pixels.clip(max=1.0) for picture in (shown, rival)]
    errors = [relative_rmse(picture, truth.clip(max=1.0), mask) for picture in clip]
    return (
        "Four windows of furnished rooms, radiances above 1 counted as 1. Flat panes that show a bake of 256 px: error "
        f"{labels.error(errors[0])} in {labels.seconds(shown.seconds)} a frame, whatever its samples; rooms that are "
        f"built, in the same seconds ({equal} samples): {labels.error(errors[1])}, which is noise. More in "
        f"[interior](interior.md)."
    )


if __name__ == "__main__":
    main()
