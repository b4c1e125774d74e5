"""The published vectors: true to the formula, reproducible, and able to tell a faulty implementation."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from tests.conformance.reference import angle

from . import make

RUNNER = Path(__file__).with_name("example_runner.py")
CASES = json.loads(make.FILE.read_text(encoding="utf-8"))["cases"]


def column(name: str) -> np.ndarray:
    return np.array([case[name] for case in CASES])


def run(script: str, folder: Path) -> subprocess.CompletedProcess:
    """A runner beside a copy of the vectors, without anything but the standard library."""
    (folder / "lookup.json").write_bytes(make.FILE.read_bytes())
    (folder / "runner.py").write_text(script, encoding="utf-8")
    return subprocess.run([sys.executable, "-I", folder / "runner.py"], capture_output=True, text=True)


def test_the_file_is_what_its_script_makes() -> None:
    assert make.FILE.read_text(encoding="utf-8") == make.text(), "run: python3 dev.py run tests/vectors/make.py"


def test_inputs_are_float32_numbers() -> None:
    known = ("position", "incoming", "normal", "centre", "face_normals", "half_widths", "capture_point")
    for name in (*known, "padding", "falloff"):
        values = column(name)
        np.testing.assert_array_equal(values, values.astype(np.float32))


@pytest.mark.parametrize("box", ["aligned", "oriented"])
def test_the_formula_passes_in_single_precision(box: str) -> None:
    chosen = np.array([case["box"] == box for case in CASES])
    assert chosen.sum() > 100
    inputs = {
        "Position": column("position"),
        "Incoming": column("incoming"),
        "Normal": column("normal"),
        "Box Centre": column("centre"),
        **{f"Face Normal {axis}": column("face_normals")[:, k] for k, axis in enumerate("XYZ")},
        "Half Widths": column("half_widths"),
        "Capture Point": column("capture_point"),
        "Padding": column("padding"),
        "Falloff": column("falloff"),
    }
    inputs = {name: values[chosen] for name, values in inputs.items()}
    correction = Correction.ALIGNED_BOX if box == "aligned" else Correction.ORIENTED_BOX
    found = evaluate(formula.lookup(LookupEffects(correction, Outside.OWN)), inputs, np.float32)
    assert (angle(found["Direction"], column("direction")[chosen]) <= column("tolerance")[chosen]).all()
    turned = evaluate(formula.lookup(LookupEffects(correction, None, False, stretched=True)), inputs, np.float32)
    error = angle(turned["Direction"], column("stretched_direction")[chosen])
    assert (error <= column("stretched_tolerance")[chosen]).all() and error.max() > 0.0
    off = np.abs(found["Weight"] - column("weight")[chosen])
    assert (off <= column("weight_tolerance")[chosen]).all()


def test_there_are_cases_inside_outside_and_in_the_fade() -> None:
    weight, sure = column("weight"), column("weight_tolerance") < 1e-3
    assert min(((weight == 1.0) & sure).sum(), ((weight == 0.0) & sure).sum()) > 20
    assert ((weight > 0.01) & (weight < 0.99) & sure).sum() > 20


def test_the_example_runner_passes_and_is_short(tmp_path) -> None:
    script = RUNNER.read_text(encoding="utf-8")
    result = run(script, tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert f"{len(CASES)} cases, 0 wrong" in result.stdout
    assert len(script.splitlines()) <= 55


def test_the_runner_tells_which_families_a_faulty_implementation_fails(tmp_path) -> None:
    script = RUNNER.read_text(encoding="utf-8")
    faults = {
        "max(half - math.copysign(q, q * speed), 1e-12)": "(half - math.copysign(q, q * speed) or math.inf)",
        "math.copysign(q, q * speed)": "abs(q)",
        "nearness + r": "+ r",
        "return [(p - b)": "return [0.0, 0.0, 0.0] or [(p - b)",
        "dot(face, exit) / half": "dot(face, exit)",
        'case["centre"]})': 'case["capture_point"]})',
        'beyond - case["padding"]': 'beyond + case["padding"]',
    }
    for right, wrong in faults.items():
        assert right in script
        result = run(script.replace(right, wrong), tmp_path)
        assert result.returncode == 1 and " 0 wrong" not in result.stdout, wrong
