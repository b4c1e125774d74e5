"""The published vectors: true to the formula, reproducible, and able to tell a faulty implementation."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects
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
    for name in ("position", "incoming", "normal", "centre", "face_normals", "half_widths", "capture_point"):
        values = column(name)
        np.testing.assert_array_equal(values, values.astype(np.float32))


def test_the_formula_passes_in_single_precision() -> None:
    inputs = {
        "Position": column("position"),
        "Incoming": column("incoming"),
        "Normal": column("normal"),
        "Box Centre": column("centre"),
        **{f"Face Normal {axis}": column("face_normals")[:, k] for k, axis in enumerate("XYZ")},
        "Half Widths": column("half_widths"),
        "Capture Point": column("capture_point"),
    }
    found = evaluate(formula.lookup(LookupEffects(Correction.ORIENTED_BOX, None)), inputs, np.float32)["Direction"]
    assert (angle(found, column("direction")) <= column("tolerance")).all()


def test_the_example_runner_passes_and_is_short(tmp_path) -> None:
    script = RUNNER.read_text(encoding="utf-8")
    result = run(script, tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert f"{len(CASES)} cases, 0 wrong" in result.stdout
    assert len(script.splitlines()) <= 45


def test_the_runner_tells_which_families_a_faulty_implementation_fails(tmp_path) -> None:
    script = RUNNER.read_text(encoding="utf-8")
    faults = {
        "max(half - math.copysign(q, q * speed), 1e-12)": "(half - math.copysign(q, q * speed) or math.inf)",
        "math.copysign(q, q * speed)": "abs(q)",
        "nearness + r": "+ r",
        "return [(p - b)": "return [0.0, 0.0, 0.0] or [(p - b)",
    }
    for right, wrong in faults.items():
        assert right in script
        result = run(script.replace(right, wrong), tmp_path)
        assert result.returncode == 1 and " 0 wrong" not in result.stdout, wrong
