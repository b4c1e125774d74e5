"""What is kept of a run of `pcc cost`: cost.json, which is read back, and cost.csv, for spreadsheets."""

from __future__ import annotations

import csv
import io
import json
import os
import typing
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import MISSING, Field, asdict, fields, replace
from enum import Enum
from pathlib import Path
from types import NoneType
from typing import Any

from ..errors import PccError
from .advice import advice
from .front import Axis, error_of, front
from .path_curve import path_curves
from .records import CostReport, Measurement, Settings, Truth

FORMAT, VERSION = "parallax-probes-cost", 1
JSON_NAME, CSV_NAME = "cost.json", "cost.csv"


def to_json(report: CostReport) -> str:
    """A report as text that `from_json` reads back exactly.

    Beside the report itself stands what follows from it (`derived`), for `plots.py` and other programs; nobody reads it
    back.

    Raises:
        ValueError: a number is not finite.
    """
    document = {"format": FORMAT, "version": VERSION, "report": asdict(report), "derived": _derived(report)}
    return json.dumps(document, indent=1, allow_nan=False) + "\n"


def from_json(text: str, name: str = JSON_NAME) -> CostReport:
    """The report that `to_json` wrote; fields that this version does not know are left out.

    Raises:
        PccError: it is no such report, is damaged, or was written by a newer version.
    """
    try:
        document = json.loads(text)
        if not isinstance(document, dict) or document.get("format") != FORMAT:
            raise PccError(f"'{name}' holds no measurements of `pcc cost`; choose another folder or file")
        if int(document["version"]) > VERSION:
            raise PccError(f"'{name}' was written by a newer version of the add-on; update it, or measure anew")
        return _record(CostReport, document["report"])
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise PccError(
            f"'{name}' is damaged ({type(error).__name__}: {str(error)[:200]}); move it away, and `pcc cost` measures "
            "anew"
        ) from error


def to_csv(report: CostReport) -> str:
    """The measurements as a table, a row each in their order: first the settings, then what was measured."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow([*_columns(), "error"])
    for measurement in report.measurements:
        plain = {**asdict(measurement.settings), **asdict(measurement)}
        writer.writerow([*(_cell(plain[name]) for name in _columns()), repr(error_of(report, measurement))])
    return text.getvalue()


def from_csv(text: str) -> tuple[Measurement, ...]:
    """The measurements of a table that `to_csv` wrote, exactly.

    Raises:
        PccError: it is no such table.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(text)))
        return tuple(_from_row(row) for row in rows)
    except (ValueError, KeyError, TypeError) as error:
        raise PccError(f"'{CSV_NAME}' is no table of `pcc cost` ({type(error).__name__}: {error})") from error


def keep(report: CostReport, folder: Path) -> None:
    """Write cost.json, whole or not at all, so that a run that is killed loses nothing that it had finished.

    Raises:
        PccError: it cannot be written; the file that was there before is as it was.
    """
    write_aside(folder / JSON_NAME, to_json(report).encode("ascii"))


def kept_with(report: CostReport, measurement: Measurement, folder: Path) -> CostReport:
    """The report with one more measurement, which is on the disk when this returns.

    Raises:
        PccError: as `keep`.
    """
    longer = replace(report, measurements=(*report.measurements, measurement))
    keep(longer, folder)
    return longer


def write_tables(report: CostReport, folder: Path) -> tuple[Path, Path]:
    """Write cost.json and cost.csv, and say where they are.

    Raises:
        PccError: one cannot be written.
    """
    keep(report, folder)
    write_aside(folder / CSV_NAME, to_csv(report).encode("utf-8", "surrogateescape"))
    return folder / JSON_NAME, folder / CSV_NAME


def read(folder: Path) -> CostReport | None:
    """The report in a folder; None where there is none.

    Raises:
        PccError: it cannot be read, or as `from_json`.
    """
    path = folder / JSON_NAME
    try:
        return from_json(path.read_text(encoding="utf-8"), str(path))
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise PccError(f"cannot read '{path}' ({error}); move it away, and `pcc cost` measures anew") from error


def other_run(kept: CostReport, wanted: CostReport) -> str:
    """Why measurements that were kept cannot be gone on with, in words; empty where they can."""
    names = ("file", "scene", "camera", "probe", "engine", "width", "height", "frames")
    told = [
        f"{name} was {_shown(getattr(kept, name))} and is {_shown(getattr(wanted, name))}"
        for name in names
        if getattr(kept, name) != getattr(wanted, name)
    ]
    return "; ".join(told)


def write_aside(path: Path, content: bytes) -> None:
    """Write a file under another name, then move it into place.

    Raises:
        PccError: it cannot be written; the file that was there before is as it was.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise PccError(
            f"cannot write '{path}' ({error.strerror}); free space, close programs that have it open, or choose "
            "another folder"
        ) from error


def _derived(report: CostReport) -> dict[str, Any]:
    """What `plots.py` draws and cannot compute, since it runs without the add-on."""
    found = advice(report)
    return {
        "errors": [error_of(report, measurement) for measurement in report.measurements],
        "fronts": {axis.value: list(front(report, axis)) for axis in Axis},
        "curves": [
            {
                "name": curve.points[0].words + (", ray tracing" if curve.ray_tracing else ""),
                "denoised": curve.denoised,
                "points": [[point.seconds, point.error, point.samples] for point in curve.points],
            }
            for curve in path_curves(report)
        ],
        "recommended": found.recommended,
        "winner": found.winner.value,
        "meets_target": found.meets_target,
        "paid_after": found.paid_after,
        "sentences": list(found.sentences),
        "presets": [{"name": preset.name, "measurement": preset.measurement} for preset in found.presets],
    }


def _columns() -> list[str]:
    return [field.name for field in (*fields(Settings), *fields(Measurement)) if field.name != "settings"]


def _cell(value: object) -> str:
    """A value that `_parsed` reads back exactly."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    return value.value if isinstance(value, Enum) else repr(value) if isinstance(value, float) else str(value)


def _from_row(row: Mapping[str, str]) -> Measurement:
    hints = {**typing.get_type_hints(Settings), **typing.get_type_hints(Measurement)}
    plain = {name: _parsed(row[name], hints[name]) for name in _columns()}
    settings = {field.name: plain.pop(field.name) for field in fields(Settings)}
    return Measurement(settings=Settings(**settings), **plain)


def _parsed(text: str, hint: Any) -> Any:
    if hint is bool:
        return {"true": True, "false": False}[text]
    if hint == float | None:
        return float(text) if text else None
    return hint(text)


def _record(kind: Any, plain: Any) -> Any:
    """A dataclass of plain values; what it does not know is ignored, what is missing has its default."""
    hints = typing.get_type_hints(kind)
    return kind(**{f.name: _value(hints[f.name], plain[f.name]) for f in fields(kind) if _given(f, plain)})


def _given(field: Field[Any], plain: Mapping[str, Any]) -> bool:
    return field.name in plain or (field.default is MISSING and field.default_factory is MISSING)


def _value(hint: Any, plain: Any) -> Any:
    """A plain value as a field's type.

    Raises:
        KeyError, TypeError, ValueError: it is no such thing.
    """
    if hint in (Settings, Measurement, Truth):
        return _record(hint, plain)
    if typing.get_origin(hint) is tuple:
        if not isinstance(plain, list):
            raise TypeError(f"a list was expected, and not {plain!r}")
        return tuple(_value(typing.get_args(hint)[0], item) for item in plain)
    if typing.get_args(hint):  # such as float | None
        if plain is None:
            return None
        (hint,) = (choice for choice in typing.get_args(hint) if choice is not NoneType)
        return _value(hint, plain)
    if issubclass(hint, Enum):
        return hint(plain)
    if hint is float and type(plain) is int:
        return float(plain)
    if type(plain) is not hint:
        raise TypeError(f"{hint.__name__} was expected, and not {plain!r}")
    return plain


def _shown(value: object) -> str:
    return f"'{value.value}'" if isinstance(value, Enum) else repr(value)
