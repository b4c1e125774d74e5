"""What is kept of a run: read back exactly, whole after a kill, and refused in words where it is damaged."""

from __future__ import annotations

import csv
import io
import json
import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.accuracy import files
from pcc_addon.core.accuracy.records import CostReport, Kind, Measurement, Settings, Truth
from pcc_addon.core.errors import PccError
from pcc_addon.core.probe import Engine

from .cost_reports import example, path, probe, report

number = st.floats(min_value=0.0, allow_infinity=False, allow_nan=False)
name = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\0"), max_size=12)
settings = st.builds(
    Settings,
    st.sampled_from(Kind),
    st.sampled_from(Engine),
    st.sampled_from(["NONE", "BOX", "RELIEF"]),
    *[st.integers(0, 2**24)] * 2,
    *[st.booleans()] * 2,
    *[st.integers(0, 2**24)] * 3,
    *[st.booleans()] * 2,
)
measurements = st.builds(
    Measurement, settings, number, number, st.none() | number, number, number, number, st.integers(0, 32), name
)
few = st.sampled_from([0.0, 1e-12, 0.001, 0.05, 1.0, 7.0, 1e5])
mild = st.builds(Measurement, settings, few, few, st.none() | few, few, few, few)
truths = st.builds(Truth, st.integers(1, 2**24), number, number, number, name)
sizes = st.integers(1, 9999)
reports = st.builds(
    CostReport,
    name,
    name,
    name,
    name,
    st.sampled_from(Engine),
    sizes,
    sizes,
    st.lists(st.integers(-100, 2**20), max_size=4).map(tuple),
    truths,
    st.lists(measurements, max_size=4).map(tuple),
    name,
    number,
    st.none() | number,
    st.none() | number,
    st.none() | st.integers(1, 10**6),
    name,
)


@pytest.fixture
def no_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers as wild as these have no sensible advice; what is read back does not hold it."""
    monkeypatch.setattr(files, "_derived", lambda report: {})


@pytest.mark.usefixtures("no_advice")
def test_json_is_read_back_exactly() -> None:
    @given(reports)
    def same(found: CostReport) -> None:
        assert files.from_json(files.to_json(found)) == found

    same()


@given(st.lists(mild, max_size=6), st.none() | st.floats(0.0, 2.0), st.sampled_from([0.0, 0.1]))
def test_whatever_was_measured_is_kept_with_what_follows(
    ones: list[Measurement], target: float | None, noise: float
) -> None:
    """Errors of 0, frames in no time, a million samples: nothing divides by zero."""
    found = report(*ones, target=target, noise=noise)
    assert files.from_json(files.to_json(found)) == found


@given(st.lists(measurements, max_size=6))
def test_csv_is_read_back_exactly(ones: list[Measurement]) -> None:
    table = files.to_csv(report(*ones))
    assert files.from_csv(table) == tuple(ones)
    assert len(list(csv.reader(io.StringIO(table, newline="")))) == 1 + len(ones)


def test_what_follows_stands_beside_the_report() -> None:
    document = json.loads(files.to_json(example()))
    derived, measured = document["derived"], document["report"]["measurements"]
    assert len(derived["errors"]) == len(measured)
    assert measured[derived["recommended"]]["settings"]["kind"] == "PROBE"
    assert set(derived["fronts"]) == {"BAKE", "FRAME"} and all(derived["fronts"].values())
    assert [curve["denoised"] for curve in derived["curves"]] == [False, True]
    assert derived["sentences"] and [preset["name"] for preset in derived["presets"]] == ["Preview", "Medium", "Final"]


def test_fields_of_later_versions_are_left_out_and_missing_ones_have_their_defaults() -> None:
    document = json.loads(files.to_json(example()))
    document["report"]["weather"] = "fair"
    document["report"]["measurements"][0]["settings"]["mood"] = 3
    document["more"] = []
    for field in ("planned", "heat_map", "where"):
        del document["report"][field]
    for one in document["report"]["measurements"]:
        del one["megabytes"]
    found = files.from_json(json.dumps(document))
    plain = replace(example(), where="")
    assert found == replace(plain, measurements=tuple(replace(m, megabytes=0.0) for m in plain.measurements))


def test_whole_seconds_may_be_written_without_a_point() -> None:
    text = files.to_json(report(probe(0.5, 3.0, 2.0))).replace('"bake_seconds": 3.0', '"bake_seconds": 3')
    (one,) = files.from_json(text).measurements
    assert one.bake_seconds == 3.0 and type(one.bake_seconds) is float


def damaged() -> dict[str, str]:
    text = files.to_json(example())
    document = json.loads(text)

    def changed(**report_fields: object) -> str:
        return json.dumps({**document, "report": {**document["report"], **report_fields}})

    without = {key: value for key, value in document["report"].items() if key != "truth"}
    return {
        "cut short": text[: len(text) // 2],
        "empty": "",
        "deep": "[" * 100_000,
        "no version": json.dumps({"format": files.FORMAT, "report": {}}),
        "no truth": json.dumps({**document, "report": without}),
        "text for a number": changed(width="wide"),
        "a number for text": changed(file=3),
        "a flag for a number": changed(width=True),
        "no list": changed(frames="1"),
        "another engine": changed(engine="ABACUS"),
        "nothing for a report": json.dumps({**document, "report": None}),
        "a list for a record": changed(truth=[1, 2]),
    }


@pytest.mark.parametrize("kind", damaged())
def test_a_damaged_file_is_refused_in_words(kind: str) -> None:
    with pytest.raises(PccError, match=r"'cost.json' is damaged .*; move it away, and `pcc cost` measures anew"):
        files.from_json(damaged()[kind])


def test_other_files_and_newer_ones_are_refused_in_words() -> None:
    with pytest.raises(PccError, match="holds no measurements"):
        files.from_json('{"format": "parallax-probe"}')
    with pytest.raises(PccError, match="holds no measurements"):
        files.from_json("[]")
    newer = json.loads(files.to_json(example()))
    with pytest.raises(PccError, match="newer version of the add-on"):
        files.from_json(json.dumps({**newer, "version": files.VERSION + 1}))


def test_a_table_of_something_else_is_refused() -> None:
    with pytest.raises(PccError, match="no table of `pcc cost`"):
        files.from_csv("a,b\n1,2\n")


def test_what_is_no_number_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="JSON"):
        files.keep(report(replace(probe(0.1, 1.0, 1.0), flip=float("nan"))), tmp_path)
    assert not list(tmp_path.iterdir())


def test_each_measurement_is_on_the_disk_when_it_is_kept(tmp_path: Path) -> None:
    found = report()
    for k in range(3):
        found = files.kept_with(found, probe(0.1 + k, 1.0, 1.0), tmp_path / "deep" / "down")
        assert files.read(tmp_path / "deep" / "down") == found and len(found.measurements) == k + 1
    assert [p.name for p in (tmp_path / "deep" / "down").iterdir()] == ["cost.json"]


def test_a_kill_while_writing_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Killed before the file is moved into place: the file before it is whole, and what lies beside it is in no way."""
    first = files.kept_with(report(), probe(0.1, 1.0, 1.0), tmp_path)

    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", killed)
        with pytest.raises(KeyboardInterrupt):
            files.kept_with(first, path(4, 0.3, 1.0), tmp_path)
    assert files.read(tmp_path) == first
    longer = files.kept_with(first, path(4, 0.3, 1.0), tmp_path)
    assert files.read(tmp_path) == longer and len(list(tmp_path.iterdir())) == 1


def test_a_full_disk_is_told_of_and_leaves_the_file_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = files.kept_with(report(), probe(0.1, 1.0, 1.0), tmp_path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(PccError, match=r"cannot write '.*cost.json' \(No space left on device\); free space"):
        files.kept_with(first, path(4, 0.3, 1.0), tmp_path)
    monkeypatch.undo()
    assert files.read(tmp_path) == first and len(list(tmp_path.iterdir())) == 1


def test_a_folder_that_is_a_file_is_told_of(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    with pytest.raises(PccError, match="cannot write"):
        files.keep(report(), tmp_path / "out")


def test_where_nothing_was_kept_there_is_nothing(tmp_path: Path) -> None:
    assert files.read(tmp_path) is None and files.read(tmp_path / "nowhere") is None


def test_bytes_that_are_no_text_are_told_of(tmp_path: Path) -> None:
    (tmp_path / "cost.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(PccError, match="cannot read"):
        files.read(tmp_path)


def test_tables_are_written_together(tmp_path: Path) -> None:
    written = files.write_tables(example(), tmp_path)
    assert [file.name for file in written] == ["cost.json", "cost.csv"]
    assert files.from_csv(written[1].read_bytes().decode()) == example().measurements
    rows = list(csv.DictReader(io.StringIO(written[1].read_text(encoding="utf-8"))))
    assert list(rows[0])[:2] == ["kind", "engine"] and float(rows[0]["error"]) < float(rows[0]["rmse"])


def test_a_run_is_gone_on_with_where_it_is_the_same() -> None:
    assert files.other_run(example(), replace(example(), measurements=(), seconds=0.0, target=0.1)) == ""
    other = replace(example(), camera="Side", width=960, engine=Engine.EEVEE)
    assert files.other_run(example(), other) == (
        "camera was 'Camera' and is 'Side'; engine was 'CYCLES' and is 'EEVEE'; width was 480 and is 960"
    )
